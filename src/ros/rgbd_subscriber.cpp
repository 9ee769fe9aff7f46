// SPDX-FileCopyrightText: 2026 The semantic_vslam authors
// SPDX-License-Identifier: BSD-3-Clause
#include "ros/rgbd_subscriber.h"

#include <ros/console.h>

#include <algorithm>
#include <utility>

#include "core/common/stamp_order.h"
#include "semantic_vslam/core/common/error.h"

namespace semantic_vslam {
namespace {

// Images that wait for their partner. At 30 Hz this outlives any delay between the two streams of one driver.
constexpr int kLeastPairingQueue = 10;

// No camera here is faster than 60 Hz, so a stream's next image is at least this far off: the synchroniser then need
// not wait for it to know that a pair is the best one.
constexpr double kShortestPeriodS = 0.015;

}  // namespace

RgbdSubscriber::RgbdSubscriber(ros::NodeHandle nh, ros::NodeHandle private_nh, const RgbdInputConfig& config, Sink sink)
    : config_(config),
      pairing_queue_(std::max(kLeastPairingQueue, config.queue_size)),
      sink_(std::move(sink)),
      last_pair_(ros::SteadyTime::now()),
      transport_(nh) {
  synchronize();
  rgb_subscriber_.registerCallback([this](const sensor_msgs::ImageConstPtr&) { ++rgb_images_; });
  depth_subscriber_.registerCallback([this](const sensor_msgs::ImageConstPtr&) { ++depth_images_; });
  info_subscriber_ = nh.subscribe("rgb/camera_info", 5, &RgbdSubscriber::onInfo, this);
  subscribe(private_nh);
  silence_timer_ =
      nh.createSteadyTimer(ros::WallDuration(config_.silent_after_s), [this](const ros::SteadyTimerEvent&) {
        const std::string problem = missing();
        if (throttle_.passes(problem)) ROS_WARN("%s", problem.c_str());
      });
}

void RgbdSubscriber::synchronize() {
  if (config_.sync == "exact") {
    exact_ = std::make_unique<message_filters::Synchronizer<ExactPolicy>>(ExactPolicy(pairing_queue_), rgb_subscriber_,
                                                                          depth_subscriber_);
    exact_->registerCallback(&RgbdSubscriber::onPair, this);
    return;
  }
  ApproximatePolicy policy(pairing_queue_);
  policy.setMaxIntervalDuration(ros::Duration(config_.max_interval_s));
  for (int stream = 0; stream < 2; ++stream) policy.setInterMessageLowerBound(stream, ros::Duration(kShortestPeriodS));
  approximate_ = std::make_unique<message_filters::Synchronizer<ApproximatePolicy>>(std::as_const(policy),
                                                                                    rgb_subscriber_, depth_subscriber_);
  approximate_->registerCallback(&RgbdSubscriber::onPair, this);
}

void RgbdSubscriber::subscribe(ros::NodeHandle private_nh) {
  using image_transport::TransportHints;
  try {
    rgb_subscriber_.subscribe(transport_, "rgb/image_rect_color", pairing_queue_,
                              TransportHints("raw", {}, private_nh, "image_transport"));
    depth_subscriber_.subscribe(transport_, "depth_registered/image_rect", pairing_queue_,
                                TransportHints("raw", {}, private_nh, "depth_image_transport"));
  } catch (const image_transport::Exception& error) {
    throw ConfigError(std::string("~image_transport or ~depth_image_transport: ") + error.what());
  }
}

void RgbdSubscriber::onInfo(const sensor_msgs::CameraInfoConstPtr& info) {
  std::lock_guard<std::mutex> lock(mutex_);
  info_ = info;
}

void RgbdSubscriber::onPair(const sensor_msgs::ImageConstPtr& rgb, const sensor_msgs::ImageConstPtr& depth) {
  if (clockWentBack(rgb->header.stamp)) ++recording_;
  RgbdMessages messages{pairs_, rgb, depth, nullptr, recording_};
  {
    std::lock_guard<std::mutex> lock(mutex_);
    if (config_.camera_file.empty()) {
      if (!info_) return;  // missing() names the topic
      messages.info = info_;
    }
    last_pair_ = ros::SteadyTime::now();
  }
  ++pairs_;
  sink_(messages);
}

/// A recording's first images may come before its clock: then the clock goes back after them.
bool RgbdSubscriber::clockWentBack(ros::Time image) {
  if (!ros::Time::isSimTime()) return false;
  const ros::Time clock = ros::Time::now();
  const double back_s = (last_clock_ - clock).toSec();
  const bool went_back = back_s > (image <= last_image_ ? 0.0 : StampOrder::kLongestDisorderS);
  last_clock_ = clock;
  last_image_ = image;
  return went_back;
}

std::string RgbdSubscriber::missing() const {
  std::lock_guard<std::mutex> lock(mutex_);
  if ((ros::SteadyTime::now() - last_pair_).toSec() < config_.silent_after_s) return "";
  std::string silent;
  const auto name = [&silent](const std::string& topic) { silent += (silent.empty() ? "" : ", ") + topic; };
  if (rgb_images_ == 0) name(rgb_subscriber_.getTopic());
  if (depth_images_ == 0) name(depth_subscriber_.getTopic());
  if (config_.camera_file.empty() && !info_) name(info_subscriber_.getTopic());
  if (!silent.empty()) return "no message yet on " + silent + "; remap the inputs or start the driver";
  const std::string both = rgb_subscriber_.getTopic() + " and " + depth_subscriber_.getTopic();
  if (pairs_ == 0) {
    return "images on " + both + " never come within " + std::to_string(config_.max_interval_s) +
           " s of each other; raise max_interval_s or synchronise the driver";
  }
  return "no pair of images any more on " + both;
}

}  // namespace semantic_vslam
