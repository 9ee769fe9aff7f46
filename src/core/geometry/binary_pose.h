// SPDX-FileCopyrightText: 2026 The semantic_vslam authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "core/common/binary_file.h"
#include "semantic_vslam/core/geometry/se3.h"

namespace semantic_vslam {

void putPose(BinaryWriter& out, const SE3& T);
/// @throws FileError if it is no rigid motion, or leads farther than ten times what an initial pose takes
SE3 getPose(BinaryReader& in);
/// Whether a point of a file may be one: finite and not farther than that.
bool isPosition(const Eigen::Vector3d& p_m);

}  // namespace semantic_vslam
