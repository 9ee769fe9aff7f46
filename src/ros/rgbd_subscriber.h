// SPDX-FileCopyrightText: 2026 The semantic_vslam authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <image_transport/image_transport.h>
#include <message_filters/pass_through.h>
#include <message_filters/sync_policies/approximate_time.h>
#include <message_filters/sync_policies/exact_time.h>
#include <message_filters/synchronizer.h>
#include <ros/node_handle.h>
#include <sensor_msgs/CameraInfo.h>
#include <sensor_msgs/Image.h>

#include <atomic>
#include <cstdint>
#include <functional>
#include <memory>
#include <mutex>
#include <string>

#include "ros/log_throttle.h"
#include "ros/node_configs.h"
#include "ros/rgbd_converter.h"
#include "ros/stage_diagnostics.h"

namespace semantic_vslam {

/// Subscribes to `rgb/image_rect_color`, `depth_registered/image_rect` and `rgb/camera_info`, and pairs the images by
/// stamp. The private parameters `image_transport` and `depth_image_transport` choose how images come in; raw unless
/// set. An input that stays silent is named, as resolved, in the log and the diagnostics.
class RgbdSubscriber {
 public:
  using Sink = std::function<void(PendingFrame)>;

  /// @param refusals  where images go that are no images
  /// @param sink  called from the callback thread with each pair; must not wait
  /// @throws ConfigError if there is no such image transport; FileError or ConfigError for a camera file
  RgbdSubscriber(ros::NodeHandle nh, ros::NodeHandle private_nh, const RgbdInputConfig& config, Refusals& refusals,
                 Sink sink);

  /// Adds what is wrong with the inputs.
  void report(StageDiagnostics& diagnostics, StageDiagnostics::Status& status) const;

 private:
  using Image = sensor_msgs::ImageConstPtr;
  using ExactPolicy = message_filters::sync_policies::ExactTime<sensor_msgs::Image, sensor_msgs::Image>;
  using ApproximatePolicy = message_filters::sync_policies::ApproximateTime<sensor_msgs::Image, sensor_msgs::Image>;

  /// One stream of images: what came of it, and its way to the synchroniser.
  struct Stream {
    std::string topic;
    std::atomic<std::size_t> images{0};
    std::atomic<double> last_s{0.0};     ///< steady clock, of the newest
    std::atomic<bool> unstamped{false};  ///< the newest
    message_filters::PassThrough<sensor_msgs::Image> out;
  };

  void synchronize();
  image_transport::Subscriber subscribe(Stream& stream, ros::NodeHandle private_nh, const std::string& transport);
  void onInfo(const sensor_msgs::CameraInfoConstPtr& info);
  void onImage(Stream& stream, const Image& image);
  void onPair(const Image& rgb, const Image& depth);
  bool clockWentBack(ros::Time image);
  /// @return resolved names of the inputs that are silent and what is wrong; empty while pairs come in
  std::string missing() const;

  const RgbdInputConfig config_;
  const int pairing_queue_;  // images of one stream that wait for their partner
  Refusals& refusals_;
  const Sink sink_;
  std::atomic<std::size_t> pairs_{0};
  mutable std::mutex mutex_;
  sensor_msgs::CameraInfoConstPtr info_;            // guarded by mutex_
  ros::SteadyTime last_pair_;                       // guarded by mutex_
  ros::Time last_clock_, last_image_, last_stamp_;  // callback thread only; the first two with simulated time only
  std::uint32_t recording_ = 0;                     // callback thread only
  Stream rgb_, depth_;
  // After the streams, which they are connected with.
  std::unique_ptr<message_filters::Synchronizer<ExactPolicy>> exact_;
  std::unique_ptr<message_filters::Synchronizer<ApproximatePolicy>> approximate_;
  LogThrottle throttle_;  // callback thread only
  std::shared_ptr<RgbdConverter> converter_;
  // Last, so that callbacks stop before what they use is gone.
  image_transport::ImageTransport transport_;
  image_transport::Subscriber rgb_subscriber_, depth_subscriber_;
  ros::Subscriber info_subscriber_;
  ros::SteadyTimer silence_timer_;
};

}  // namespace semantic_vslam
