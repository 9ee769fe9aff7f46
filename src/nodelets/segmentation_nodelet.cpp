// SPDX-FileCopyrightText: 2026 The semantic_vslam authors
// SPDX-License-Identifier: BSD-3-Clause
#include <semantic_vslam/KeyframePoseArray.h>
#include <semantic_vslam/KeyframeStamped.h>
#include <semantic_vslam/LabelInfo.h>
#include <std_msgs/Header.h>

#include <atomic>
#include <pluginlib/class_list_macros.hpp>

#include "core/runtime/label_runner.h"
#include "core/segmentation/label_picture.h"
#include "ros/conversions.h"
#include "ros/node_configs.h"
#include "ros/parameters.h"
#include "ros/stage_nodelet.h"
#include "semantic_vslam/core/common/error.h"

namespace semantic_vslam {

/// Images of keyframes, and of what tracking/labels_wanted names -> segmentation/labels (mono8, index into label_info),
/// segmentation/label_info (latched), segmentation/overlay when watched. Without a network label_info holds the
/// background alone, which says that nobody labels, and no image is taken in.
class SegmentationTopics {
 public:
  explicit SegmentationTopics(const NodeletHandles& node);

 private:
  LabelStage openNetwork();
  void takeImages();
  void publish(const RgbdFrame& frame, const FrameLabels& labels, StepTime time);
  void describe(StageDiagnostics::Status& status);

  const SegmentationNodeConfig config_;
  std::atomic<bool> network_failed_{false};
  ros::Publisher labels_, info_, overlay_;
  StageDiagnostics diagnostics_;
  LabelRunner runner_;
  NodeInputs inputs_;
};

SegmentationTopics::SegmentationTopics(const NodeletHandles& node)
    : config_(loadParameters<SegmentationNodeConfig>(node.private_nh)),
      info_(node.nh.advertise<LabelInfo>("segmentation/label_info", 1, true)),
      diagnostics_(node, "segmentation", config_.budget_ms),
      runner_(
          openNetwork(), config_.images.kept_frames,
          [this](const auto& frame, const auto& labels, StepTime time) { publish(frame, labels, time); },
          [this] {
            network_failed_ = true;
            labels_.shutdown();  // so that nobody waits for labels any more
          }),
      inputs_(node) {
  info_.publish(toRos(runner_.labels()));
  if (runner_.enabled()) {
    labels_ = node.nh.advertise<sensor_msgs::Image>("segmentation/labels", 5);
    overlay_ = node.nh.advertise<sensor_msgs::Image>("segmentation/overlay", 1);
    takeImages();
  } else if (!network_failed_) {
    return;
  }
  inputs_.report(
      diagnostics_, [this] { return runner_.counters(); }, [this](auto& status) { describe(status); });
}

/// A network that does not load costs the labels, not the robot: everything else goes on with motion detection.
LabelStage SegmentationTopics::openNetwork() {
  try {
    return LabelStage(config_.segmentation);
  } catch (const ModelError& error) {
    ROS_ERROR("%s; going on without labels", error.what());
    network_failed_ = true;
    return LabelStage(config_.segmentation, nullptr);
  }
}

void SegmentationTopics::takeImages() {
  inputs_.topic<KeyframeStamped>("tracking/keyframe", 10,
                                 [this](const auto& keyframe) { runner_.ask(fromRos(keyframe->header.stamp)); });
  inputs_.topic<std_msgs::Header>("tracking/labels_wanted", 1,
                                  [this](const auto& image) { runner_.ask(fromRos(image->stamp)); });
  inputs_.topic<KeyframePoseArray>("tracking/keyframe_poses", 1,
                                   [this](const auto& map) { runner_.take(fromRos(*map)); });
  inputs_.images(config_.images.input, [this](PendingFrame frame) { runner_.offer(std::move(frame)); });
}

void SegmentationTopics::publish(const RgbdFrame& frame, const FrameLabels& labels, StepTime time) {
  const std_msgs::Header header = headerOf(frame);
  labels_.publish(toRos(header, "mono8", labels.labels));
  if (overlay_.getNumSubscribers() > 0) {
    overlay_.publish(toRos(header, "bgr8", drawLabels(frame.bgr, labels.labels, runner_.labels())));
  }
  diagnostics_.record(frame.stamp, time);
}

void SegmentationTopics::describe(StageDiagnostics::Status& status) {
  if (network_failed_) {
    status.mergeSummary(diagnostic_msgs::DiagnosticStatus::ERROR, "the network failed: there are no labels");
  }
  diagnostics_.addFault(status, "keyframes without images", runner_.withoutImages());
}

using SegmentationNodelet = StageNodelet<SegmentationTopics>;

}  // namespace semantic_vslam

PLUGINLIB_EXPORT_CLASS(semantic_vslam::SegmentationNodelet, nodelet::Nodelet)
