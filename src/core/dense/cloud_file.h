// SPDX-FileCopyrightText: 2026 The semantic_vslam authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string>
#include <vector>

#include "core/dense/keyframe_cloud.h"

namespace semantic_vslam {

/// Writes a binary PCD file, version 0.7, with the fields x y z (float, metres), rgb (packed in a float as PCL has it)
/// and label (unsigned, 4 bytes): what pcl::io::loadPCDFile reads into a PointCloud<PointXYZRGBL>. Whole or not at all.
/// @throws FileError naming path and cause.
void writePcd(const std::vector<LabelledPoint>& points, const std::string& path);

}  // namespace semantic_vslam
