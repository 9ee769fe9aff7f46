// SPDX-FileCopyrightText: 2026 The semantic_vslam authors
// SPDX-License-Identifier: BSD-3-Clause
#include "core/geometry/binary_pose.h"

namespace semantic_vslam {

bool isPosition(const Eigen::Vector3d& p_m) {
  constexpr double kFarthestM = 1e7;
  return p_m.allFinite() && p_m.cwiseAbs().maxCoeff() <= kFarthestM;
}

void putPose(BinaryWriter& out, const SE3& T) {
  out.putMatrix(T.linear());
  out.putMatrix(T.translation());
}

SE3 getPose(BinaryReader& in) {
  Eigen::Matrix3d rotation;
  Eigen::Vector3d translation;
  in.getMatrix(rotation);
  in.getMatrix(translation);
  const double skewed = (rotation * rotation.transpose() - Eigen::Matrix3d::Identity()).cwiseAbs().maxCoeff();
  in.require(skewed < 1e-3 && rotation.determinant() > 0.0 && isPosition(translation));  // NaN fails, too
  SE3 T = SE3::Identity();
  T.linear() = rotation;
  T.translation() = translation;
  return T;
}

}  // namespace semantic_vslam
