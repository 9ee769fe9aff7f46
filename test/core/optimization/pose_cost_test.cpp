// SPDX-FileCopyrightText: 2026 The semantic_vslam authors
// SPDX-License-Identifier: BSD-3-Clause
#include "core/optimization/pose_cost.h"

#include <gtest/gtest.h>

#include "core/common/rng.h"
#include "core/optimization/huber.h"
#include "numeric_jacobian.h"

namespace semantic_vslam {
namespace {

const VirtualStereo kCamera(CameraIntrinsics{640, 480, 517.3, 516.5, 318.6, 255.3, {}}, 0.08);

/// Points with and without depth, with errors on both sides of the kernel's bound.
std::vector<PoseCost::Point> makePoints() {
  Rng rng(7);
  std::vector<PoseCost::Point> points;
  for (int i = 0; i < 12; ++i) {
    const Eigen::Vector3d p(rng.uniform(-1, 1), rng.uniform(-1, 1), rng.uniform(0.8, 3));
    const Eigen::Vector3d projected = kCamera.project(p);
    const double error_px = i % 3 == 0 ? 15.0 : 0.5;
    PixelMeasurement m;
    m.undistorted_px = projected.head<2>() + error_px * Eigen::Vector2d(rng.normal(), rng.normal());
    m.disparity_px = i % 2 == 0 ? projected.z() + 0.5 * rng.normal() : 0.0;
    m.sigma_px = 1.0 + 0.2 * i;
    m.weight = rng.uniform(0.2, 1.0);
    points.push_back({p, m});
  }
  return points;
}

TEST(PoseCost, JacobianMatchesNumericDifferencesAtAndAwayFromZero) {
  const PoseCost cost(kCamera, makePoints());
  Eigen::VectorXd zero = Eigen::VectorXd::Zero(6), away(6);
  away << 0.02, -0.03, 0.01, 0.1, -0.2, 0.15;
  for (const auto& x : {zero, away}) {
    Eigen::VectorXd residuals(cost.NumResiduals());
    Eigen::MatrixXd jacobian(cost.NumResiduals(), 6);
    cost(x.data(), residuals.data(), jacobian.data());
    const Eigen::MatrixXd numeric = numericJacobian(
        [&cost](const Eigen::VectorXd& at) {
          Eigen::VectorXd r(cost.NumResiduals());
          cost(at.data(), r.data(), nullptr);
          return r;
        },
        x);
    EXPECT_LT(relativeDifference(jacobian, numeric), 1e-6);
  }
}

TEST(PoseCost, ResidualIsSigmasOfErrorScaledByWeight) {
  PixelMeasurement m;
  m.undistorted_px = {318.6 + 2.0, 255.3};  // the point below projects to the principal point with 20.692 px disparity
  m.disparity_px = kCamera.fx_baseline / 2.0;
  m.sigma_px = 2.0;
  m.weight = 0.25;
  const PoseCost cost(kCamera, {{Eigen::Vector3d(0, 0, 2), m}});
  Eigen::Vector3d residual;
  const Vector6d zero = Vector6d::Zero();
  cost(zero.data(), residual.data(), nullptr);
  EXPECT_NEAR(residual.x(), 2.0 / 2.0 * 0.5, 1e-12);
  EXPECT_NEAR(residual.y(), 0.0, 1e-12);
  EXPECT_NEAR(residual.z(), 0.0, 1e-12);
}

TEST(HuberScale, GrowsLikeTheNormPastTheBound) {
  double derivative = 0.0;
  EXPECT_EQ(huberScale(3.0, 4.0, &derivative), 1.0);
  EXPECT_EQ(derivative, 0.0);
  // delta = 2, norm = 10: rho = 2 * 2 * 10 - 4 = 36 = scale^2 * 100.
  EXPECT_NEAR(huberScale(100.0, 4.0, &derivative), 0.6, 1e-12);
  double unused = 0.0;
  const double numeric = (huberScale(100.01, 4.0, &unused) - huberScale(99.99, 4.0, &unused)) / 0.02;
  EXPECT_NEAR(derivative, numeric, 1e-9);
}

}  // namespace
}  // namespace semantic_vslam
