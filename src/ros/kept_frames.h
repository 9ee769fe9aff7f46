// SPDX-FileCopyrightText: 2026 The semantic_vslam authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <ros/node_handle.h>

#include <atomic>
#include <functional>
#include <memory>
#include <optional>
#include <string>

#include "ros/rgbd_converter.h"
#include "ros/rgbd_subscriber.h"
#include "ros/stage_diagnostics.h"
#include "ros/stamped_buffer.h"

namespace semantic_vslam {

struct KeptFramesConfig {
  int kept_frames = 30;
  RgbdInputConfig input;

  template <class Visitor>
  void visit(Visitor& v) {
    v.field("kept_frames", kept_frames, 2, 300,
            "newest images that wait for the tracker to name one of them; 30 are a second and 60 MB at 640x480");
    v.group("input", input);
  }
};

/// The camera's newest images, kept until the tracker has named those that are keyframes.
class KeptFrames {
 public:
  /// @param on_frame  called from the callback thread with the stamp of each pair; must not block; may be empty
  /// @throws FileError or ConfigError, see RgbdConverter and RgbdSubscriber
  KeptFrames(ros::NodeHandle nh, ros::NodeHandle private_nh, const KeptFramesConfig& config,
             std::function<void(Stamp)> on_frame = {});

  /// The images of a frame if they are here already.
  std::optional<RgbdMessages> find(Stamp stamp) const { return frames_.find(stamp); }
  /// Waits a moment for them: the tracker may be ahead of this process's own pairing of colour and depth.
  /// @return nothing if they did not come: counted
  std::optional<RgbdMessages> waitFor(Stamp stamp);
  /// One thread. @return nothing if they are unusable: counted
  std::optional<RgbdFrame> convert(const RgbdMessages& messages) { return converter_.convert(messages); }

  std::string missing() const { return subscriber_->missing(); }
  void report(StageDiagnostics& diagnostics, StageDiagnostics::Status& status) const;
  /// Ends the subscription and all waiting, for good. Not during missing().
  void close();

 private:
  RgbdConverter converter_;
  StampedBuffer<RgbdMessages> frames_;
  std::atomic<std::size_t> missing_frames_{0};
  std::unique_ptr<RgbdSubscriber> subscriber_;  // last: its callbacks use the above
};

}  // namespace semantic_vslam
