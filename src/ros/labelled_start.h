// SPDX-FileCopyrightText: 2026 The semantic_vslam authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <optional>

#include "semantic_vslam/core/common/stamp.h"

namespace semantic_vslam {

/// From which frame on the motion masks know the people whom a network found since the last restart. Before it nobody
/// has said who stands still there, and tracking's first map would hold them.
class LabelledStart {
 public:
  /// What the motion stage says of its frames, in their order. A stamp that goes back begins a new recording.
  /// @param labels  stamp of the frame whose labels the mask carries on
  void add(Stamp frame, std::optional<Stamp> labels) {
    if (newest_ && frame <= *newest_) *this = {};
    newest_ = frame;
    if (!labels || (labels_after_ && *labels <= *labels_after_)) {
      since_.reset();
    } else if (!since_) {
      since_ = frame;
    }
  }

  /// Labels of the frames so far no longer count.
  void restart() {
    labels_after_ = newest_;
    since_.reset();
  }

  /// @return whether the mask of this frame, or of one before, is known to carry labels on
  bool at(Stamp frame) const { return since_ && *since_ <= frame; }

 private:
  std::optional<Stamp> newest_, labels_after_, since_;
};

}  // namespace semantic_vslam
