// SPDX-FileCopyrightText: 2026 The semantic_vslam authors
// SPDX-License-Identifier: BSD-3-Clause
#include "semantic_vslam/core/motion/camera_motion.h"

#include <Eigen/Cholesky>
#include <Eigen/SVD>
#include <algorithm>
#include <cmath>

#include "semantic_vslam/core/common/rng.h"

namespace semantic_vslam {
namespace {

// One point per block of 5x5 cells: 768 points at 160x120, evenly spread.
constexpr int kBlockCells = 5;
// Less gradient than the camera's own noise carries no flow.
constexpr float kLeastTexture = 3.0F;
// Gradient at which the flow is half trusted, gray levels per cell.
constexpr float kHalfTrustTexture = 8.0F;
// A neighbourhood whose depth differs more than this share lies on an edge: its depth may belong to the other side.
constexpr float kEdgeShare = 0.06F;
// Inlier bound in standard deviations. The search starts wide enough for the error of the prediction and narrows: a
// wider start would find a compromise between the room and a near walker, whose depth makes his motion look like
// parallax.
constexpr double kInlierSigmas = 3.0;
constexpr double kWidening[] = {5.0, 2.5, 1.5, 1.0};
constexpr double kNarrow[] = {1.0, 1.0};
constexpr double kHalfFrom = 2.0;
// Change of velocity of a hand-held or wheeled camera between two frames (some 5 m/s^2, 10 rad/s^2).
constexpr double kPriorTranslationM = 0.005, kPriorRotationRad = 0.01;
constexpr double kGoodShare = 0.6;
constexpr double kClearlyMore = 1.25;
constexpr int kRansacDraws = 60;
constexpr std::size_t kScoredPoints = 150;

struct NoiseModel {
  double flow_sigma;  // in units of the ray
  double depth_sigma_at_1m_m;
};

/// Residual of one point in standard deviations: two of flow, one of depth (0 where unmeasured).
struct Residual {
  Eigen::Vector3d moved;
  double u, v, z, sigma_z;
};

Residual residualOf(const FlowPoint& point, const Eigen::Matrix3d& R, const Eigen::Vector3d& t,
                    const NoiseModel& noise) {
  Residual r;
  r.moved = R * point.point_current.cast<double>() + t;
  const double inverse_z = 1.0 / std::max(r.moved.z(), 1e-3);
  r.u = (r.moved.x() * inverse_z - point.ray_previous.x()) / noise.flow_sigma;
  r.v = (r.moved.y() * inverse_z - point.ray_previous.y()) / noise.flow_sigma;
  constexpr double kOfTwoDepths = 1.4142135623730951;
  r.sigma_z = kOfTwoDepths * noise.depth_sigma_at_1m_m * std::max(r.moved.z() * r.moved.z(), 0.25);
  r.z = point.depth_previous_m > 0.0F ? (r.moved.z() - point.depth_previous_m) / r.sigma_z : 0.0;
  return r;
}

double gemanMcClure(double squared, double scale_squared) {
  const double q = scale_squared / (scale_squared + squared);
  return q * q;
}

/// Share of the weight that a motion explains; each point counts less the farther it is from it.
double explainedShare(const std::vector<FlowPoint>& points, const SE3& T, const NoiseModel& noise, std::size_t stride) {
  const Eigen::Matrix3d R = T.linear();
  const Eigen::Vector3d t = T.translation();
  double explained = 0.0, total = 1e-9;
  for (std::size_t i = 0; i < points.size(); i += stride) {
    const Residual r = residualOf(points[i], R, t, noise);
    const double squared = (r.u * r.u + r.v * r.v + r.z * r.z) / (kInlierSigmas * kInlierSigmas);
    total += points[i].weight;
    if (squared < 1.0) explained += points[i].weight * (1.0 - squared);
  }
  return explained / total;
}

struct NormalEquations {
  Matrix6d H = Matrix6d::Zero();
  Vector6d b = Vector6d::Zero();

  void add(const Vector6d& J, double residual, double weight) {
    H.noalias() += (weight * J) * J.transpose();
    b.noalias() -= (weight * residual) * J;
  }
};

NormalEquations linearise(const std::vector<FlowPoint>& points, const SE3& T, const NoiseModel& noise, double widening,
                          std::size_t stride) {
  const Eigen::Matrix3d R = T.linear();
  const Eigen::Vector3d t = T.translation();
  const double scale_squared = std::pow(kInlierSigmas * widening, 2);
  NormalEquations normal;
  for (std::size_t i = 0; i < points.size(); i += stride) {
    const FlowPoint& point = points[i];
    const Residual r = residualOf(point, R, t, noise);
    const double weight = point.weight * gemanMcClure(r.u * r.u + r.v * r.v, scale_squared);
    const double x = r.moved.x(), y = r.moved.y(), z = std::max(r.moved.z(), 1e-3);
    const double k = 1.0 / (z * noise.flow_sigma), a = x / z, c = y / z;
    // d(x/z, y/z) / d(translation, rotation) of a left perturbation.
    Vector6d J;
    J << k, 0.0, -k * a, -k * a * y, k * (z + a * x), -k * y;
    normal.add(J, r.u, weight);
    J << 0.0, k, -k * c, -k * (z + c * y), k * c * x, k * x;
    normal.add(J, r.v, weight);
    if (point.depth_previous_m > 0.0F) {
      J << 0.0, 0.0, 1.0, y, -x, 0.0;
      normal.add(J / r.sigma_z, r.z, weight * gemanMcClure(r.z * r.z, scale_squared));
    }
  }
  return normal;
}

template <std::size_t kSteps>
SE3 refine(const std::vector<FlowPoint>& points, const SE3& start, const SE3& predicted, const NoiseModel& noise,
           const double (&widenings)[kSteps], NormalEquations& last) {
  Vector6d prior;
  prior << Eigen::Vector3d::Constant(1.0 / (kPriorTranslationM * kPriorTranslationM)),
      Eigen::Vector3d::Constant(1.0 / (kPriorRotationRad * kPriorRotationRad));
  SE3 T = start;
  for (const double widening : widenings) {
    // On the way, half of the points do.
    last = linearise(points, T, noise, widening, widening > kHalfFrom ? 2 : 1);
    const Vector6d deviation = se3Log(T * predicted.inverse());
    last.H.diagonal() += prior;
    last.b -= prior.cwiseProduct(deviation);
    const Vector6d step = last.H.ldlt().solve(last.b);
    if (!step.allFinite()) break;
    T = se3Exp(step) * T;
  }
  return T;
}

/// Rigid motion of three points (Kabsch).
SE3 alignThree(const std::array<const FlowPoint*, 3>& sample) {
  Eigen::Matrix3d from, to;
  for (int i = 0; i < 3; ++i) {
    from.col(i) = sample[i]->point_current.cast<double>();
    const Eigen::Vector3f ray = sample[i]->ray_previous.homogeneous();
    to.col(i) = (ray * sample[i]->depth_previous_m).cast<double>();
  }
  const Eigen::Vector3d from_mean = from.rowwise().mean(), to_mean = to.rowwise().mean();
  const Eigen::Matrix3d cross = (to.colwise() - to_mean) * (from.colwise() - from_mean).transpose();
  const Eigen::JacobiSVD<Eigen::Matrix3d> svd(cross, Eigen::ComputeFullU | Eigen::ComputeFullV);
  const double sign = (svd.matrixU() * svd.matrixV().transpose()).determinant() < 0.0 ? -1.0 : 1.0;
  SE3 T = SE3::Identity();
  T.linear() = svd.matrixU() * Eigen::Vector3d(1.0, 1.0, sign).asDiagonal() * svd.matrixV().transpose();
  T.translation() = to_mean - T.linear() * from_mean;
  return T;
}

SE3 drawStart(const std::vector<FlowPoint>& points, const NoiseModel& noise) {
  std::vector<const FlowPoint*> pool;
  for (const FlowPoint& point : points) {
    if (point.depth_previous_m > 0.0F && point.weight > 0.1F) pool.push_back(&point);
  }
  SE3 best = SE3::Identity();
  if (pool.size() < 3) return best;
  Rng rng(7);
  // Three noisy points give a rough motion only: score it with wide noise, the refinement narrows it.
  const NoiseModel wide{4.0 * noise.flow_sigma, 4.0 * noise.depth_sigma_at_1m_m};
  const std::size_t stride = std::max<std::size_t>(1, points.size() / kScoredPoints);
  double best_share = -1.0;
  for (int draw = 0; draw < kRansacDraws; ++draw) {
    const SE3 T =
        alignThree({pool[rng.below(pool.size())], pool[rng.below(pool.size())], pool[rng.below(pool.size())]});
    if (!T.matrix().allFinite()) continue;
    const double share = explainedShare(points, T, wide, stride);
    if (share > best_share) {
      best_share = share;
      best = T;
    }
  }
  return best;
}

/// Median over the inliers of the flow residual's size, scaled to a standard deviation per axis.
double measureFlowSigma(const std::vector<FlowPoint>& points, const SE3& T, const NoiseModel& noise) {
  const Eigen::Matrix3d R = T.linear();
  const Eigen::Vector3d t = T.translation();
  std::vector<double> sizes;
  sizes.reserve(points.size());
  for (const FlowPoint& point : points) {
    if (point.weight < 0.2F) continue;
    const Residual r = residualOf(point, R, t, noise);
    const double squared = r.u * r.u + r.v * r.v;
    if (squared < 4.0 * kInlierSigmas * kInlierSigmas) sizes.push_back(squared);
  }
  if (sizes.empty()) return noise.flow_sigma;
  std::nth_element(sizes.begin(), sizes.begin() + sizes.size() / 2, sizes.end());
  return noise.flow_sigma * std::sqrt(sizes[sizes.size() / 2] / 1.386);  // median of chi2 with 2 degrees of freedom
}

}  // namespace

std::vector<FlowPoint> selectFlowPoints(const GridFrame& previous, const GridFrame& current,
                                        const cv::Mat2f& flow_cells, const cv::Mat1f& static_weight,
                                        const WorkGrid& grid) {
  std::vector<FlowPoint> points;
  points.reserve(static_cast<std::size_t>(grid.size().area()) / (kBlockCells * kBlockCells));
  for (int block_y = 0; block_y + kBlockCells <= grid.size().height; block_y += kBlockCells) {
    for (int block_x = 0; block_x + kBlockCells <= grid.size().width; block_x += kBlockCells) {
      cv::Point best(-1, -1);
      float best_texture = kLeastTexture;
      for (int y = block_y; y < block_y + kBlockCells; ++y) {
        for (int x = block_x; x < block_x + kBlockCells; ++x) {
          const float z = current.depth_m(y, x);
          if (current.texture(y, x) <= best_texture || z <= 0.0F) continue;
          if (current.depth_high_m(y, x) - current.depth_low_m(y, x) > kEdgeShare * z) continue;
          best_texture = current.texture(y, x);
          best = {x, y};
        }
      }
      if (best.x < 0) continue;
      const cv::Vec2f flow = flow_cells(best);
      const cv::Point2f before(static_cast<float>(best.x) - flow[0], static_cast<float>(best.y) - flow[1]);
      if (!grid.contains(before)) continue;
      FlowPoint point;
      const cv::Vec2f ray = grid.rays()(best), ray_before = grid.rayAt(before.x, before.y);
      point.point_current = Eigen::Vector3f(ray[0], ray[1], 1.0F) * current.depth_m(best);
      point.ray_previous = {ray_before[0], ray_before[1]};
      const cv::Point cell(cvRound(before.x), cvRound(before.y));
      const float z_before = previous.depth_m(cell);
      const bool on_edge = previous.depth_high_m(cell) - previous.depth_low_m(cell) > kEdgeShare * z_before;
      point.depth_previous_m = on_edge ? 0.0F : z_before;
      const float trust = best_texture * best_texture;
      point.weight = trust / (trust + kHalfTrustTexture * kHalfTrustTexture);
      if (!static_weight.empty()) point.weight *= static_weight(best);
      points.push_back(point);
    }
  }
  return points;
}

CameraMotion estimateCameraMotion(const std::vector<FlowPoint>& points, const WorkGrid& grid,
                                  const SE3& T_previous_current_predicted, const RigidFlowConfig& config) {
  CameraMotion motion;
  if (points.size() < static_cast<std::size_t>(config.min_points)) return motion;
  const double focal_px = 2.0 * grid.focalCells();  // of the image the flow is computed on
  NoiseModel noise{config.flow_sigma_px / focal_px, config.depth_sigma_at_1m_m};

  NormalEquations normal;
  SE3 best = refine(points, T_previous_current_predicted, T_previous_current_predicted, noise, kWidening, normal);
  double share = explainedShare(points, best, noise, 1);
  const auto consider = [&](const SE3& start, double factor) {
    NormalEquations other_normal;
    const SE3 other = refine(points, start, T_previous_current_predicted, noise, kWidening, other_normal);
    const double other_share = explainedShare(points, other, noise, 1);
    if (other_share <= factor * share) return;
    best = other;
    share = other_share;
    normal = other_normal;
  };
  // Blurred images spread the flow of a good motion: no reason to look for another.
  const NoiseModel blurred{2.0 * noise.flow_sigma, noise.depth_sigma_at_1m_m};
  if (share < kGoodShare && explainedShare(points, best, blurred, 1) < kGoodShare) {
    consider(SE3::Identity(), 1.0);
    if (share < kGoodShare) consider(drawStart(points, noise), kClearlyMore);
  }
  // Blur, exposure and depth that lags behind colour widen the flow's spread: this frame's own is what residuals mean.
  noise.flow_sigma = std::max(measureFlowSigma(points, best, noise), noise.flow_sigma);
  best = refine(points, best, T_previous_current_predicted, noise, kNarrow, normal);
  double weight = 1e-9, inlier_weight = 0.0;
  for (const FlowPoint& point : points) {
    const Residual r = residualOf(point, best.linear(), best.translation(), noise);
    const bool inlier = r.u * r.u + r.v * r.v < kInlierSigmas * kInlierSigmas;
    weight += point.weight;
    inlier_weight += inlier ? point.weight : 0.0F;
    motion.inliers += inlier ? 1 : 0;
  }
  motion.T_previous_current = best;
  motion.inlier_share = inlier_weight / weight;
  motion.flow_sigma_px = noise.flow_sigma * focal_px * 0.5 * grid.cellPx();
  const Matrix6d covariance = normal.H.ldlt().solve(Matrix6d::Identity());
  motion.translation_sigma_m = std::sqrt(covariance.diagonal().head<3>().maxCoeff());
  motion.rotation_sigma_rad = std::sqrt(covariance.diagonal().tail<3>().maxCoeff());
  motion.valid = best.matrix().allFinite() && motion.inliers >= config.min_points / 2 &&
                 motion.inlier_share >= config.min_inlier_share;
  return motion;
}

}  // namespace semantic_vslam
