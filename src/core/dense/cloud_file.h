// SPDX-FileCopyrightText: 2026 The semantic_vslam authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "core/dense/keyframe_cloud.h"

namespace semantic_vslam {

/// One line for each class, after the word that begins a comment: "# label 3 monitor".
std::string labelComments(const LabelSet& labels, const std::string& comment);

// As binary files have them.
void appendLittleEndian(std::string& out, std::uint32_t value);
void appendFloat(std::string& out, float value);

/// Writes a binary PCD file, version 0.7, with the fields x y z (float, metres), rgb (packed in a float as PCL has it)
/// and label (unsigned, 4 bytes), and the labels' names as comments: what pcl::io::loadPCDFile reads into a
/// PointCloud<PointXYZRGBL>. Whole or not at all.
/// @throws FileError naming path and cause.
void writePcd(const std::vector<LabelledPoint>& points, const LabelSet& labels, const std::string& path);

}  // namespace semantic_vslam
