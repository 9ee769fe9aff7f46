// SPDX-FileCopyrightText: 2026 The semantic_vslam authors
// SPDX-License-Identifier: BSD-3-Clause
#include "ros/conversions.h"

#include <cv_bridge/cv_bridge.h>
#include <sensor_msgs/distortion_models.h>
#include <sensor_msgs/image_encodings.h>
#include <sensor_msgs/point_cloud2_iterator.h>

#include <algorithm>
#include <boost/make_shared.hpp>
#include <cstring>
#include <utility>

#include "semantic_vslam/core/common/error.h"

namespace semantic_vslam {
namespace {

namespace encodings = sensor_msgs::image_encodings;

/// Lets an image live as long as the message whose memory it shows, so that neither is copied.
class MessageMemory final : public cv::MatAllocator {
 public:
  static void own(cv::Mat& image, const sensor_msgs::ImageConstPtr& message) {
    static const MessageMemory memory;
    auto* data = new cv::UMatData(&memory);
    data->data = data->origdata = image.data;
    data->size = image.total() * image.elemSize();
    data->userdata = new sensor_msgs::ImageConstPtr(message);
    image.u = data;
    image.addref();
  }

 private:
  cv::UMatData* allocate(int dims, const int* sizes, int type, void* data, std::size_t* step, cv::AccessFlag access,
                         cv::UMatUsageFlags usage) const override {
    return cv::Mat::getStdAllocator()->allocate(dims, sizes, type, data, step, access, usage);
  }
  bool allocate(cv::UMatData* data, cv::AccessFlag access, cv::UMatUsageFlags usage) const override {
    return cv::Mat::getStdAllocator()->allocate(data, access, usage);
  }
  void deallocate(cv::UMatData* data) const override {
    delete static_cast<sensor_msgs::ImageConstPtr*>(data->userdata);
    delete data;
  }
};

/// The image in an encoding; where it has that already, in the message's own memory.
cv::Mat share(const sensor_msgs::ImageConstPtr& message, const std::string& encoding) {
  const std::uint64_t bytes = std::uint64_t{message->step} * message->height;  // cv_bridge reckons with 32 bits
  if (bytes != message->data.size() || bytes == 0) {
    throw Error("image of " + std::to_string(message->width) + "x" + std::to_string(message->height) + " and step " +
                std::to_string(message->step) + " has " + std::to_string(message->data.size()) +
                " bytes; the driver must fill height x step");
  }
  try {
    cv::Mat image = cv_bridge::toCvShare(message, encoding)->image;
    if (!image.u) MessageMemory::own(image, message);
    return image;
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

std_msgs::ColorRGBA colorOf(const LabelClass& entry) {
  std_msgs::ColorRGBA color;
  color.b = static_cast<float>(entry.color_bgr[0]) / 255.0F;
  color.g = static_cast<float>(entry.color_bgr[1]) / 255.0F;
  color.r = static_cast<float>(entry.color_bgr[2]) / 255.0F;
  color.a = 1.0F;
  return color;
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

/// camera_info describes the whole sensor: the images may show a region of it, and several of its pixels as one.
void takePartOfSensor(const sensor_msgs::CameraInfo& info, CameraIntrinsics& k) {
  if (info.roi.width > 0 && info.roi.height > 0) {
    k.width = cv::saturate_cast<int>(info.roi.width);
    k.height = cv::saturate_cast<int>(info.roi.height);
    k.cx -= info.roi.x_offset;
    k.cy -= info.roi.y_offset;
  }
  const int across = std::max(1, cv::saturate_cast<int>(info.binning_x)),
            down = std::max(1, cv::saturate_cast<int>(info.binning_y));
  k.width /= across;
  k.height /= down;
  k.fx /= across;
  k.cx /= across;
  k.fy /= down;
  k.cy /= down;
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

geometry_msgs::Twist toTwist(const Vector6d& velocity) {
  geometry_msgs::Twist twist;
  twist.linear.x = velocity[0];
  twist.linear.y = velocity[1];
  twist.linear.z = velocity[2];
  twist.angular.x = velocity[3];
  twist.angular.y = velocity[4];
  twist.angular.z = velocity[5];
  return twist;
}

SE3 bodyFromOptical() {
  SE3 T_body_optical = SE3::Identity();
  T_body_optical.linear() << 0, 0, 1,  // forward is the optical z
      -1, 0, 0,                        // left is against the optical x
      0, -1, 0;                        // up is against the optical y
  return T_body_optical;
}

std::string frameName(const std::string& frame_id) {
  return frame_id.empty() || frame_id.front() != '/' ? frame_id : frame_id.substr(1);
}

boost::array<double, 36> bodyCovariance(const Matrix6d& covariance, const SE3& T_map_camera, const SE3& T_camera_body) {
  // exp(xi) T_camera_world moves the camera by -xi in its own axes. The body, at t in the camera, is moved by
  // -(rho + phi x t); everything is then turned into the map's axes. The common sign does not matter.
  const Eigen::Matrix3d R_map_camera = T_map_camera.linear();
  Matrix6d J = Matrix6d::Zero();
  J.topLeftCorner<3, 3>() = R_map_camera;
  J.topRightCorner<3, 3>() = -R_map_camera * skew(T_camera_body.translation());
  J.bottomRightCorner<3, 3>() = R_map_camera;
  boost::array<double, 36> out;
  Eigen::Map<Eigen::Matrix<double, 6, 6, Eigen::RowMajor>>(out.data()) = J * covariance * J.transpose();
  return out;
}

CameraIntrinsics fromRos(const sensor_msgs::CameraInfo& info, bool rectified) {
  CameraIntrinsics k;
  k.width = cv::saturate_cast<int>(info.width);
  k.height = cv::saturate_cast<int>(info.height);
  // Drivers that fill in one of the two alone have no distortion to tell them apart by.
  const bool undistorted = std::all_of(info.D.begin(), info.D.end(), [](double d) { return d == 0.0; });
  const bool only_k = info.P[0] == 0.0 && info.K[0] > 0.0, only_p = info.K[0] == 0.0 && info.P[0] > 0.0;
  if (undistorted && (rectified ? only_k : only_p)) rectified = !rectified;
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
  takePartOfSensor(info, k);
  return k;
}

cv::Mat colourFromRos(const sensor_msgs::ImageConstPtr& message) {
  const std::string& encoding = message->encoding;
  if (encoding == encodings::BGR8 || encoding == encodings::MONO8) return share(message, encoding);
  if (encoding == encodings::TYPE_8UC3 || encoding == encodings::TYPE_8UC1) return share(message, encoding);
  const bool converted = encoding == encodings::RGB8 || encoding == encodings::RGBA8 || encoding == encodings::BGRA8 ||
                         encoding == encodings::YUV422 ||
                         (encodings::isBayer(encoding) && encodings::bitDepth(encoding) == 8);
  if (converted) return share(message, encodings::BGR8);
  refuseEncoding("colour", *message, "rgb8, bgr8, rgba8, bgra8, mono8, 8UC3 (BGR), bayer_*8 or yuv422");
}

cv::Mat depthFromRos(const sensor_msgs::ImageConstPtr& message) {
  const std::string& encoding = message->encoding;
  if (encoding != encodings::TYPE_32FC1 && encoding != encodings::TYPE_16UC1 && encoding != encodings::MONO16) {
    refuseEncoding("depth", *message, "32FC1 (metres), 16UC1 or mono16 (millimetres)");
  }
  return share(message, encoding);
}

cv::Mat1b maskFromRos(const sensor_msgs::ImageConstPtr& message) {
  const std::string& encoding = message->encoding;
  if (encoding != encodings::MONO8 && encoding != encodings::TYPE_8UC1) refuseEncoding("mask", *message, "mono8");
  return share(message, encoding);
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
    out.color = colorOf(entry);
    info.classes.push_back(std::move(out));
  }
  return info;
}

KeyframePose fromRos(const KeyframeStamped& message) {
  return {KeyframeId(message.id), fromRos(message.header.stamp), fromRos(message.pose)};
}

MapSnapshot fromRos(const KeyframePoseArray& message) {
  MapSnapshot map;
  map.map_id = message.map_id;
  map.origin = message.origin;
  for (const KeyframeStamped& keyframe : message.keyframes) {
    if (keyframe.placed) {
      map.poses.push_back(fromRos(keyframe));
    } else {
      map.unplaced.push_back(KeyframeId(keyframe.id));
    }
  }
  return map;
}

MotionResult fromRos(const MotionReportConstPtr& report) {
  MotionResult motion;
  motion.model = static_cast<MotionModel>(report->model);
  motion.told = report->told != 0;
  motion.inliers = static_cast<int>(report->inliers);
  motion.dynamic_share = report->dynamic_share;
  if (!report->labels.isZero()) motion.labels = fromRos(report->labels);
  if (report->moving.data.empty()) return motion;
  motion.moving = maskFromRos(sensor_msgs::ImageConstPtr(report, &report->moving));
  return motion;
}

MotionReport toRos(const std_msgs::Header& header, const MotionResult& motion) {
  static_assert(static_cast<int>(MotionModel::kRigidFlow) == MotionReport::MODEL_RIGID_FLOW &&
                static_cast<int>(MotionModel::kHomography) == MotionReport::MODEL_HOMOGRAPHY);
  MotionReport report;
  report.header = header;
  report.model = static_cast<std::uint8_t>(motion.model);
  report.told = motion.told;
  report.inliers = static_cast<std::uint32_t>(motion.inliers);
  report.dynamic_share = static_cast<float>(motion.dynamic_share);
  if (motion.labels) report.labels = toRos(*motion.labels);
  if (!motion.moving.empty()) cv_bridge::CvImage(header, "mono8", motion.moving).toImageMsg(report.moving);
  return report;
}

KeyframeNotice noticeFromRos(const KeyframeStamped& message) {
  return {KeyframeId(message.id), message.map_id, fromRos(message.header.stamp)};
}

FramePlace placeFromRos(const TrackingReport& report) {
  return {fromRos(report.header.stamp), report.map_id, KeyframeId(report.keyframe), fromRos(report.in_keyframe)};
}

FrameLabels labelsFromRos(const sensor_msgs::ImageConstPtr& message) {
  return {fromRos(message->header.stamp), maskFromRos(message)};
}

std_msgs::Header headerOf(const RgbdFrame& frame) {
  std_msgs::Header header;
  header.stamp = toRos(frame.stamp);
  header.frame_id = frame.sensor_frame;
  return header;
}

KeyframeStamped toRos(const KeyframePose& pose, const std::string& map_frame, std::uint32_t map_id) {
  KeyframeStamped message;
  message.header.stamp = toRos(pose.stamp);
  message.header.frame_id = map_frame;
  message.id = pose.keyframe.value();
  message.map_id = map_id;
  message.pose = toPose(pose.T_world_camera);
  message.placed = true;
  return message;
}

namespace {

/// Points of the map one after another into a message of known size: a map has millions.
class CloudWriter {
 public:
  CloudWriter(std::size_t points, const std_msgs::Header& header)
      : cloud_(boost::make_shared<sensor_msgs::PointCloud2>()) {
    using sensor_msgs::PointField;
    cloud_->header = header;
    cloud_->is_dense = true;
    sensor_msgs::PointCloud2Modifier modifier(*cloud_);
    modifier.setPointCloud2Fields(5, "x", 1, PointField::FLOAT32, "y", 1, PointField::FLOAT32, "z", 1,
                                  PointField::FLOAT32, "rgb", 1, PointField::FLOAT32, "label", 1, PointField::UINT8);
    modifier.resize(points);
    next_ = cloud_->data.data();
  }

  void add(const std::vector<LabelledPoint>& points) {
    const std::size_t rgb = cloud_->fields[3].offset, label = cloud_->fields[4].offset, step = cloud_->point_step;
    for (const LabelledPoint& point : points) {
      std::memcpy(next_, point.xyz_m.val, sizeof(point.xyz_m.val));
      std::memcpy(next_ + rgb, point.bgr.val, sizeof(point.bgr.val));  // the fourth byte is 0
      next_[label] = point.label;
      next_ += step;
    }
  }
  const sensor_msgs::PointCloud2Ptr& cloud() const { return cloud_; }

 private:
  sensor_msgs::PointCloud2Ptr cloud_;
  std::uint8_t* next_;
};

}  // namespace

sensor_msgs::PointCloud2Ptr toRos(const std::vector<LabelledPoint>& points, const std_msgs::Header& header) {
  CloudWriter writer(points.size(), header);
  writer.add(points);
  return writer.cloud();
}

sensor_msgs::PointCloud2Ptr toRos(const SurfaceCloud& cloud, const std_msgs::Header& header) {
  CloudWriter writer(cloud.size(), header);
  cloud.forEachPart([&](const std::vector<LabelledPoint>& part) { writer.add(part); });
  return writer.cloud();
}

namespace {

SE3 boxOf(const MapObject& object) {
  return SE3(Eigen::Translation3d(object.middle_m) * Eigen::AngleAxisd(object.yaw_rad, Eigen::Vector3d::UnitZ()));
}

}  // namespace

ObjectArray messageOf(const std::vector<MapObject>& objects, const LabelSet& labels, const std_msgs::Header& header) {
  ObjectArray array;
  array.header = header;
  for (const MapObject& object : objects) {
    if (object.label >= labels.size()) continue;
    Object message;
    message.id = object.id;
    message.label = labels.classes[object.label].name;
    message.confidence = static_cast<float>(object.confidence);
    message.centroid = toPose(SE3(Eigen::Translation3d(object.centroid_m))).position;
    message.box = toPose(boxOf(object));
    message.box_size.x = object.size_m.x();
    message.box_size.y = object.size_m.y();
    message.box_size.z = object.size_m.z();
    message.points = static_cast<std::uint32_t>(object.points);
    message.last_seen = toRos(object.last_seen);
    array.objects.push_back(std::move(message));
  }
  return array;
}

visualization_msgs::MarkerArray toRos(const std::vector<MapObject>& objects, const LabelSet& labels,
                                      const std_msgs::Header& header) {
  using visualization_msgs::Marker;
  visualization_msgs::MarkerArray array;
  Marker marker;
  marker.header = header;
  marker.action = Marker::DELETEALL;
  array.markers.push_back(marker);
  marker.action = Marker::ADD;
  for (const MapObject& object : objects) {
    if (object.label >= labels.size()) continue;
    const LabelClass& kind = labels.classes[object.label];
    marker.pose = toPose(boxOf(object));
    marker.color = colorOf(kind);
    marker.color.a = 0.35F;
    marker.ns = "box";
    marker.type = Marker::CUBE;
    const Eigen::Vector3d size_m = object.size_m.cwiseMax(0.01);  // rviz draws nothing that is flat
    marker.scale.x = size_m.x();
    marker.scale.y = size_m.y();
    marker.scale.z = size_m.z();
    array.markers.push_back(marker);

    marker.ns = "class";
    marker.type = Marker::TEXT_VIEW_FACING;
    marker.text = object.id == 0 ? kind.name : kind.name + " " + std::to_string(object.id);
    marker.color.a = 1.0F;
    marker.pose.position.z = object.box_m.max().z() + 0.08;
    marker.scale.z = 0.12;  // height of a capital letter, m
    array.markers.push_back(marker);
    ++marker.id;
  }
  return array;
}

nav_msgs::OccupancyGrid toRos(const OccupancyGrid& grid, const std_msgs::Header& header) {
  nav_msgs::OccupancyGrid message;
  message.header = header;
  message.info.map_load_time = header.stamp;
  message.info.resolution = static_cast<float>(grid.resolution_m);
  message.info.width = static_cast<std::uint32_t>(grid.width);
  message.info.height = static_cast<std::uint32_t>(grid.height);
  message.info.origin.position.x = grid.origin_x_m;
  message.info.origin.position.y = grid.origin_y_m;
  message.info.origin.orientation.w = 1.0;
  message.data = grid.cells;
  return message;
}

namespace {

template <class Point>
sensor_msgs::PointCloud2Ptr toCloud(const std::vector<Point>& points, const std_msgs::Header& header) {
  auto cloud = boost::make_shared<sensor_msgs::PointCloud2>();
  cloud->header = header;
  cloud->is_dense = true;
  sensor_msgs::PointCloud2Modifier modifier(*cloud);
  modifier.setPointCloud2FieldsByString(1, "xyz");
  modifier.resize(points.size());
  sensor_msgs::PointCloud2Iterator<float> xyz(*cloud, "x");
  for (const Point& point : points) {
    for (int i = 0; i < 3; ++i) xyz[i] = static_cast<float>(point[i]);
    ++xyz;
  }
  return cloud;
}

}  // namespace

sensor_msgs::PointCloud2Ptr toRos(const std::vector<Eigen::Vector3d>& points, const std_msgs::Header& header) {
  return toCloud(points, header);
}

sensor_msgs::PointCloud2Ptr toRos(const std::vector<Eigen::Vector3f>& points, const std_msgs::Header& header) {
  return toCloud(points, header);
}

}  // namespace semantic_vslam
