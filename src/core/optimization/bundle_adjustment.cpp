// SPDX-FileCopyrightText: 2026 The semantic_vslam authors
// SPDX-License-Identifier: BSD-3-Clause
#include "core/optimization/bundle_adjustment.h"

#include <ceres/ceres.h>

#include <array>
#include <cmath>
#include <memory>

#include "core/optimization/abort_callback.h"
#include "core/optimization/pose_optimizer.h"
#include "core/optimization/reprojection_cost.h"

namespace semantic_vslam {
namespace {

// The reduced camera matrix is dense for a local map; from about here on most keyframes share no landmark.
constexpr int kMaxKeyframesDense = 40;

template <int kResiduals>
class CeresReprojectionCost : public ceres::SizedCostFunction<kResiduals, 6, 3> {
 public:
  explicit CeresReprojectionCost(const ReprojectionCost<kResiduals>& cost) : cost_(cost) {}
  bool Evaluate(double const* const* parameters, double* residuals, double** jacobians) const override {
    cost_.evaluate(parameters[0], parameters[1], residuals, jacobians != nullptr ? jacobians[0] : nullptr,
                   jacobians != nullptr ? jacobians[1] : nullptr);
    return true;
  }

 private:
  ReprojectionCost<kResiduals> cost_;
};

/// Values that a solve works on.
struct State {
  std::vector<std::array<double, 6>> increments;  ///< per keyframe, around the problem's pose
  std::vector<Eigen::Vector3d> positions;         ///< per landmark

  explicit State(const BaProblem& problem) : increments(problem.keyframes.size(), std::array<double, 6>{}) {
    positions.reserve(problem.landmarks.size());
    for (const auto& landmark : problem.landmarks) positions.push_back(landmark.position_world);
  }
  SE3 pose(const BaProblem& problem, int keyframe) const {
    return PoseIncrement(increments[keyframe].data()).apply(problem.keyframes[keyframe].T_camera_world);
  }
};

/// What stays the same through the rounds.
struct Observed {
  std::vector<VirtualStereo> cameras;  ///< per keyframe
  std::vector<PixelMeasurement> measurements;
  std::vector<int> sightings;  ///< per landmark

  explicit Observed(const BaProblem& problem) : sightings(problem.landmarks.size(), 0) {
    for (const auto& keyframe : problem.keyframes) {
      cameras.emplace_back(keyframe.camera, problem.sensor.virtual_baseline_m);
    }
    measurements.reserve(problem.observations.size());
    for (const auto& o : problem.observations) {
      measurements.push_back(
          makeMeasurement(o.undistorted_px, o.depth_m, o.sigma_px, o.weight, cameras[o.keyframe], problem.sensor));
      ++sightings[o.landmark];
    }
  }
  /// A landmark seen once fits its one sighting or constrains nothing.
  bool adjusted(int landmark) const { return sightings[landmark] >= 2; }
};

std::vector<bool> judge(const BaProblem& problem, const Observed& observed, const State& state) {
  std::vector<SE3> poses;
  for (std::size_t k = 0; k < problem.keyframes.size(); ++k) poses.push_back(state.pose(problem, static_cast<int>(k)));
  std::vector<bool> inlier(problem.observations.size());
  for (std::size_t i = 0; i < inlier.size(); ++i) {
    const auto& o = problem.observations[i];
    inlier[i] = !observed.adjusted(o.landmark) || fits(observed.cameras[o.keyframe], observed.measurements[i],
                                                       poses[o.keyframe] * state.positions[o.landmark]);
  }
  return inlier;
}

std::vector<bool> inFront(const BaProblem& problem) {
  std::vector<bool> active;
  active.reserve(problem.observations.size());
  for (const auto& o : problem.observations) {
    const Eigen::Vector3d p =
        problem.keyframes[o.keyframe].T_camera_world * problem.landmarks[o.landmark].position_world;
    active.push_back(p.z() >= kMinProjectionDepthM);
  }
  return active;
}

std::unique_ptr<ceres::CostFunction> makeCost(const VirtualStereo& camera, const SE3& T0, const PixelMeasurement& m) {
  if (m.hasDepth()) return std::make_unique<CeresReprojectionCost<3>>(ReprojectionCost<3>{camera, T0, m});
  return std::make_unique<CeresReprojectionCost<2>>(ReprojectionCost<2>{camera, T0, m});
}

/// One round over the active observations. The problem object owns costs and kernels.
class Round {
 public:
  Round(const BaProblem& problem, const Observed& observed, const std::vector<bool>& active, State& state)
      : problem_(ownNothingShared()) {
    for (std::size_t i = 0; i < active.size(); ++i) {
      const auto& o = problem.observations[i];
      if (!active[i] || !observed.adjusted(o.landmark) || o.weight <= 0.0) continue;
      const auto& m = observed.measurements[i];
      double* increment = state.increments[o.keyframe].data();
      double* position = state.positions[o.landmark].data();
      problem_.AddResidualBlock(
          makeCost(observed.cameras[o.keyframe], problem.keyframes[o.keyframe].T_camera_world, m).release(), kernel(m),
          increment, position);
      ordering_->AddElementToGroup(position, 0);
      ordering_->AddElementToGroup(increment, 1);
      if (problem.keyframes[o.keyframe].fixed) problem_.SetParameterBlockConstant(increment);
    }
    for (const auto& keyframe : problem.keyframes) free_keyframes_ += keyframe.fixed ? 0 : 1;
  }

  void run(int iterations, AbortCallback& abort) {
    ceres::Solver::Options options;
    options.max_num_iterations = iterations;
    options.num_threads = 1;
    options.linear_solver_type = free_keyframes_ <= kMaxKeyframesDense ? ceres::DENSE_SCHUR : ceres::SPARSE_SCHUR;
    options.linear_solver_ordering = ordering_;
    options.function_tolerance = 1e-4;
    options.logging_type = ceres::SILENT;
    options.callbacks.push_back(&abort);
    ceres::Solver::Summary summary;
    ceres::Solve(options, &problem_, &summary);
  }

 private:
  static ceres::Problem::Options ownNothingShared() {
    ceres::Problem::Options options;
    options.loss_function_ownership = ceres::DO_NOT_TAKE_OWNERSHIP;
    options.disable_all_safety_checks = true;
    return options;
  }

  ceres::LossFunction* kernel(const PixelMeasurement& m) {
    ceres::LossFunction* huber = m.hasDepth() ? &huber_depth_ : &huber_pixel_;
    if (m.weight == 1.0) return huber;
    scaled_.push_back(std::make_unique<ceres::ScaledLoss>(huber, m.weight, ceres::DO_NOT_TAKE_OWNERSHIP));
    return scaled_.back().get();
  }

  ceres::HuberLoss huber_pixel_{std::sqrt(kChi2Pixel)}, huber_depth_{std::sqrt(kChi2PixelAndDepth)};
  std::vector<std::unique_ptr<ceres::LossFunction>> scaled_;
  std::shared_ptr<ceres::ParameterBlockOrdering> ordering_ = std::make_shared<ceres::ParameterBlockOrdering>();
  int free_keyframes_ = 0;
  ceres::Problem problem_;
};

MapSolution makeSolution(const BaProblem& problem, const Observed& observed, const State& state,
                         const std::vector<bool>& inlier) {
  MapSolution solution;
  for (std::size_t k = 0; k < problem.keyframes.size(); ++k) {
    const auto& keyframe = problem.keyframes[k];
    if (!keyframe.fixed) solution.T_camera_world[keyframe.id] = state.pose(problem, static_cast<int>(k));
  }
  for (std::size_t l = 0; l < problem.landmarks.size(); ++l) {
    if (observed.adjusted(static_cast<int>(l))) solution.position_world[problem.landmarks[l].id] = state.positions[l];
  }
  for (std::size_t i = 0; i < problem.observations.size(); ++i) {
    const auto& o = problem.observations[i];
    const auto& keyframe = problem.keyframes[o.keyframe];
    const auto& landmark = problem.landmarks[o.landmark];
    if (!inlier[i]) solution.outlier_observations.emplace_back(keyframe.id, landmark.id);
    if (observed.adjusted(o.landmark) || keyframe.fixed) continue;
    solution.position_world[landmark.id] =
        state.pose(problem, o.keyframe).inverse() * (keyframe.T_camera_world * landmark.position_world);
  }
  return solution;
}

}  // namespace

MapSolution solve(const BaProblem& problem, const BaConfig& config, const AbortFlag* abort) {
  const Observed observed(problem);
  State state(problem);
  AbortCallback abort_callback(abort);
  std::vector<bool> active = inFront(problem), inlier(problem.observations.size(), true);
  for (const int iterations : {config.first_iterations, config.second_iterations}) {
    if (abort_callback.aborted()) break;
    Round(problem, observed, active, state).run(iterations, abort_callback);
    if (abort_callback.aborted()) break;  // an unfinished adjustment says nothing about who is wrong
    inlier = active = judge(problem, observed, state);
  }
  return makeSolution(problem, observed, state, inlier);
}

}  // namespace semantic_vslam
