// SPDX-FileCopyrightText: 2026 The semantic_vslam authors
// SPDX-License-Identifier: BSD-3-Clause
#include "semantic_vslam/ros/conversions.h"

#include <cv_bridge/cv_bridge.h>
#include <sensor_msgs/distortion_models.h>
#include <sensor_msgs/image_encodings.h>
#include <sensor_msgs/point_cloud2_iterator.h>

#include <algorithm>
#include <boost/make_shared.hpp>

#include "semantic_vslam/core/common/error.h"

namespace semantic_vslam {
namespace {

namespace encodings = sensor_msgs::image_encodings;

cv_bridge::CvImageConstPtr share(const sensor_msgs::ImageConstPtr& message, const std::string& encoding) {
  try {
    return cv_bridge::toCvShare(message, encoding);
  } catch (const cv_bridge::Exception& error) {
    throw Error(std::string("image cannot be read: ") + error.what());
  }
}

[[noreturn]] void refuseEncoding(const char* what, const sensor_msgs::Image& message, const char* accepted) {
  throw Error(std::string(what) + " image has encoding '" + message.encoding + "', must be " + accepted);
}

template <class Message>
SE3 isometry(const Message& rotation, double x, double y, double z) {
  return makeSE3(Eigen::Quaterniond(rotation.w, rotation.x, rotation.y, rotation.z), Eigen::Vector3d(x, y, z));
}

Mobility mobilityFromRos(std::uint8_t mobility) {
  switch (mobility) {
    case LabelDescription::PERSON: return Mobility::kPerson;
    case LabelDescription::MOVABLE: return Mobility::kMovable;
    default: return Mobility::kStatic;
  }
}

std::uint8_t mobilityToRos(Mobility mobility) {
  switch (mobility) {
    case Mobility::kPerson: return LabelDescription::PERSON;
    case Mobility::kMovable: return LabelDescription::MOVABLE;
    case Mobility::kStatic: break;
  }
  return LabelDescription::STATIC;
}

/// Distortion as k1 k2 p1 p2 k3; missing coefficients are 0.
std::array<double, 5> plumbBob(const sensor_msgs::CameraInfo& info) {
  const auto& d = info.D;
  const bool all_zero = std::all_of(d.begin(), d.end(), [](double value) { return value == 0.0; });
  std::array<double, 5> coefficients{};
  if (all_zero) return coefficients;
  // A rational model whose last three coefficients are 0 is a plumb_bob model.
  const bool reducible =
      std::all_of(d.begin() + std::min<std::size_t>(5, d.size()), d.end(), [](double value) { return value == 0.0; });
  const bool polynomial = info.distortion_model == sensor_msgs::distortion_models::PLUMB_BOB ||
                          info.distortion_model == sensor_msgs::distortion_models::RATIONAL_POLYNOMIAL;
  if (!polynomial || !reducible) {
    throw Error("camera_info has the distortion model '" + info.distortion_model +
                "', must be plumb_bob; rectify the images (image_proc) or give a camera_file");
  }
  std::copy_n(d.begin(), std::min<std::size_t>(5, d.size()), coefficients.begin());
  return coefficients;
}

}  // namespace

Stamp fromRos(const ros::Time& time) { return Stamp{static_cast<std::int64_t>(time.toNSec())}; }

ros::Time toRos(Stamp stamp) {
  ros::Time time;
  return stamp.ns > 0 ? time.fromNSec(static_cast<std::uint64_t>(stamp.ns)) : time;
}

SE3 fromRos(const geometry_msgs::Pose& pose) {
  return isometry(pose.orientation, pose.position.x, pose.position.y, pose.position.z);
}

SE3 fromRos(const geometry_msgs::Transform& transform) {
  return isometry(transform.rotation, transform.translation.x, transform.translation.y, transform.translation.z);
}

geometry_msgs::Pose toPose(const SE3& transform) {
  const Eigen::Quaterniond q(transform.linear());
  geometry_msgs::Pose pose;
  pose.position.x = transform.translation().x();
  pose.position.y = transform.translation().y();
  pose.position.z = transform.translation().z();
  pose.orientation.x = q.x();
  pose.orientation.y = q.y();
  pose.orientation.z = q.z();
  pose.orientation.w = q.w();
  return pose;
}

geometry_msgs::Transform toTransform(const SE3& transform) {
  const geometry_msgs::Pose pose = toPose(transform);
  geometry_msgs::Transform out;
  out.translation.x = pose.position.x;
  out.translation.y = pose.position.y;
  out.translation.z = pose.position.z;
  out.rotation = pose.orientation;
  return out;
}

SE3 bodyFromOptical() {
  SE3 T_body_optical = SE3::Identity();
  T_body_optical.linear() << 0, 0, 1,  // forward is the optical z
      -1, 0, 0,                        // left is against the optical x
      0, -1, 0;                        // up is against the optical y
  return T_body_optical;
}

boost::array<double, 36> toRosCovariance(const Matrix6d& covariance) {
  boost::array<double, 36> out;
  Eigen::Map<Eigen::Matrix<double, 6, 6, Eigen::RowMajor>>(out.data()) = covariance;
  return out;
}

CameraIntrinsics fromRos(const sensor_msgs::CameraInfo& info, bool rectified) {
  CameraIntrinsics k;
  k.width = static_cast<int>(info.width);
  k.height = static_cast<int>(info.height);
  if (rectified) {
    k.fx = info.P[0], k.fy = info.P[5], k.cx = info.P[2], k.cy = info.P[6];
  } else {
    k.fx = info.K[0], k.fy = info.K[4], k.cx = info.K[2], k.cy = info.K[5];
    k.distortion = plumbBob(info);
  }
  if (!(k.fx > 0 && k.fy > 0)) {
    throw Error(std::string("camera_info is uncalibrated (focal length in ") + (rectified ? "P" : "K") +
                " is not positive); calibrate the camera or give a camera_file");
  }
  return k;
}

cv::Mat colourFromRos(const sensor_msgs::ImageConstPtr& message) {
  const std::string& encoding = message->encoding;
  if (encoding == encodings::BGR8 || encoding == encodings::MONO8) return share(message, encoding)->image.clone();
  if (encoding == encodings::RGB8 || encoding == encodings::RGBA8 || encoding == encodings::BGRA8) {
    return share(message, encodings::BGR8)->image;  // converted, hence a buffer of its own
  }
  refuseEncoding("colour", *message, "rgb8, bgr8, rgba8, bgra8 or mono8");
}

cv::Mat depthFromRos(const sensor_msgs::ImageConstPtr& message) {
  const std::string& encoding = message->encoding;
  if (encoding != encodings::TYPE_32FC1 && encoding != encodings::TYPE_16UC1) {
    refuseEncoding("depth", *message, "32FC1 (metres) or 16UC1 (millimetres)");
  }
  return share(message, encoding)->image;
}

cv::Mat1b maskFromRos(const sensor_msgs::ImageConstPtr& message) {
  const std::string& encoding = message->encoding;
  if (encoding != encodings::MONO8 && encoding != encodings::TYPE_8UC1) refuseEncoding("mask", *message, "mono8");
  return share(message, encoding)->image.clone();
}

sensor_msgs::ImagePtr toRos(const std_msgs::Header& header, const std::string& encoding, const cv::Mat& image) {
  return cv_bridge::CvImage(header, encoding, image).toImageMsg();
}

LabelSet fromRos(const LabelInfo& info) {
  const auto byte = [](float value) { return cv::saturate_cast<std::uint8_t>(value * 255.0F); };
  LabelSet labels;
  labels.classes.clear();
  for (const LabelDescription& entry : info.classes) {
    const cv::Vec3b color_bgr(byte(entry.color.b), byte(entry.color.g), byte(entry.color.r));
    labels.classes.push_back({entry.name, mobilityFromRos(entry.mobility), color_bgr});
  }
  return labels;
}

LabelInfo toRos(const LabelSet& labels) {
  LabelInfo info;
  for (const LabelClass& entry : labels.classes) {
    LabelDescription out;
    out.name = entry.name;
    out.mobility = mobilityToRos(entry.mobility);
    out.color.b = static_cast<float>(entry.color_bgr[0]) / 255.0F;
    out.color.g = static_cast<float>(entry.color_bgr[1]) / 255.0F;
    out.color.r = static_cast<float>(entry.color_bgr[2]) / 255.0F;
    out.color.a = 1.0F;
    info.classes.push_back(std::move(out));
  }
  return info;
}

KeyframePose fromRos(const KeyframeStamped& message) {
  return {KeyframeId(message.id), fromRos(message.header.stamp), fromRos(message.pose)};
}

std::vector<KeyframePose> fromRos(const KeyframePoseArray& message) {
  std::vector<KeyframePose> poses;
  poses.reserve(message.keyframes.size());
  for (const KeyframeStamped& keyframe : message.keyframes) poses.push_back(fromRos(keyframe));
  return poses;
}

KeyframeStamped toRos(const KeyframePose& pose, const std::string& map_frame, std::uint32_t map_id) {
  KeyframeStamped message;
  message.header.stamp = toRos(pose.stamp);
  message.header.frame_id = map_frame;
  message.id = pose.keyframe.value();
  message.map_id = map_id;
  message.pose = toPose(pose.T_world_camera);
  return message;
}

sensor_msgs::PointCloud2Ptr toRos(const std::vector<LabelledPoint>& points, const std_msgs::Header& header) {
  using sensor_msgs::PointField;
  auto cloud = boost::make_shared<sensor_msgs::PointCloud2>();
  cloud->header = header;
  cloud->is_dense = true;
  sensor_msgs::PointCloud2Modifier modifier(*cloud);
  modifier.setPointCloud2Fields(5, "x", 1, PointField::FLOAT32, "y", 1, PointField::FLOAT32, "z", 1,
                                PointField::FLOAT32, "rgb", 1, PointField::FLOAT32, "label", 1, PointField::UINT8);
  modifier.resize(points.size());
  sensor_msgs::PointCloud2Iterator<float> xyz(*cloud, "x");
  sensor_msgs::PointCloud2Iterator<std::uint8_t> bgr(*cloud, "rgb"), label(*cloud, "label");
  for (const LabelledPoint& point : points) {
    for (int i = 0; i < 3; ++i) xyz[i] = point.xyz_m[i];
    for (int i = 0; i < 3; ++i) bgr[i] = point.bgr[i];
    bgr[3] = 0;
    *label = point.label;
    ++xyz, ++bgr, ++label;
  }
  return cloud;
}

sensor_msgs::PointCloud2Ptr toRos(const std::vector<Eigen::Vector3d>& points, const std_msgs::Header& header) {
  auto cloud = boost::make_shared<sensor_msgs::PointCloud2>();
  cloud->header = header;
  cloud->is_dense = true;
  sensor_msgs::PointCloud2Modifier modifier(*cloud);
  modifier.setPointCloud2FieldsByString(1, "xyz");
  modifier.resize(points.size());
  sensor_msgs::PointCloud2Iterator<float> xyz(*cloud, "x");
  for (const Eigen::Vector3d& point : points) {
    for (int i = 0; i < 3; ++i) xyz[i] = static_cast<float>(point[i]);
    ++xyz;
  }
  return cloud;
}

}  // namespace semantic_vslam
