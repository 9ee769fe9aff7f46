// SPDX-FileCopyrightText: 2026 The semantic_vslam authors
// SPDX-License-Identifier: BSD-3-Clause
#include "core/motion/camera_motion.h"

#include <Eigen/Cholesky>
#include <algorithm>
#include <array>
#include <cmath>
#include <utility>

#include "core/common/rng.h"

namespace semantic_vslam {
namespace {

// One point per block of 5x5 cells: 768 points at 160x120, evenly spread.
constexpr int kBlockCells = 5;
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
// What a hand's or a wheel's velocity changes by (its acceleration and its angular acceleration), and the least step in
// time that this is reckoned for: the prediction itself is a motion that was measured, wrong by 5 mm and 0.6 degrees. A
// bound as tight for frames that lie far apart would hold the camera where it cannot be, just when people leave little
// of the room to say so.
constexpr double kAcceleration = 1.125, kAngularAcceleration = 2.25;  // m/s^2, rad/s^2
constexpr double kShortestStepS = 1.0 / 15.0;
constexpr double kGoodShare = 0.6;
// Other motions are drawn from so many points of optical flow, which is exact to a few tenths of a pixel: the motion of
// three points whose depth is noisy would be wrong by half a degree. They lie about the prediction as a hand may jerk.
constexpr std::size_t kSamplePoints = 4;
constexpr int kDraws = 200, kSampleSteps = 2;
constexpr double kJerkMS = 0.45, kJerkRadS = 0.75;  // at once: m/s, rad/s
constexpr std::size_t kScoredPoints = 150;
constexpr double kDrawnNoise = 2.0;  // four points give a rough motion: times the noise
constexpr std::size_t kTriedStarts = 3;
constexpr double kSameStart = 0.008;  // metres and radians together: nearer starts end at one motion
constexpr double kDrawnWidening[] = {1.5, 1.0, 1.0};
constexpr double kClearlyMore = 1.25;
// A motion explains two thirds of the weight of its own points, for the noise in the three residuals of each: where one
// explains more than this share of all surface, none can explain kClearlyMore times as much.
constexpr double kBeyondRivals = 0.3;
// From this distance on somebody fills less than a tenth of the view, and depth tells little: it counts as this far.
constexpr float kFarM = 3.0F;

struct NoiseModel {
  double flow_sigma;  // in units of the ray
  double depth_sigma_at_1m_m;
};

/// The points one coordinate after the other, so that the loops over them take four at a time.
struct PointColumns {
  explicit PointColumns(const std::vector<FlowPoint>& points, std::size_t stride = 1) {
    const auto count = static_cast<Eigen::Index>((points.size() + stride - 1) / stride);
    for (auto* column : {&x, &y, &z, &ray_x, &ray_y, &depth_previous_m, &weight}) column->resize(count);
    for (Eigen::Index i = 0; i < count; ++i) {
      const FlowPoint& point = points[static_cast<std::size_t>(i) * stride];
      x[i] = point.point_current.x();
      y[i] = point.point_current.y();
      z[i] = point.point_current.z();
      ray_x[i] = point.ray_previous.x();
      ray_y[i] = point.ray_previous.y();
      depth_previous_m[i] = point.depth_previous_m;
      weight[i] = point.weight;
    }
  }

  Eigen::ArrayXf x, y, z, ray_x, ray_y, depth_previous_m, weight;
};

/// Residuals in standard deviations: two of flow, one of depth (0 where unmeasured).
struct Residuals {
  Residuals(const PointColumns& points, const SE3& T, const NoiseModel& noise) {
    const Eigen::Matrix3f R = T.linear().cast<float>();
    const Eigen::Vector3f t = T.translation().cast<float>();
    const auto coordinate = [&](int axis) {
      return R(axis, 0) * points.x + R(axis, 1) * points.y + R(axis, 2) * points.z + t[axis];
    };
    constexpr float kOfTwoDepths = 1.41421356F;
    const auto per_flow_sigma = static_cast<float>(1.0 / noise.flow_sigma);
    const float depth_sigma = kOfTwoDepths * static_cast<float>(noise.depth_sigma_at_1m_m);
    x = coordinate(0);
    y = coordinate(1);
    z = coordinate(2);
    inverse_z = z.max(1e-3F).inverse();
    u = (x * inverse_z - points.ray_x) * per_flow_sigma;
    v = (y * inverse_z - points.ray_y) * per_flow_sigma;
    per_depth_sigma = (depth_sigma * z.square().max(0.25F)).inverse();
    per_depth_sigma = (points.depth_previous_m > 0.0F).select(per_depth_sigma, 0.0F);
    d = (z - points.depth_previous_m) * per_depth_sigma;
  }
  Eigen::ArrayXf flowSquared() const { return u.square() + v.square(); }

  Eigen::ArrayXf x, y, z, inverse_z;  ///< where the points were, metres
  Eigen::ArrayXf u, v, d;
  Eigen::ArrayXf per_depth_sigma;  ///< 1/m; 0 where unmeasured
};

/// @param squared  of the residual  @return weights, 1 for none
Eigen::ArrayXf gemanMcClure(const Eigen::ArrayXf& squared, float scale_squared) {
  return (scale_squared / (scale_squared + squared)).square();
}

/// Share of the weight that a motion explains; each point counts less the farther it is from it.
double explainedShare(const PointColumns& points, const Eigen::ArrayXf& weight, const SE3& T, const NoiseModel& noise) {
  const Residuals r(points, T, noise);
  constexpr auto kBound = static_cast<float>(kInlierSigmas * kInlierSigmas);
  const Eigen::ArrayXf near = (1.0F - (r.flowSquared() + r.d.square()) / kBound).max(0.0F);
  return (weight * near).sum() / (weight.sum() + 1e-9F);
}

/// The surface that points stand for, by their weight, instead of the part of the image: somebody within arm's length
/// covers more of the view than the room does, but less of a surface.
Eigen::ArrayXf surfaceWeights(const PointColumns& points) { return points.weight * points.z.min(kFarM).square(); }

struct NormalEquations {
  Matrix6d H = Matrix6d::Zero();
  Vector6d b = Vector6d::Zero();
};

NormalEquations linearise(const PointColumns& points, const SE3& T, const NoiseModel& noise, double widening) {
  const Residuals r(points, T, noise);
  const auto scale_squared = static_cast<float>(kInlierSigmas * kInlierSigmas * widening * widening);
  const Eigen::ArrayXf weight = points.weight * gemanMcClure(r.flowSquared(), scale_squared);
  const Eigen::ArrayXf root = weight.sqrt();
  const Eigen::ArrayXf depth_root = (weight * gemanMcClure(r.d.square(), scale_squared)).sqrt();
  const Eigen::ArrayXf k = root * r.inverse_z * static_cast<float>(1.0 / noise.flow_sigma);
  const Eigen::ArrayXf a = r.x * r.inverse_z, c = r.y * r.inverse_z, z = r.z.max(1e-3F);
  const Eigen::ArrayXf q = depth_root * r.per_depth_sigma;
  const Eigen::Index n = points.x.size();
  // d(x/z, y/z, z) / d(translation, rotation) of a left perturbation, weighted: u, then v, then depth.
  Eigen::Matrix<float, Eigen::Dynamic, 6> J(3 * n, 6);
  Eigen::VectorXf e(3 * n);
  J.topRows(n) << k, Eigen::ArrayXf::Zero(n), -k * a, -k * a * r.y, k * (z + a * r.x), -k * r.y;
  J.middleRows(n, n) << Eigen::ArrayXf::Zero(n), k, -k * c, -k * (z + c * r.y), k * c * r.x, k * r.x;
  J.bottomRows(n) << Eigen::ArrayXf::Zero(n), Eigen::ArrayXf::Zero(n), q, q * r.y, -q * r.x, Eigen::ArrayXf::Zero(n);
  e << root * r.u, root * r.v, depth_root * r.d;
  NormalEquations normal;
  for (int row = 0; row < 6; ++row) {
    for (int col = 0; col <= row; ++col) normal.H(row, col) = normal.H(col, row) = J.col(row).dot(J.col(col));
    normal.b[row] = -J.col(row).dot(e);
  }
  return normal;
}

/// Where the motion should be, and how surely.
struct Prediction {
  SE3 T_previous_current;
  double step_s;  ///< kShortestStepS at least

  /// 1 / variance, of the translation and of the rotation, for standard deviations.
  static Vector6d information(double sigma_m, double sigma_rad) {
    Vector6d diagonal;
    diagonal << Eigen::Vector3d::Constant(1.0 / (sigma_m * sigma_m)),
        Eigen::Vector3d::Constant(1.0 / (sigma_rad * sigma_rad));
    return diagonal;
  }
  Vector6d ofUsual() const {
    return information(kAcceleration * step_s * step_s, kAngularAcceleration * step_s * step_s);
  }
  Vector6d ofJerk() const { return information(kJerkMS * step_s, kJerkRadS * step_s); }
  Vector6d deviation(const SE3& T) const { return se3Log(T * T_previous_current.inverse()); }
};

template <std::size_t kSteps>
SE3 refine(const PointColumns& points, const PointColumns& half, const SE3& start, const Prediction& predicted,
           const NoiseModel& noise, const double (&widenings)[kSteps], NormalEquations& last) {
  const Vector6d prior = predicted.ofUsual();
  SE3 T = start;
  for (const double widening : widenings) {
    // On the way, half of the points do.
    last = linearise(widening > kHalfFrom ? half : points, T, noise, widening);
    last.H.diagonal() += prior;
    last.b -= prior.cwiseProduct(predicted.deviation(T));
    const Vector6d step = last.H.ldlt().solve(last.b);
    if (!step.allFinite()) break;
    T = se3Exp(step) * T;
  }
  return T;
}

using Sample = std::array<const FlowPoint*, kSamplePoints>;

/// Motion near the prediction that the flow of a few points asks for.
SE3 motionOf(const Sample& sample, const Prediction& predicted, const NoiseModel& noise) {
  const Vector6d prior = predicted.ofJerk();
  SE3 T = predicted.T_previous_current;
  for (int step = 0; step < kSampleSteps; ++step) {
    Matrix6d H = prior.asDiagonal();
    Vector6d b = -prior.cwiseProduct(predicted.deviation(T));
    for (const FlowPoint* point : sample) {
      const Eigen::Vector3d p = T * point->point_current.cast<double>();
      const double inverse_z = 1.0 / std::max(p.z(), 1e-3), x = p.x() * inverse_z, y = p.y() * inverse_z;
      Eigen::Matrix<double, 2, 6> J;
      J << inverse_z, 0.0, -inverse_z * x, -x * y, 1.0 + x * x, -y,  //
          0.0, inverse_z, -inverse_z * y, -1.0 - y * y, x * y, x;
      J /= noise.flow_sigma;
      const Eigen::Vector2d error = (Eigen::Vector2d(x, y) - point->ray_previous.cast<double>()) / noise.flow_sigma;
      H += J.transpose() * J;
      b -= J.transpose() * error;
    }
    T = se3Exp(H.ldlt().solve(b)) * T;
  }
  return T;
}

/// The motions that explain most surface, of those that a few points each ask for; best first.
std::vector<SE3> drawStarts(const std::vector<FlowPoint>& points, const Prediction& predicted,
                            const NoiseModel& noise) {
  std::vector<const FlowPoint*> pool;
  for (const FlowPoint& point : points) {
    if (point.weight > 0.1F) pool.push_back(&point);
  }
  if (pool.size() < kSamplePoints) return {};
  const NoiseModel wide{kDrawnNoise * noise.flow_sigma, kDrawnNoise * noise.depth_sigma_at_1m_m};
  const PointColumns scored(points, std::max<std::size_t>(1, points.size() / kScoredPoints));
  const Eigen::ArrayXf surface = surfaceWeights(scored);
  std::vector<std::pair<double, SE3>> drawn;
  Rng rng(7);
  for (int draw = 0; draw < kDraws; ++draw) {
    Sample sample{};
    for (const FlowPoint*& point : sample) point = pool[rng.below(pool.size())];
    const SE3 T = motionOf(sample, predicted, noise);
    if (T.matrix().allFinite()) drawn.emplace_back(explainedShare(scored, surface, T, wide), T);
  }
  std::stable_sort(drawn.begin(), drawn.end(), [](const auto& a, const auto& b) { return a.first > b.first; });
  std::vector<SE3> best;
  for (const auto& [share, T] : drawn) {
    const bool known = std::any_of(best.begin(), best.end(), [&T = T](const SE3& other) {
      const Vector6d apart = se3Log(T * other.inverse());
      return apart.head<3>().norm() + apart.tail<3>().norm() <= kSameStart;
    });
    if (!known) best.push_back(T);
    if (best.size() == kTriedStarts) break;
  }
  return best;
}

/// Median over the inliers of the flow residual's size, scaled to a standard deviation per axis.
double measureFlowSigma(const PointColumns& points, const SE3& T, const NoiseModel& noise) {
  const Eigen::ArrayXf squared = Residuals(points, T, noise).flowSquared();
  std::vector<float> sizes;
  sizes.reserve(static_cast<std::size_t>(squared.size()));
  for (Eigen::Index i = 0; i < squared.size(); ++i) {
    const bool counts = points.weight[i] >= 0.2F && squared[i] < 4.0 * kInlierSigmas * kInlierSigmas;
    if (counts) sizes.push_back(squared[i]);
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
  const auto usable = [&](int x, int y) {
    const float z = current.depth_m(y, x);
    return z > 0.0F && current.depth_high_m(y, x) - current.depth_low_m(y, x) <= kEdgeShare * z;
  };
  forEachTexturedBlock(current.texture, kBlockCells, usable, [&](const cv::Point& best) {
    const cv::Vec2f flow = flow_cells(best);
    const cv::Point2f before(static_cast<float>(best.x) - flow[0], static_cast<float>(best.y) - flow[1]);
    if (!grid.contains(before)) return;
    FlowPoint point;
    const cv::Vec2f ray = grid.rays()(best), ray_before = grid.rayAt(before.x, before.y);
    point.point_current = Eigen::Vector3f(ray[0], ray[1], 1.0F) * current.depth_m(best);
    point.ray_previous = {ray_before[0], ray_before[1]};
    const cv::Point cell(cvRound(before.x), cvRound(before.y));
    const float z_before = previous.depth_m(cell);
    const bool on_edge = previous.depth_high_m(cell) - previous.depth_low_m(cell) > kEdgeShare * z_before;
    point.depth_previous_m = on_edge ? 0.0F : z_before;
    const float trust = current.texture(best) * current.texture(best);
    point.weight = trust / (trust + kHalfTrustTexture * kHalfTrustTexture);
    if (!static_weight.empty()) point.weight *= static_weight(best);
    points.push_back(point);
  });
  return points;
}

CameraMotion estimateCameraMotion(const std::vector<FlowPoint>& points, const WorkGrid& grid,
                                  const SE3& T_previous_current_predicted, double step_s,
                                  const RigidFlowConfig& config) {
  CameraMotion motion;
  if (points.size() < static_cast<std::size_t>(config.min_points)) return motion;
  const double focal_px = 2.0 * grid.focalCells();  // at flow.width_px
  NoiseModel noise{config.flow_sigma_px / focal_px, config.depth_noise.motion_m};

  const Prediction predicted{T_previous_current_predicted, std::max(step_s, kShortestStepS)};
  const PointColumns all(points), half(points, 2);
  NormalEquations normal;
  SE3 best = refine(all, half, predicted.T_previous_current, predicted, noise, kWidening, normal);
  // Blurred images spread the flow of a good motion: no reason to look for another.
  const NoiseModel blurred{2.0 * noise.flow_sigma, noise.depth_sigma_at_1m_m};
  if (explainedShare(all, all.weight, best, noise) < kGoodShare &&
      explainedShare(all, all.weight, best, blurred) < kGoodShare) {
    const Eigen::ArrayXf surface = surfaceWeights(all);
    double most = explainedShare(all, surface, best, noise);
    const auto consider = [&](const SE3& start, const auto& widenings, double factor) {
      NormalEquations other_normal;
      const SE3 other = refine(all, half, start, predicted, noise, widenings, other_normal);
      const double other_share = explainedShare(all, surface, other, noise);
      if (other_share <= factor * most) return;
      best = other;
      most = other_share;
      normal = other_normal;
    };
    consider(SE3::Identity(), kWidening, 1.0);
    if (most < kBeyondRivals) {
      for (const SE3& start : drawStarts(points, predicted, noise)) {
        consider(start, kDrawnWidening, kClearlyMore);
      }
    }
  }
  // Blur, exposure and depth that lags behind colour widen the flow's spread: this frame's own is what residuals mean.
  noise.flow_sigma = std::max(measureFlowSigma(all, best, noise), noise.flow_sigma);
  best = refine(all, half, best, predicted, noise, kNarrow, normal);
  constexpr auto kBound = static_cast<float>(kInlierSigmas * kInlierSigmas);
  const auto inliers = (Residuals(all, best, noise).flowSquared() < kBound).eval();
  motion.inliers = static_cast<int>(inliers.count());
  motion.T_previous_current = best;
  motion.inlier_share = inliers.select(all.weight, 0.0F).sum() / (all.weight.sum() + 1e-9F);
  motion.flow_sigma_px = noise.flow_sigma * focal_px * 0.5 * grid.cellPx();
  const Matrix6d covariance = normal.H.ldlt().solve(Matrix6d::Identity());
  motion.translation_sigma_m = std::sqrt(covariance.diagonal().head<3>().maxCoeff());
  motion.rotation_sigma_rad = std::sqrt(covariance.diagonal().tail<3>().maxCoeff());
  motion.valid = best.matrix().allFinite() && motion.inliers >= config.min_points / 2 &&
                 motion.inlier_share >= config.min_inlier_share;
  return motion;
}

}  // namespace semantic_vslam
