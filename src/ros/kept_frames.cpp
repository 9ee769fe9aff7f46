// SPDX-FileCopyrightText: 2026 The semantic_vslam authors
// SPDX-License-Identifier: BSD-3-Clause
#include "ros/kept_frames.h"

#include <chrono>
#include <utility>

#include "ros/conversions.h"

namespace semantic_vslam {
namespace {

constexpr std::chrono::milliseconds kPairingWait{500};

}  // namespace

KeptFrames::KeptFrames(ros::NodeHandle nh, ros::NodeHandle private_nh, const KeptFramesConfig& config,
                       std::function<void(Stamp)> on_frame)
    : converter_(config.input), frames_(config.kept_frames) {
  subscriber_ = std::make_unique<RgbdSubscriber>(nh, private_nh, config.input,
                                                 [this, on_frame = std::move(on_frame)](const RgbdMessages& messages) {
                                                   const Stamp stamp = fromRos(messages.rgb->header.stamp);
                                                   frames_.put(stamp, messages);
                                                   if (on_frame) on_frame(stamp);
                                                 });
}

std::optional<RgbdMessages> KeptFrames::waitFor(Stamp stamp) {
  std::optional<RgbdMessages> messages = frames_.waitFor(stamp, kPairingWait);
  if (!messages) ++missing_frames_;
  return messages;
}

void KeptFrames::report(StageDiagnostics& diagnostics, StageDiagnostics::Status& status) const {
  diagnostics.addFault(status, "frames refused", converter_.refused());
  diagnostics.addFault(status, "keyframes without images", missing_frames_);
}

void KeptFrames::close() {
  subscriber_.reset();
  frames_.close();
}

}  // namespace semantic_vslam
