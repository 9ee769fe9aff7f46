// SPDX-FileCopyrightText: 2026 The semantic_vslam authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <geometry_msgs/Pose.h>
#include <geometry_msgs/Transform.h>
#include <geometry_msgs/Twist.h>
#include <nav_msgs/OccupancyGrid.h>
#include <ros/time.h>
#include <semantic_vslam/KeyframePoseArray.h>
#include <semantic_vslam/KeyframeStamped.h>
#include <semantic_vslam/LabelInfo.h>
#include <semantic_vslam/MotionReport.h>
#include <semantic_vslam/ObjectArray.h>
#include <semantic_vslam/TrackingReport.h>
#include <sensor_msgs/CameraInfo.h>
#include <sensor_msgs/Image.h>
#include <sensor_msgs/PointCloud2.h>
#include <visualization_msgs/MarkerArray.h>

#include <boost/array.hpp>
#include <cstdint>
#include <opencv2/core.hpp>
#include <string>
#include <vector>

#include "core/dense/keyframe_cloud.h"
#include "core/dense/map_objects.h"
#include "core/dense/occupancy_grid.h"
#include "core/dense/octomap_export.h"
#include "core/dense/surface_cloud.h"
#include "semantic_vslam/core/camera/rgbd_frame.h"
#include "semantic_vslam/core/common/label_set.h"
#include "semantic_vslam/core/common/stamp.h"
#include "semantic_vslam/core/geometry/se3.h"
#include "semantic_vslam/core/geometry/timed_pose.h"
#include "semantic_vslam/core/motion/motion_result.h"
#include "semantic_vslam/core/pipeline/messages.h"

/// Between the messages of ROS and the values of the core.
namespace semantic_vslam {

Stamp fromRos(const ros::Time& time);
ros::Time toRos(Stamp stamp);

SE3 fromRos(const geometry_msgs::Pose& pose);
SE3 fromRos(const geometry_msgs::Transform& transform);
geometry_msgs::Pose toPose(const SE3& transform);
geometry_msgs::Transform toTransform(const SE3& transform);
/// @param velocity  translation (m/s) first, rotation (rad/s) second
geometry_msgs::Twist toTwist(const Vector6d& velocity);

/// Rotation from the optical frame (x right, y down, z forward) to a body frame (x forward, y left, z up), REP 103.
SE3 bodyFromOptical();

/// Frame name without the leading slash of old drivers and bags, which tf2 refuses.
std::string frameName(const std::string& frame_id);

/// Covariance of a body's pose as geometry_msgs has it: row-major, position (m) first, then rotation about the axes of
/// the fixed frame (rad).
/// @param covariance  of the left perturbation of T_camera_world, translation first: the core's
/// @param T_camera_body  where the body is; its lever arm turns rotation into position
boost::array<double, 36> bodyCovariance(const Matrix6d& covariance, const SE3& T_map_camera, const SE3& T_camera_body);

/// @param rectified  true: the images are rectified, so P holds and there is no distortion; false: K and D hold. Where
/// D is zero and only one of P and K is filled in, that one holds.
/// @throws Error if the camera is uncalibrated or its distortion model is not plumb_bob.
CameraIntrinsics fromRos(const sensor_msgs::CameraInfo& info, bool rectified);

// An image that needs no conversion is not copied: it shows the message's memory, keeps the message alive, and must not
// be written to.

/// @param message bgr8, rgb8, bgra8, rgba8, mono8, 8UC3 (BGR), 8UC1, bayer_*8 or yuv422. @return 8UC3 BGR or 8UC1.
/// @throws Error naming the encoding, or what is wrong with the image.
cv::Mat colourFromRos(const sensor_msgs::ImageConstPtr& message);

constexpr double kMetresPerMillimetre = 0.001;  ///< REP 118: 16UC1 depth is in millimetres

/// @param message 32FC1 (metres), 16UC1 or mono16 (millimetres), REP 118.
/// @throws Error naming the encoding, or what is wrong with the image.
cv::Mat depthFromRos(const sensor_msgs::ImageConstPtr& message);

/// @param message mono8 or 8UC1: a mask or labels.
/// @throws Error naming the encoding, or what is wrong with the image.
cv::Mat1b maskFromRos(const sensor_msgs::ImageConstPtr& message);

/// @param header  of the image it was derived from: stamp and frame_id stay. @param encoding mono8 or bgr8.
sensor_msgs::ImagePtr toRos(const std_msgs::Header& header, const std::string& encoding, const cv::Mat& image);

LabelSet fromRos(const LabelInfo& info);
LabelInfo toRos(const LabelSet& labels);

KeyframePose fromRos(const KeyframeStamped& message);
KeyframeNotice noticeFromRos(const KeyframeStamped& message);
/// @param report  beside_keyframe is true
FramePlace placeFromRos(const TrackingReport& report);
/// All but the mask, which has a topic of its own. @throws Error if `moving` is no image
MotionResult fromRos(const MotionReportConstPtr& report);
MotionReport toRos(const std_msgs::Header& header, const MotionResult& motion);
/// @throws Error, see maskFromRos
FrameLabels labelsFromRos(const sensor_msgs::ImageConstPtr& message);
/// Of what is published of a frame.
std_msgs::Header headerOf(const RgbdFrame& frame);
MapSnapshot fromRos(const KeyframePoseArray& message);
KeyframeStamped toRos(const KeyframePose& pose, const std::string& map_frame, std::uint32_t map_id);

/// Unordered cloud with the fields x y z (float32, metres), rgb (packed, as rviz and PCL expect) and label (uint8).
sensor_msgs::PointCloud2Ptr toRos(const std::vector<LabelledPoint>& points, const std_msgs::Header& header);
sensor_msgs::PointCloud2Ptr toRos(const SurfaceCloud& cloud, const std_msgs::Header& header);

ObjectArray messageOf(const std::vector<MapObject>& objects, const LabelSet& labels, const std_msgs::Header& header);
/// A box and a text with class and id for each object, for rviz; the first marker removes those of before.
visualization_msgs::MarkerArray toRos(const std::vector<MapObject>& objects, const LabelSet& labels,
                                      const std_msgs::Header& header);

nav_msgs::OccupancyGrid toRos(const OccupancyGrid& grid, const std_msgs::Header& header);

/// Unordered cloud with the fields x y z (float32, metres).
sensor_msgs::PointCloud2Ptr toRos(const std::vector<Eigen::Vector3d>& points, const std_msgs::Header& header);
sensor_msgs::PointCloud2Ptr toRos(const std::vector<Eigen::Vector3f>& points, const std_msgs::Header& header);

}  // namespace semantic_vslam
