// SPDX-FileCopyrightText: 2026 The semantic_vslam authors
// SPDX-License-Identifier: BSD-3-Clause
#include "ros/recording_topics.h"

namespace semantic_vslam {

const std::vector<RecordingTopics>& knownTopics() {
  static const std::vector<RecordingTopics> topics = {
      kTumTopics,
      // realsense2_camera with align_depth:=true
      {"/camera/color/image_raw", "/camera/aligned_depth_to_color/image_raw", "/camera/color/camera_info"},
      // freenect_launch and openni_launch, depth registered by the device or by software
      {"/camera/rgb/image_rect_color", "/camera/depth_registered/hw_registered/image_rect", "/camera/rgb/camera_info"},
      {"/camera/rgb/image_rect_color", "/camera/depth_registered/sw_registered/image_rect", "/camera/rgb/camera_info"},
      {"/camera/rgb/image_rect_color", "/camera/depth_registered/image_raw", "/camera/rgb/camera_info"},
      {"/camera/rgb/image_rect_color", "/camera/depth_registered/image", "/camera/rgb/camera_info"},
      // what our nodelets take in
      {"/rgb/image_rect_color", "/depth_registered/image_rect", "/rgb/camera_info"},
  };
  return topics;
}

}  // namespace semantic_vslam
