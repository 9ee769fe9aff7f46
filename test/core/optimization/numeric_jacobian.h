// SPDX-FileCopyrightText: 2026 The semantic_vslam authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <algorithm>

namespace semantic_vslam {

/// Central differences of a vector function. @return residuals x parameters.
template <class Function>
Eigen::MatrixXd numericJacobian(const Function& function, const Eigen::VectorXd& x) {
  constexpr double kStep = 1e-6;
  Eigen::MatrixXd jacobian(function(x).size(), x.size());
  for (Eigen::Index i = 0; i < x.size(); ++i) {
    Eigen::VectorXd low = x, high = x;
    low[i] -= kStep;
    high[i] += kStep;
    jacobian.col(i) = (function(high) - function(low)) / (2.0 * kStep);
  }
  return jacobian;
}

/// @return the largest difference, relative to the largest value of either.
inline double relativeDifference(const Eigen::MatrixXd& a, const Eigen::MatrixXd& b) {
  const double scale = std::max({1e-12, a.cwiseAbs().maxCoeff(), b.cwiseAbs().maxCoeff()});
  return (a - b).cwiseAbs().maxCoeff() / scale;
}

}  // namespace semantic_vslam
