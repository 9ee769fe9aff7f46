// SPDX-FileCopyrightText: 2026 The semantic_vslam authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <ros/node_handle.h>
#include <ros/subscriber.h>
#include <semantic_vslam/MotionReport.h>
#include <sensor_msgs/Image.h>
#include <std_msgs/Header.h>

#include <mutex>
#include <opencv2/core.hpp>
#include <optional>

#include "ros/labelled_start.h"
#include "ros/stamped_buffer.h"

namespace semantic_vslam {

struct MotionMaskConfig {
  int mask_budget_ms = 60;
  double init_wait_s = 0.0;

  template <class Visitor>
  void visit(Visitor& v) {
    v.field("mask_budget_ms", mask_budget_ms, 0, 1000,
            "ms a frame waits for its motion mask before it is tracked without; two frames at 30 Hz");
    v.field("init_wait_s", init_wait_s, 0.0, 60.0,
            "s the start waits for the first labels, so that no person enters the first map; 0 where no network runs");
  }
};

/// The motion masks of frames, by stamp, and whether people of the first labels are in them yet. Subscribes to
/// motion/mask and, where the start waits for labels, to motion/report and segmentation/labels. Thread-safe.
class MotionMaskInput {
 public:
  MotionMaskInput(ros::NodeHandle nh, const MotionMaskConfig& config);

  /// @param has_mask  whether the frame has a motion mask
  /// @return whether the people in a frame are known, or need not be waited for any longer.
  bool readyToStart(Stamp stamp, bool has_mask);
  /// Tracking dropped its map: the start waits for labels again.
  void restart();
  /// Waits for the mask of a frame, at most the time in the configuration, and not at all if nobody makes masks.
  /// @return empty if it did not come or does not fit
  cv::Mat1b maskOf(const std_msgs::Header& image, cv::Size size);
  /// @return whether a mask of a later frame is there already: the motion stage passed this one over.
  bool passedOver(Stamp stamp) const { return masks_.newest() > stamp; }
  /// Ends all subscriptions and waiting, for good.
  void close();

 private:
  void onMask(const sensor_msgs::ImageConstPtr& message);
  void onReport(const MotionReportConstPtr& message);

  const MotionMaskConfig config_;
  StampedBuffer<cv::Mat1b> masks_{30};
  std::mutex mutex_;
  bool network_seen_ = false;                     // guarded by mutex_
  LabelledStart labelled_;                        // guarded by mutex_
  std::optional<ros::SteadyTime> waiting_since_;  // guarded by mutex_
  // Last: callbacks use the above.
  ros::Subscriber mask_subscriber_, report_subscriber_, labels_subscriber_;
};

}  // namespace semantic_vslam
