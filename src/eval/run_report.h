// SPDX-FileCopyrightText: 2026 The semantic_vslam authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <cstdint>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "eval/mask_score.h"
#include "eval/trajectory_error.h"
#include "semantic_vslam/core/common/stage_timing.h"

namespace semantic_vslam {

/// What the motion stage said of one frame.
struct FrameMotion {
  std::uint64_t frame = 0;  ///< index in the recording
  std::string model;        ///< "none", "homography" or "rigid_flow"
  int inliers = 0;
  double dynamic_share = 0.0;
};

/// Figures of one run over a recording.
struct RunReport {
  std::string sequence;
  std::size_t frames = 0;          ///< given to the system
  std::size_t skipped_broken = 0;  ///< unreadable in the recording
  std::size_t dropped_late = 0;    ///< passed over to keep real time
  std::vector<double> latency_ms;  ///< from a frame's time to its pose, one a frame given; empty if not in real time
  double decoding_late_ms = 0.0;   ///< worst delay of a frame before it was given: the recording's, not in latency_ms
  std::size_t posed = 0;           ///< frames with a pose in the trajectory
  std::size_t keyframes = 0, landmarks = 0;
  std::size_t keyframes_passed_over = 0;  ///< left out of the dense map: segmentation was too far behind
  std::map<std::string, std::size_t> frames_in_state;
  std::vector<FrameMotion> motion;  ///< one a frame given
  std::size_t cloud_points = 0, voxels = 0;
  double start_s = 0.0;  ///< from the start of the process to the first frame
  double wall_s = 0.0;
  double peak_memory_mb = 0.0;
  std::vector<StageSummary> stages;
  std::optional<AbsoluteTrajectoryError> absolute;  ///< where there is ground truth
  std::optional<RelativePoseError> relative;
  MaskScore mask;                               ///< of what tracking took as dynamic, over the frames with a true mask
  std::string ended = "running";                ///< how: "complete", a signal's name, or what went wrong
  std::map<std::string, std::uintmax_t> files;  ///< what the run left in its folder beside the report, with bytes

  double posedShare() const { return frames == 0 ? 0.0 : static_cast<double>(posed) / static_cast<double>(frames); }
};

/// @return the report as a JSON object; what there is no truth for is null.
std::string toJson(const RunReport& report);

/// @return the counts in one line.
std::string headline(const RunReport& report);

/// @return a few lines of plain text for the terminal.
std::string toText(const RunReport& report);

/// @return highest resident memory of this process so far (VmHWM), MB; 0 where the system does not tell.
double peakMemoryMb();
/// @return the same at present (VmRSS).
double residentMemoryMb();
/// @return time since this process was started, to 0.01 s; 0 where the system does not tell.
double secondsSinceProcessStart();

}  // namespace semantic_vslam
