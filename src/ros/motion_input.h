// SPDX-FileCopyrightText: 2026 The semantic_vslam authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <ros/node_handle.h>
#include <ros/subscriber.h>
#include <semantic_vslam/MotionReport.h>
#include <sensor_msgs/Image.h>

#include <functional>
#include <mutex>

#include "core/common/stamped_store.h"
#include "semantic_vslam/core/motion/motion_result.h"

namespace semantic_vslam {

/// What the motion stage says of each frame: motion/mask and motion/report, put together by stamp.
class MotionInput {
 public:
  /// @param sink  called from the callback thread; must not block
  MotionInput(ros::NodeHandle nh, std::function<void(Stamp, const MotionResult&)> sink);

  /// Whether anybody makes masks.
  bool runs() const { return mask_subscriber_.getNumPublishers() > 0; }
  void shutdown();

 private:
  void onMask(const sensor_msgs::ImageConstPtr& message);
  void onReport(const MotionReportConstPtr& message);
  void passOn(Stamp stamp);

  const std::function<void(Stamp, const MotionResult&)> sink_;
  std::mutex mutex_;
  StampedStore<cv::Mat1b> masks_{30};                    // guarded by mutex_; whose report has not come
  StampedStore<MotionReportConstPtr> reports_{30};       // guarded by mutex_; whose mask has not come
  ros::Subscriber mask_subscriber_, report_subscriber_;  // last: callbacks use the above
};

}  // namespace semantic_vslam
