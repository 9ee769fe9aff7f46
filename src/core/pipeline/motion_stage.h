// SPDX-FileCopyrightText: 2026 The semantic_vslam authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <memory>
#include <optional>

#include "semantic_vslam/core/camera/rgbd_frame.h"
#include "semantic_vslam/core/common/label_set.h"
#include "semantic_vslam/core/geometry/timed_pose.h"
#include "semantic_vslam/core/motion/motion_config.h"
#include "semantic_vslam/core/motion/motion_result.h"
#include "semantic_vslam/core/pipeline/messages.h"

namespace semantic_vslam {

/// Stage 1 of a frame's way: what moves in it. Labels and keyframe poses reach it late and count from the next frame
/// on. Knows no thread.
class MotionStage {
 public:
  /// @param label_delay_s  labels count at least this long after their image: to measure what late ones cost
  /// @throws ConfigError
  MotionStage(const MotionConfig& config, const RemovalConfig& removal, double label_delay_s = 0.0);
  ~MotionStage();
  MotionStage(MotionStage&&) noexcept;

  /// Motion that the camera's own does not explain, and the people of labels that have come.
  /// @param recording  see StampOrder
  /// @return nothing for a frame out of order: it is passed over
  std::optional<MotionResult> step(const RgbdFrame& frame, std::uint32_t recording = 0);

  /// Labels of a frame. Those that are faster than their frame, or than the list of classes, wait for it.
  void take(FrameLabels labels);
  void take(const LabelSet& label_set);
  /// Where the keyframes stand: what they saw free is remembered. With none of them known the map is another one: it
  /// forgets the old.
  void take(const MapSnapshot& map);
  /// Where tracking found a frame.
  void take(const TimedPose& pose);
  /// Takes other thresholds between two frames. @throws ConfigError if a value is out of range; the old ones then stay
  void take(const MotionConfig& config);
  void take(const RemovalConfig& removal);

  std::size_t labelsTaken() const;
  std::size_t labelsTooLate() const;
  /// Frames that came too long after the one before to tell motion between them.
  std::size_t framesFarApart() const;

 private:
  struct Inside;
  std::unique_ptr<Inside> inside_;
};

}  // namespace semantic_vslam
