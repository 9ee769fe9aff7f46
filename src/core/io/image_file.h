// SPDX-FileCopyrightText: 2026 The semantic_vslam authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <opencv2/core.hpp>
#include <string>

namespace semantic_vslam {

/// Reads an image file, and unlike cv::imread refuses a truncated one: libjpeg fills what is missing with gray.
/// @param flags  cv::ImreadModes
/// @throws FileError naming the file and what is wrong with it.
cv::Mat readImageFile(const std::string& path, int flags);

/// Writes an image, whole or not at all; the format is that of the extension. @throws FileError.
void writeImageFile(const std::string& path, const cv::Mat& image);

}  // namespace semantic_vslam
