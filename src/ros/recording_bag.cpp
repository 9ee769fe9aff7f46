// SPDX-FileCopyrightText: 2026 The semantic_vslam authors
// SPDX-License-Identifier: BSD-3-Clause
#include "ros/recording_bag.h"

#include <geometry_msgs/PoseStamped.h>
#include <sensor_msgs/CameraInfo.h>
#include <sensor_msgs/Image.h>
#include <sensor_msgs/distortion_models.h>
#include <sensor_msgs/image_encodings.h>
#include <tf2_msgs/TFMessage.h>

#include <cstring>
#include <limits>
#include <opencv2/imgproc.hpp>

#include "ros/conversions.h"
#include "ros/recording_topics.h"
#include "semantic_vslam/core/common/error.h"

namespace semantic_vslam {
namespace {

namespace encodings = sensor_msgs::image_encodings;

std_msgs::Header opticalHeader(Stamp stamp) {
  std_msgs::Header header;
  header.stamp = toRos(stamp);
  header.frame_id = kTumOpticalFrame;
  return header;
}

sensor_msgs::CameraInfo cameraInfo(Stamp stamp, const CameraIntrinsics& k) {
  sensor_msgs::CameraInfo info;
  info.header = opticalHeader(stamp);
  info.width = static_cast<std::uint32_t>(k.width);
  info.height = static_cast<std::uint32_t>(k.height);
  info.distortion_model = sensor_msgs::distortion_models::PLUMB_BOB;
  info.D.assign(k.distortion.begin(), k.distortion.end());
  info.K = {k.fx, 0, k.cx, 0, k.fy, k.cy, 0, 0, 1};
  info.R = {1, 0, 0, 0, 1, 0, 0, 0, 1};
  info.P = {k.fx, 0, k.cx, 0, 0, k.fy, k.cy, 0, 0, 0, 1, 0};
  return info;
}

geometry_msgs::TransformStamped edge(Stamp stamp, const std::string& parent, const std::string& child, const SE3& T) {
  geometry_msgs::TransformStamped out;
  out.header.stamp = toRos(stamp);
  out.header.frame_id = parent;
  out.child_frame_id = child;
  out.transform = toTransform(T);
  return out;
}

}  // namespace

RecordingBag::RecordingBag(const std::string& path, const CameraIntrinsics& camera, rosbag::CompressionType compression)
    : file_(path), camera_(camera), bag_(std::make_unique<rosbag::Bag>()) {
  try {
    bag_->open(file_.temporary(), rosbag::bagmode::Write);
  } catch (const rosbag::BagException& error) {
    fail(error);
  }
  bag_->setCompression(compression);
}

RecordingBag::~RecordingBag() {
  if (!bag_) return;
  try {
    bag_->close();
  } catch (const rosbag::BagException&) {
    (void)bag_.release();  // as in fail()
  }
}

void RecordingBag::fail(const rosbag::BagException& error) {
  // A rosbag::Bag that could not write tries again in its destructor, and throws there: the program would end. Leaving
  // the object costs one file handle until the program ends by itself.
  (void)bag_.release();
  throw FileError("bag '" + path() + "' cannot be written (folder missing, or disk full): " + error.what());
}

template <class Message>
void RecordingBag::write(const std::string& topic, Stamp stamp, const Message& message) {
  try {
    bag_->write(topic, toRos(stamp), message);
  } catch (const rosbag::BagException& error) {
    fail(error);
  }
}

void RecordingBag::writeColour(Stamp stamp, const cv::Mat3b& bgr) {
  cv::Mat rgb;
  cv::cvtColor(bgr, rgb, cv::COLOR_BGR2RGB);
  write(kTumTopics.colour, stamp, *toRos(opticalHeader(stamp), encodings::RGB8, rgb));
  write(kTumTopics.camera_info, stamp, cameraInfo(stamp, camera_));
}

void RecordingBag::writeDepth(Stamp stamp, const cv::Mat1f& depth_m) {
  cv::Mat1f with_nan = depth_m.clone();
  with_nan.setTo(std::numeric_limits<float>::quiet_NaN(), depth_m <= 0.0F);
  write(kTumTopics.depth, stamp, *toRos(opticalHeader(stamp), encodings::TYPE_32FC1, with_nan));
  write(kTumDepthInfoTopic, stamp, cameraInfo(stamp, camera_));
}

void RecordingBag::writeMask(Stamp stamp, const cv::Mat1b& mask) {
  write(kMaskTopic, stamp, *toRos(opticalHeader(stamp), encodings::MONO8, mask));
}

void RecordingBag::writeLabels(Stamp stamp, const cv::Mat1b& labels) {
  write(kLabelsTopic, stamp, *toRos(opticalHeader(stamp), encodings::MONO8, labels));
}

void RecordingBag::writePoseMessage(Stamp stamp, const SE3& T_world_camera) {
  geometry_msgs::PoseStamped message;
  message.header.stamp = toRos(stamp);
  message.header.frame_id = kTumWorldFrame;
  message.pose = toPose(T_world_camera);
  write(kPoseTopic, stamp, message);
}

void RecordingBag::writeTruePose(Stamp stamp, const SE3& T_world_camera) {
  const SE3 T_optical_body = bodyFromOptical().inverse();
  tf2_msgs::TFMessage message;  // same fields and MD5 sum as the tf/tfMessage of the benchmark's bags
  message.transforms = {edge(stamp, kTumWorldFrame, "/kinect", T_world_camera * T_optical_body),
                        edge(stamp, "/kinect", "/openni_camera", SE3::Identity()),
                        edge(stamp, "/openni_camera", "/openni_rgb_frame", SE3::Identity()),
                        edge(stamp, "/openni_rgb_frame", kTumOpticalFrame, bodyFromOptical())};
  write("/tf", stamp, message);
}

void RecordingBag::close() {
  try {
    bag_->close();
    bag_.reset();
    file_.commit();
  } catch (const rosbag::BagException& error) {
    fail(error);
  }
}

}  // namespace semantic_vslam
