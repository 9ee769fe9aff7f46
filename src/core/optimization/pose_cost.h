// SPDX-FileCopyrightText: 2026 The semantic_vslam authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <vector>

#include "core/camera/observation_model.h"
#include "core/optimization/pose_increment.h"
#include "semantic_vslam/core/geometry/se3.h"

namespace semantic_vslam {

/// Reprojection cost of one camera pose over all of its fixed points, as one function of the six increments of
/// PoseIncrement: 3 robust residuals a point, in the order of the points.
/// Written for ceres::TinySolver, whose function it is; plain Eigen otherwise.
class PoseCost {
 public:
  using Scalar = double;
  enum { NUM_RESIDUALS = Eigen::Dynamic, NUM_PARAMETERS = 6 };

  struct Point {
    Eigen::Vector3d point_camera;  ///< at the pose around which increments are taken: T0 * p_world, metres
    PixelMeasurement measurement;
  };

  PoseCost(const VirtualStereo& camera, const std::vector<Point>& points);

  int NumResiduals() const { return static_cast<int>(3 * terms_.size()); }

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
};

}  // namespace semantic_vslam
