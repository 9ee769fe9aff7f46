// SPDX-FileCopyrightText: 2026 The semantic_vslam authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string>
#include <vector>

namespace semantic_vslam {

/// The topics of one camera in a bag. An empty name is recognised in the bag.
struct RecordingTopics {
  std::string colour, depth, camera_info;

  /// Rectified images, by their name: P of camera_info holds, else K and D.
  bool rectified() const { return colour.find("image_rect") != std::string::npos; }
};

/// As in the bags of the TUM RGB-D benchmark; what our own bags use, too.
inline const RecordingTopics kTumTopics{"/camera/rgb/image_color", "/camera/depth/image", "/camera/rgb/camera_info"};
inline const std::string kTumDepthInfoTopic = "/camera/depth/camera_info";
/// Frames of the benchmark: `/world` is the motion capture's, `/kinect` the camera's body; the rest is the driver's.
inline const std::string kTumWorldFrame = "/world", kTumOpticalFrame = "/openni_rgb_optical_frame";
/// True mask of what moves, mono8, 255 = moving, with the stamp of the colour image.
inline const std::string kMaskTopic = "/groundtruth/mask";
/// True class indices, mono8, with the stamp of the colour image; rendered recordings have them.
inline const std::string kLabelsTopic = "/groundtruth/labels";
/// True pose of the optical frame, geometry_msgs/PoseStamped: a recording that is played into the nodelets keeps it off
/// /tf, which they write.
inline const std::string kPoseTopic = "/groundtruth/pose";

/// The topics of the benchmark, of the RealSense and of the Kinect drivers, in the order in which they are looked for.
const std::vector<RecordingTopics>& knownTopics();

}  // namespace semantic_vslam
