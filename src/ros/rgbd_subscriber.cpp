// SPDX-FileCopyrightText: 2026 The semantic_vslam authors
// SPDX-License-Identifier: BSD-3-Clause
#include "ros/rgbd_subscriber.h"

#include <ros/console.h>

#include <algorithm>
#include <cmath>
#include <utility>

#include "semantic_vslam/core/common/error.h"

namespace semantic_vslam {
namespace {

// Images that wait for their partner. At 30 Hz this outlives any delay between the two streams of one driver.
constexpr int kLeastPairingQueue = 10;

// No camera here is faster than 60 Hz, so a stream's next image is at least this far off: the synchroniser then need
// not wait for it to know that a pair is the best one.
constexpr double kShortestPeriodS = 0.015;

// One stream of a driver is behind the other by less. Where a stamp is older than that, stamps went back.
constexpr double kLongestLagS = 0.5;

// A simulated clock that goes back by less, while images go on, was only behind them.
constexpr double kClockDelayS = 5.0;

// ros::Duration, by which the synchroniser reckons, ends at 2^31 s.
constexpr double kLongestJumpS = 1 << 30;

}  // namespace

RgbdSubscriber::RgbdSubscriber(ros::NodeHandle nh, ros::NodeHandle private_nh, const RgbdInputConfig& config,
                               Refusals& refusals, Sink sink)
    : config_(config),
      pairing_queue_(std::max(kLeastPairingQueue, config.queue_size)),
      refusals_(refusals),
      sink_(std::move(sink)),
      last_pair_(ros::SteadyTime::now()),
      transport_(nh) {
  rgb_.topic = nh.resolveName("rgb/image_rect_color");
  depth_.topic = nh.resolveName("depth_registered/image_rect");
  converter_ = RgbdConverter::of(rgb_.topic + "\n" + depth_.topic, config_.camera_file, config_.rectified);
  synchronize();
  info_subscriber_ = nh.subscribe("rgb/camera_info", 5, &RgbdSubscriber::onInfo, this);
  rgb_subscriber_ = subscribe(rgb_, private_nh, "image_transport");
  depth_subscriber_ = subscribe(depth_, private_nh, "depth_image_transport");
  silence_timer_ =
      nh.createSteadyTimer(ros::WallDuration(config_.silent_after_s), [this](const ros::SteadyTimerEvent&) {
        const std::string problem = missing();
        if (throttle_.passes(problem)) ROS_WARN("%s", problem.c_str());
      });
}

void RgbdSubscriber::synchronize() {
  if (config_.sync == "exact") {
    exact_ =
        std::make_unique<message_filters::Synchronizer<ExactPolicy>>(ExactPolicy(pairing_queue_), rgb_.out, depth_.out);
    exact_->registerCallback(&RgbdSubscriber::onPair, this);
    return;
  }
  ApproximatePolicy policy(pairing_queue_);
  policy.setMaxIntervalDuration(ros::Duration(config_.max_interval_s));
  for (int stream = 0; stream < 2; ++stream) policy.setInterMessageLowerBound(stream, ros::Duration(kShortestPeriodS));
  approximate_ =
      std::make_unique<message_filters::Synchronizer<ApproximatePolicy>>(std::as_const(policy), rgb_.out, depth_.out);
  approximate_->registerCallback(&RgbdSubscriber::onPair, this);
}

image_transport::Subscriber RgbdSubscriber::subscribe(Stream& stream, ros::NodeHandle private_nh,
                                                      const std::string& transport) {
  try {
    return transport_.subscribe(
        stream.topic, pairing_queue_,
        [this, &stream](const Image& image) { refusals_.guard(stream.topic, [&] { onImage(stream, image); }); },
        ros::VoidPtr(), image_transport::TransportHints("raw", {}, private_nh, transport));
  } catch (const image_transport::Exception& error) {
    throw ConfigError("~" + transport + ": " + error.what());
  }
}

void RgbdSubscriber::onInfo(const sensor_msgs::CameraInfoConstPtr& info) {
  std::lock_guard<std::mutex> lock(mutex_);
  info_ = info;
}

void RgbdSubscriber::onImage(Stream& stream, const Image& image) {
  ++stream.images;
  stream.last_s = ros::SteadyTime::now().toSec();
  stream.unstamped = image->header.stamp.isZero();
  if (stream.unstamped) {
    refusals_.refuse(stream.topic, "its header.stamp is not set; the driver must stamp each image when it is taken");
    return;
  }
  const double jump_s = image->header.stamp.toSec() - last_stamp_.toSec();
  if (!last_stamp_.isZero() && std::abs(jump_s) > kLongestJumpS) {
    synchronize();  // what waits for its partner is older or newer than the synchroniser can reckon with
    refusals_.refuse(stream.topic,
                     "its stamp is " + std::to_string(jump_s) +
                         " s from the one before; set the driver's clock, and colour and depth by the same");
  }
  // What waits for its partner is of the stamps before: the synchroniser would hold all else back for it.
  if (jump_s < -kLongestLagS) synchronize();
  last_stamp_ = image->header.stamp;
  stream.out.add(image);
}

void RgbdSubscriber::onPair(const Image& rgb, const Image& depth) {
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
  sink_(converter_->pending(messages));
}

/// A recording's first images may come before its clock: then the clock goes back after them.
bool RgbdSubscriber::clockWentBack(ros::Time image) {
  if (!ros::Time::isSimTime()) return false;
  const ros::Time clock = ros::Time::now();
  const double back_s = last_clock_.toSec() - clock.toSec();
  const bool went_back = back_s > (image <= last_image_ ? 0.0 : kClockDelayS);
  last_clock_ = clock;
  last_image_ = image;
  return went_back;
}

void RgbdSubscriber::report(StageDiagnostics& diagnostics, StageDiagnostics::Status& status) const {
  const std::string problem = missing();
  if (!problem.empty()) status.mergeSummary(diagnostic_msgs::DiagnosticStatus::ERROR, problem);
  status.add("frames converted in this process", converter_->converted());
  diagnostics.addFault(status, "frames that can hardly be meant", converter_->doubts().count(),
                       converter_->doubts().last());
  diagnostics.addFault(status, "frames refused", converter_->refusals().count(), converter_->refusals().last());
}

std::string RgbdSubscriber::missing() const {
  std::lock_guard<std::mutex> lock(mutex_);
  if ((ros::SteadyTime::now() - last_pair_).toSec() < config_.silent_after_s) return "";
  std::string silent;
  const auto name = [&silent](const std::string& topic) { silent += (silent.empty() ? "" : ", ") + topic; };
  if (rgb_.images == 0) name(rgb_.topic);
  if (depth_.images == 0) name(depth_.topic);
  if (config_.camera_file.empty() && !info_) name(info_subscriber_.getTopic());
  if (!silent.empty()) return "no message yet on " + silent + "; remap the inputs or start the driver";
  const std::string both = rgb_.topic + " and " + depth_.topic;
  std::string stopped;
  for (const Stream* stream : {&rgb_, &depth_}) {
    const bool stops = ros::SteadyTime::now().toSec() - stream->last_s > config_.silent_after_s;
    if (stops) stopped += (stopped.empty() ? "" : " and ") + stream->topic;
  }
  if (!stopped.empty()) return "no image any more on " + stopped + "; is the driver alive?";
  for (const Stream* stream : {&rgb_, &depth_}) {
    if (stream->unstamped) return "images on " + stream->topic + " have no header.stamp; the driver must set it";
  }
  if (pairs_ == 0 && config_.sync == "exact") {
    return "images on " + both + " never have one stamp; give sync:=approximate";
  }
  if (pairs_ == 0) {
    return "images on " + both + " never come within " + std::to_string(config_.max_interval_s) +
           " s of each other; raise max_interval_s or synchronise the driver";
  }
  return "no pair of images any more on " + both;
}

}  // namespace semantic_vslam
