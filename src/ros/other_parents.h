// SPDX-FileCopyrightText: 2026 The semantic_vslam authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <tf2_msgs/TFMessage.h>

#include <map>
#include <mutex>
#include <string>
#include <utility>

#include "ros/conversions.h"

namespace semantic_vslam {

/// What hangs below what in the robot's tf tree, but for what hangs below one frame. A frame has one parent in tf: who
/// publishes another one takes it, and all below it, away from where it hung. Used by any thread.
class OtherParents {
 public:
  /// @param own  the parent that this process publishes
  explicit OtherParents(std::string own) : own_(std::move(own)) {}

  void take(const tf2_msgs::TFMessage& message) {
    const std::lock_guard<std::mutex> lock(mutex_);
    for (const auto& transform : message.transforms) {
      const std::string parent = frameName(transform.header.frame_id);
      if (parent != own_) parents_[frameName(transform.child_frame_id)] = parent;
    }
  }
  /// @return "" if nobody gives the frame another parent
  std::string of(const std::string& child) const {
    const std::lock_guard<std::mutex> lock(mutex_);
    const auto found = parents_.find(child);
    return found == parents_.end() ? "" : found->second;
  }

 private:
  const std::string own_;
  mutable std::mutex mutex_;
  std::map<std::string, std::string> parents_;  // guarded by mutex_; by child
};

}  // namespace semantic_vslam
