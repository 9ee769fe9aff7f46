// SPDX-FileCopyrightText: 2026 The semantic_vslam authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <memory>

#include "core/common/arguments.h"
#include "core/io/tum_sequence.h"

namespace semantic_vslam {

/// @return the TUM folder that the first argument names, with the camera of --camera FILE
/// @throws UsageError without --camera  @throws FileError as TumSequence and loadCameraFile()
TumSequence openTumFolder(const Arguments& arguments);

/// @return the TUM folder that the first argument names, or the scenario of --scenario NAME, rendered while it is read
///     with --seed N (1), --size WxH (640x480) and --fps N
/// @throws UsageError if there is neither or both  @throws Error as openTumFolder() and makeScenario()
std::unique_ptr<FrameSource> openRecording(const Arguments& arguments, double default_fps);

}  // namespace semantic_vslam
