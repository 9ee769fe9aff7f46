// SPDX-FileCopyrightText: 2026 The semantic_vslam authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cmath>

namespace semantic_vslam {

/// Huber's kernel: squared norm s up to `bound`, then growing like the norm. @return g with rho(s) = g^2 * s.
/// Multiplying a residual by g makes its square the robust cost; `derivative` receives dg/ds.
inline double huberScale(double squared_norm, double bound, double* derivative) {
  if (squared_norm <= bound) {
    *derivative = 0.0;
    return 1.0;
  }
  const double delta = std::sqrt(bound), norm = std::sqrt(squared_norm);
  const double rho = 2.0 * delta * norm - bound;
  const double scale = std::sqrt(rho / squared_norm);
  *derivative = (delta / norm * squared_norm - rho) / (2.0 * scale * squared_norm * squared_norm);
  return scale;
}

}  // namespace semantic_vslam
