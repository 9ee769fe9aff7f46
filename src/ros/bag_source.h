// SPDX-FileCopyrightText: 2026 The semantic_vslam authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <rosbag/bag.h>
#include <rosbag/message_instance.h>

#include <map>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "core/io/broken_frames.h"
#include "core/io/frame_source.h"
#include "ros/recording_topics.h"

namespace semantic_vslam {

/// Reads a ROS 1 bag frame by frame; needs no master. Colour (rgb8, bgr8, rgba8, bgra8, mono8) and registered depth
/// (32FC1 metres, 16UC1 millimetres) are paired by their header stamps as in a TUM folder. Ground truth comes from
/// kPoseTopic, else from the tf chain from `world` to the colour image's frame; true masks come from kMaskTopic.
class BagSource : public FrameSource {
 public:
  /// @param camera  null: from the bag's camera_info
  /// @throws FileError, in one line: the bag is missing, truncated or not indexed; it has no such topics; no colour
  ///         image has a depth image; there is neither camera nor camera_info.
  BagSource(const std::string& path, std::shared_ptr<const CameraModel> camera, const RecordingTopics& topics = {});

  std::optional<RgbdFrame> next() override;
  void skip(std::size_t count) override { next_ += count; }
  std::size_t size() const override { return pairs_.size(); }
  std::size_t skippedBroken() const override { return broken_.count(); }
  std::shared_ptr<const CameraModel> camera() const override { return camera_; }
  const std::vector<TimedPose>& groundTruth() const override { return ground_truth_; }
  cv::Mat1b groundTruthMask() const override;

  const RecordingTopics& topics() const { return topics_; }

 private:
  struct Pair {
    Stamp rgb_stamp;
    std::size_t rgb, depth;  // indices into the messages
  };

  struct StampedMessages {
    std::vector<rosbag::MessageInstance> messages;
    std::vector<Stamp> stamps;
  };

  void open();
  StampedMessages readStamps(const std::string& topic) const;
  void chooseTopics(const RecordingTopics& wanted);
  void pairImages();
  void readCamera();
  std::vector<TimedPose> readPoseMessages() const;
  RgbdFrame read(std::size_t index) const;

  std::string path_;
  rosbag::Bag bag_;
  RecordingTopics topics_;
  std::vector<rosbag::MessageInstance> rgb_messages_, depth_messages_;
  std::map<Stamp, rosbag::MessageInstance> mask_messages_;
  std::vector<Pair> pairs_;  // in order of the colour stamp
  std::shared_ptr<const CameraModel> camera_;
  std::vector<TimedPose> ground_truth_;
  BrokenFrames broken_;
  std::size_t next_ = 0;
};

/// The tf chain from one frame up to another, sampled whenever its most frequent edge was sent.
/// @param root, leaf  frame names, with or without a leading slash
/// @return T_root_leaf over time; empty if the bag has no such chain.
/// Messages in damaged chunks are left out.
std::vector<TimedPose> readTfChain(const rosbag::Bag& bag, const std::string& root, const std::string& leaf);

}  // namespace semantic_vslam
