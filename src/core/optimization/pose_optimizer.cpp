// SPDX-FileCopyrightText: 2026 The semantic_vslam authors
// SPDX-License-Identifier: BSD-3-Clause
#include "core/optimization/pose_optimizer.h"

#include <ceres/tiny_solver.h>

#include <Eigen/Cholesky>
#include <algorithm>
#include <cmath>
#include <utility>

namespace semantic_vslam {
namespace {

using Measurements = std::vector<PixelMeasurement>;

Measurements makeMeasurements(const PoseProblem& problem, const VirtualStereo& camera) {
  Measurements measurements;
  measurements.reserve(problem.observations.size());
  for (const auto& observation : problem.observations) {
    measurements.push_back(makeMeasurement(observation.undistorted_px, observation.depth_m, observation.sigma_px,
                                           observation.weight, camera, problem.sensor));
  }
  return measurements;
}

PoseCost makeCost(const PoseProblem& problem, const VirtualStereo& camera, const Measurements& measurements,
                  const std::vector<bool>& active, const SE3& T_camera_world) {
  std::vector<PoseCost::Point> points;
  points.reserve(active.size());
  for (std::size_t i = 0; i < active.size(); ++i) {
    if (active[i]) points.push_back({T_camera_world * problem.observations[i].point_world, measurements[i]});
  }
  return PoseCost(camera, points);
}

/// Stops the solver when a step changes the cost by less. Ceres 1.14 (Ubuntu 20.04, Debian 11) has no such option and
/// takes the steps that are left: the second form, which any other type of the last argument than int chooses.
template <class Options>
auto stopAtChange(Options& options, double of_cost, int) -> decltype(static_cast<void>(options.function_tolerance)) {
  options.function_tolerance = of_cost;
}
template <class Options>
void stopAtChange(Options&, double, long) {}

SE3 minimise(const PoseCost& cost, const SE3& T0, int iterations) {
  ceres::TinySolver<PoseCost> solver;
  solver.options.max_num_iterations = iterations;
  // Of chi-square, absolute: the step that is left is a thirtieth of the pose's standard deviation.
  stopAtChange(solver.options, 1e-3, 0);
  Vector6d increment = Vector6d::Zero();
  solver.Solve(cost, &increment);
  return PoseIncrement(increment.data()).apply(T0);
}

/// Chi-square test of every observation.
std::vector<bool> judge(const PoseProblem& problem, const VirtualStereo& camera, const Measurements& measurements,
                        const SE3& T_camera_world) {
  std::vector<bool> inlier(measurements.size());
  for (std::size_t i = 0; i < measurements.size(); ++i) {
    inlier[i] = fits(camera, measurements[i], T_camera_world * problem.observations[i].point_world);
  }
  return inlier;
}

std::vector<bool> inFront(const PoseProblem& problem) {
  std::vector<bool> active(problem.observations.size());
  for (std::size_t i = 0; i < active.size(); ++i) {
    active[i] = (problem.T_camera_world * problem.observations[i].point_world).z() >= kMinProjectionDepthM;
  }
  return active;
}

int countTrue(const std::vector<bool>& flags) { return static_cast<int>(std::count(flags.begin(), flags.end(), true)); }

/// Inverse of the information at the solution, scaled up where the residuals are larger than their sigmas promise.
/// @return false if not all six degrees of freedom are fixed.
bool computeCovariance(const PoseCost& cost, Matrix6d* covariance) {
  Eigen::VectorXd residuals(cost.NumResiduals());
  Eigen::Matrix<double, Eigen::Dynamic, 6> jacobian(cost.NumResiduals(), 6);
  const Vector6d zero = Vector6d::Zero();
  cost(zero.data(), residuals.data(), jacobian.data());
  const Matrix6d information = jacobian.transpose() * jacobian;
  const Eigen::LLT<Matrix6d> llt(information);
  // Past this condition number one direction is at least 1e6 times less certain than another: not measured at all.
  constexpr double kMinReciprocalCondition = 1e-12;
  if (llt.info() != Eigen::Success || !(llt.rcond() > kMinReciprocalCondition)) return false;
  const double degrees_of_freedom = std::max(1.0, static_cast<double>(cost.NumResiduals()) - 6.0);
  const double variance_factor = std::max(1.0, residuals.squaredNorm() / degrees_of_freedom);
  *covariance = variance_factor * llt.solve(Matrix6d::Identity());
  return covariance->allFinite();
}

}  // namespace

PoseSolution optimizePose(const PoseProblem& problem, const PoseOptimizerConfig& config) {
  const VirtualStereo camera(problem.camera, problem.sensor.virtual_baseline_m);
  const Measurements measurements = makeMeasurements(problem, camera);

  PoseSolution solution;
  solution.T_camera_world = problem.T_camera_world;
  solution.inlier = inFront(problem);
  for (int round = 0; round < config.rounds; ++round) {
    if (countTrue(solution.inlier) < config.min_inliers) break;
    const PoseCost cost = makeCost(problem, camera, measurements, solution.inlier, solution.T_camera_world);
    solution.T_camera_world = minimise(cost, solution.T_camera_world, config.iterations);
    std::vector<bool> inlier = judge(problem, camera, measurements, solution.T_camera_world);
    const bool settled = inlier == solution.inlier;
    solution.inlier = std::move(inlier);
    if (settled) break;
  }

  solution.inliers = countTrue(solution.inlier);
  solution.usable = solution.inliers >= config.min_inliers && solution.T_camera_world.matrix().allFinite() &&
                    computeCovariance(makeCost(problem, camera, measurements, solution.inlier, solution.T_camera_world),
                                      &solution.covariance);
  if (!solution.usable) solution.T_camera_world = problem.T_camera_world;
  return solution;
}

}  // namespace semantic_vslam
