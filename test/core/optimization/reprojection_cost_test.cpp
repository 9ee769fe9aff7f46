// SPDX-FileCopyrightText: 2026 The semantic_vslam authors
// SPDX-License-Identifier: BSD-3-Clause
#include "core/optimization/reprojection_cost.h"

#include <gtest/gtest.h>

#include "numeric_jacobian.h"

namespace semantic_vslam {
namespace {

template <int kResiduals>
void expectNumericJacobians(const Vector6d& increment) {
  Vector6d tangent;
  tangent << 0.2, -0.1, 0.3, 0.4, -0.2, 0.1;
  PixelMeasurement m;
  m.undistorted_px = {300.0, 200.0};
  m.disparity_px = 15.0;
  m.sigma_px = 1.7;
  m.disparity_sigma_px = 0.6;
  const ReprojectionCost<kResiduals> cost{
      VirtualStereo(CameraIntrinsics{640, 480, 517.3, 516.5, 318.6, 255.3, {}}, 0.08), se3Exp(tangent), m};

  Eigen::VectorXd x(9);
  x << increment, 0.3, -0.4, 2.2;
  const auto residual = [&cost](const Eigen::VectorXd& at) {
    Eigen::VectorXd r(kResiduals);
    cost.evaluate(at.data(), at.data() + 6, r.data(), nullptr, nullptr);
    return r;
  };
  Eigen::Matrix<double, kResiduals, 1> r;
  Eigen::Matrix<double, kResiduals, 6, Eigen::RowMajor> by_increment;
  Eigen::Matrix<double, kResiduals, 3, Eigen::RowMajor> by_point;
  cost.evaluate(x.data(), x.data() + 6, r.data(), by_increment.data(), by_point.data());
  const Eigen::MatrixXd numeric = numericJacobian(residual, x);
  EXPECT_LT(relativeDifference(by_increment, numeric.leftCols(6)), 1e-7);
  EXPECT_LT(relativeDifference(by_point, numeric.rightCols(3)), 1e-7);
}

TEST(ReprojectionCost, JacobiansMatchNumericDifferences) {
  Vector6d away;
  away << 0.05, 0.02, -0.03, -0.3, 0.2, 0.5;
  for (const Vector6d& increment : {Vector6d(Vector6d::Zero()), away}) {
    expectNumericJacobians<2>(increment);
    expectNumericJacobians<3>(increment);
  }
}

TEST(ReprojectionCost, PointBehindTheCameraHasNoResidual) {
  const ReprojectionCost<2> cost{VirtualStereo(CameraIntrinsics{}, 0.08), SE3::Identity(), PixelMeasurement{}};
  const Vector6d zero = Vector6d::Zero();
  const Eigen::Vector3d behind(0.1, 0.2, -1.0);
  Eigen::Vector2d residual(1, 1);
  Eigen::Matrix<double, 2, 3, Eigen::RowMajor> by_point;
  cost.evaluate(zero.data(), behind.data(), residual.data(), nullptr, by_point.data());
  EXPECT_EQ(residual.norm(), 0.0);
  EXPECT_EQ(by_point.norm(), 0.0);
}

}  // namespace
}  // namespace semantic_vslam
