// SPDX-FileCopyrightText: 2026 The semantic_vslam authors
// SPDX-License-Identifier: BSD-3-Clause
#include "ros/bag_source.h"

#include <geometry_msgs/PoseStamped.h>
#include <rosbag/view.h>
#include <sensor_msgs/CameraInfo.h>
#include <sensor_msgs/Image.h>
#include <std_msgs/Header.h>

#include <algorithm>
#include <filesystem>
#include <set>

#include "core/common/input_file.h"
#include "core/io/stamp_association.h"
#include "ros/bag_records.h"
#include "ros/conversions.h"
#include "semantic_vslam/core/common/error.h"
#include "semantic_vslam/core/common/log.h"

namespace semantic_vslam {
namespace {

/// @return stamp of a message that begins with a header; the time of recording where the driver left it empty.
Stamp headerStamp(const rosbag::MessageInstance& message, std::vector<std::uint8_t>& buffer) {
  buffer.resize(message.size());
  ros::serialization::OStream out(buffer.data(), static_cast<std::uint32_t>(buffer.size()));
  message.write(out);
  ros::serialization::IStream in(buffer.data(), static_cast<std::uint32_t>(buffer.size()));
  std_msgs::Header header;
  ros::serialization::deserialize(in, header);
  return fromRos(header.stamp.isZero() ? message.getTime() : header.stamp);
}

/// Topics with images, for the message that none is known: "/a (sensor_msgs/Image), ...".
std::string imageTopics(const std::vector<const rosbag::ConnectionInfo*>& connections) {
  std::set<std::string> names;
  for (const auto* connection : connections) {
    if (connection->datatype.find("Image") != std::string::npos) {
      names.insert(connection->topic + " (" + connection->datatype + ")");
    }
  }
  std::string list;
  for (const auto& name : names) list += (list.empty() ? "" : ", ") + name;
  return list.empty() ? "none" : list;
}

/// The Kinect driver's values for a camera that nobody calibrated: TUM's bags carry them.
bool isUncalibratedDefault(const CameraIntrinsics& k) {
  const bool undistorted = std::all_of(k.distortion.begin(), k.distortion.end(), [](double d) { return d == 0.0; });
  return undistorted && k.fx == 525.0 && k.fy == 525.0 && k.cx == 319.5 && k.cy == 239.5;
}

sensor_msgs::ImageConstPtr image(const rosbag::MessageInstance& message) {
  const sensor_msgs::ImageConstPtr out = message.instantiate<sensor_msgs::Image>();
  if (!out) throw FileError("message of '" + message.getTopic() + "' is no image");
  return out;
}

}  // namespace

BagSource::BagSource(const std::string& path, std::shared_ptr<const CameraModel> camera, const RecordingTopics& topics)
    : path_(path), camera_(std::move(camera)), broken_(path) {
  open();
  try {
    chooseTopics(topics);
    pairImages();
    if (!camera_) readCamera();
    const auto first = image(rgb_messages_[pairs_.front().rgb]);
    ground_truth_ = readPoseMessages();
    if (ground_truth_.empty()) ground_truth_ = readTfChain(bag_, kTumWorldFrame, first->header.frame_id);
  } catch (const Error&) {
    throw;
  } catch (const std::exception& error) {  // rosbag, and the deserialiser of a damaged message
    throw FileError("bag '" + path_ + "' is damaged: " + error.what());
  }
}

void BagSource::open() {
  if (!std::filesystem::exists(path_)) throw FileError("bag '" + path_ + "' does not exist");
  requireRegularFile("bag", path_);
  checkBagRecords(path_);
  try {
    bag_.open(path_, rosbag::bagmode::Read);
  } catch (const rosbag::BagUnindexedException&) {
    throw FileError("bag '" + path_ + "' has no index: the recording was cut off; `rosbag reindex` may mend it");
  } catch (const std::exception& error) {
    throw FileError("bag '" + path_ + "' is truncated or no bag: " + error.what());
  }
}

void BagSource::chooseTopics(const RecordingTopics& wanted) {
  rosbag::View view(bag_);
  const auto connections = view.getConnections();
  std::set<std::string> present;
  for (const auto* connection : connections) present.insert(connection->topic);
  for (RecordingTopics topics : knownTopics()) {
    if (!wanted.colour.empty()) topics.colour = wanted.colour;
    if (!wanted.depth.empty()) topics.depth = wanted.depth;
    if (!wanted.camera_info.empty()) topics.camera_info = wanted.camera_info;
    if (present.count(topics.colour) != 0 && present.count(topics.depth) != 0) {
      topics_ = topics;
      return;
    }
  }
  const std::string asked = wanted.colour.empty() && wanted.depth.empty()
                                ? "no known pair of colour and depth topics"
                                : "no topics '" + wanted.colour + "' and '" + wanted.depth + "'";
  throw FileError("bag '" + path_ + "' has " + asked + "; its image topics: " + imageTopics(connections));
}

BagSource::StampedMessages BagSource::readStamps(const std::string& topic) const {
  StampedMessages out;
  std::vector<std::uint8_t> buffer;
  const std::size_t left_out = forEachMessage(bag_, {topic}, [&](const rosbag::MessageInstance& message) {
    if (!message.isType<sensor_msgs::Image>()) {
      throw FileError("topic '" + topic + "' holds " + message.getDataType() +
                      ", must be sensor_msgs/Image (compressed images: image_transport republish first)");
    }
    const Stamp stamp = headerStamp(message, buffer);
    out.messages.push_back(message);
    out.stamps.push_back(stamp);
  });
  if (left_out > 0) {
    logWarning("bag '" + path_ + "' is damaged: " + std::to_string(left_out) + " of " +
               std::to_string(left_out + out.stamps.size()) + " images of '" + topic + "' cannot be read");
  }
  return out;
}

/// True poses of a recording that keeps them off /tf; empty if it has none.
std::vector<TimedPose> BagSource::readPoseMessages() const {
  std::vector<TimedPose> poses;
  forEachMessage(bag_, {kPoseTopic}, [&](const rosbag::MessageInstance& message) {
    const auto pose = message.instantiate<geometry_msgs::PoseStamped>();
    if (pose) poses.push_back({fromRos(pose->header.stamp), fromRos(pose->pose)});
  });
  std::stable_sort(poses.begin(), poses.end(),
                   [](const TimedPose& a, const TimedPose& b) { return a.stamp < b.stamp; });
  return poses;
}

void BagSource::pairImages() {
  StampedMessages rgb = readStamps(topics_.colour), depth = readStamps(topics_.depth);
  for (const auto& [i, j] : associateStamps(rgb.stamps, depth.stamps, kAssociationGapS)) {
    pairs_.push_back({rgb.stamps[i], i, j});
  }
  if (pairs_.empty()) {
    throw FileError("bag '" + path_ + "': none of the " + std::to_string(rgb.stamps.size()) + " images of '" +
                    topics_.colour + "' has one of '" + topics_.depth + "' within 0.02 s");
  }
  if (pairs_.size() < rgb.stamps.size()) {
    logInfo("bag '" + path_ + "': " + std::to_string(rgb.stamps.size() - pairs_.size()) + " of " +
            std::to_string(rgb.stamps.size()) + " colour images have no depth image within 0.02 s and are left out");
  }
  std::stable_sort(pairs_.begin(), pairs_.end(),
                   [](const Pair& a, const Pair& b) { return a.rgb_stamp < b.rgb_stamp; });
  rgb_messages_ = std::move(rgb.messages);  // moved, as a MessageInstance cannot be assigned
  depth_messages_ = std::move(depth.messages);
  const StampedMessages masks = readStamps(kMaskTopic);
  for (std::size_t i = 0; i < masks.stamps.size(); ++i) mask_messages_.emplace(masks.stamps[i], masks.messages[i]);
}

void BagSource::readCamera() {
  forEachMessage(bag_, {topics_.camera_info}, [&](const rosbag::MessageInstance& message) {
    const auto info = camera_ ? nullptr : message.instantiate<sensor_msgs::CameraInfo>();
    if (!info) return;
    try {
      const CameraIntrinsics intrinsics = fromRos(*info, topics_.rectified());
      if (isUncalibratedDefault(intrinsics)) {
        logWarning("'" + topics_.camera_info +
                   "' holds the driver's default of an uncalibrated camera (525 px); give " +
                   "the camera's own file, for TUM's bags cfg/cameras/tum_fr*.yaml");
      }
      camera_ = std::make_shared<CameraModel>(intrinsics);
    } catch (const Error& error) {
      throw FileError("bag '" + path_ + "', '" + topics_.camera_info + "': " + error.what());
    }
  });
  if (!camera_) {
    throw FileError("bag '" + path_ + "' has no camera_info on '" + topics_.camera_info + "'; give a camera file");
  }
}

std::optional<RgbdFrame> BagSource::next() {
  while (next_ < pairs_.size()) {
    try {
      RgbdFrame frame = read(next_++);
      broken_.countGood();
      return frame;
    } catch (const FileError& error) {
      broken_.countUnreadable(error.what());
    } catch (const Error& error) {
      broken_.countMisfit("bag '" + path_ + "', frame " + std::to_string(next_ - 1) + ": " + error.what());
    } catch (const std::exception& error) {  // rosbag and the deserialiser
      broken_.countUnreadable("bag '" + path_ + "', frame " + std::to_string(next_ - 1) + ": " + error.what());
    }
  }
  broken_.countEnd();
  return std::nullopt;
}

RgbdFrame BagSource::read(std::size_t index) const {
  const Pair& pair = pairs_[index];
  const sensor_msgs::ImageConstPtr depth = image(depth_messages_[pair.depth]);
  const cv::Mat colour = colourFromRos(image(rgb_messages_[pair.rgb]));
  return makeRgbdFrame(index, pair.rgb_stamp, colour, depthFromRos(depth), kMetresPerMillimetre, camera_);
}

cv::Mat1b BagSource::groundTruthMask() const {
  if (next_ == 0 || next_ > pairs_.size()) return {};
  const auto found = mask_messages_.find(pairs_[next_ - 1].rgb_stamp);
  if (found == mask_messages_.end()) return {};
  try {
    return maskFromRos(image(found->second));
  } catch (const std::exception& error) {
    logWarning("bag '" + path_ + "', mask of frame " + std::to_string(next_ - 1) + ": " + error.what());
    return {};
  }
}

}  // namespace semantic_vslam
