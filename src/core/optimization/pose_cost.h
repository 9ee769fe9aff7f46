// SPDX-FileCopyrightText: 2026 The semantic_vslam authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <optional>
#include <vector>

#include "core/camera/observation_model.h"
#include "core/optimization/pose_increment.h"
#include "semantic_vslam/core/geometry/se3.h"

namespace semantic_vslam {

/// Knowledge of a pose from elsewhere (motion model, odometry).
struct PosePrior {
  SE3 T_camera_world = SE3::Identity();
  Matrix6d information = Matrix6d::Zero();  ///< of the left perturbation (m, rad), positive semi-definite
};

/// Reprojection cost of one camera pose over all of its fixed points, as one function of the six increments of
/// PoseIncrement: 3 robust residuals a point, in the order of the points, and 6 of the prior at the end.
/// Written for ceres::TinySolver, whose function it is; plain Eigen otherwise.
class PoseCost {
 public:
  using Scalar = double;
  enum { NUM_RESIDUALS = Eigen::Dynamic, NUM_PARAMETERS = 6 };

  struct Point {
    Eigen::Vector3d point_camera;  ///< at the pose around which increments are taken: T0 * p_world, metres
    PixelMeasurement measurement;
  };

  /// @param T0  pose around which increments are taken
  PoseCost(const VirtualStereo& camera, const SE3& T0, const std::vector<Point>& points,
           const std::optional<PosePrior>& prior);

  int NumResiduals() const { return static_cast<int>(3 * terms_.size()) + (has_prior_ ? 6 : 0); }

  /// @param increment  6 values   @param residuals  NumResiduals() values
  /// @param jacobian   NumResiduals() x 6, column-major, or nullptr
  /// @return true; a point that comes too near the image plane has no residual.
  bool operator()(const double* increment, double* residuals, double* jacobian) const;

 private:
  /// A point with all that does not depend on the pose worked out: evaluated a dozen times for each frame.
  struct Term {
    Term(const VirtualStereo& camera, const Point& point);
    void evaluate(const PoseIncrement& increment, const Eigen::Matrix3d& rotation_jacobian, Eigen::Vector3d* residual,
                  Eigen::Matrix<double, 3, 6>* jacobian) const;

    Eigen::Vector3d point_camera;  ///< metres
    Eigen::Vector3d measured;      ///< u, v from the principal point and disparity, each over its sigma; 0 = no depth
    Eigen::Vector3d focal;         ///< fx, fy, fx * baseline, each over the sigma: measured = focal * (x, y, 1) / z
    double chi2_bound, root_weight;
  };

  std::vector<Term> terms_;
  bool has_prior_ = false;
  SE3 T_pose_prior_ = SE3::Identity();  ///< T0 * prior^-1
  Matrix6d prior_sqrt_information_ = Matrix6d::Zero();
};

}  // namespace semantic_vslam
