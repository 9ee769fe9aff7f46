// SPDX-FileCopyrightText: 2026 The semantic_vslam authors
// SPDX-License-Identifier: BSD-3-Clause
#include <semantic_vslam/KeyframePoseArray.h>
#include <semantic_vslam/KeyframeStamped.h>
#include <semantic_vslam/LabelInfo.h>
#include <std_msgs/UInt32.h>

#include <memory>
#include <pluginlib/class_list_macros.hpp>
#include <string>

#include "core/runtime/dense_runner.h"
#include "ros/conversions.h"
#include "ros/dense_map_files.h"
#include "ros/map_publisher.h"
#include "ros/map_services.h"
#include "ros/motion_input.h"
#include "ros/node_configs.h"
#include "ros/parameters.h"
#include "ros/stage_nodelet.h"

namespace semantic_vslam {

/// Images and poses of keyframes, motion masks and labels -> mapping/{semantic_cloud, octomap_binary, octomap_full,
/// projected_map, objects, object_markers}, and mapping/removed when watched. The maps follow tracking/keyframe_poses.
class MappingTopics {
 public:
  explicit MappingTopics(const NodeletHandles& node);
  ~MappingTopics() { runner_.close(); }  // nobody waits for anything any more, nor does who waits for the runner

 private:
  DenseRunner::Hooks hooks();
  void publishRemoved(const KeyframeInput& input, const cv::Mat1b& removed);
  void describe(StageDiagnostics::Status& status);

  const MappingNodeConfig config_;
  DenseMapFiles files_;
  const Published motion_runs_, network_runs_;
  MapPublisher publisher_;
  ros::Publisher removed_;
  StageDiagnostics diagnostics_;
  DenseRunner runner_;
  NodeInputs inputs_;
};

MappingTopics::MappingTopics(const NodeletHandles& node)
    : config_(loadParameters<MappingNodeConfig>(node.private_nh)),
      files_(node, config_.folders.output_directory, config_.folders.map),
      motion_runs_(node.nh, "motion/mask"),
      network_runs_(node.nh, "segmentation/labels"),
      publisher_(node.nh, config_.frames.map_frame, config_.objects),
      removed_(node.nh.advertise<sensor_msgs::Image>("mapping/removed", 5)),
      diagnostics_(node, "mapping", config_.budget_ms),
      runner_(DenseStage(config_.dense, config_.removal, [this](std::uint32_t map_id) { return files_.find(map_id); }),
              config_.inputs, config_.images.kept_frames, hooks()),
      inputs_(node) {
  if (!config_.dense.enabled) {
    ROS_INFO("dense.enabled is false: no dense map is made");
    return;
  }
  inputs_.every(config_.publish_period_s, [this] {
    publisher_.ask();
    runner_.wake();
  });
  inputs_.trigger("clear", [this] {
    runner_.run([](DenseStage& stage) { stage.clear(); });
    return std::string("the dense map is empty");
  });
  inputs_.trigger("save", [this] {
    std::string done;
    runner_.run([&](DenseStage& stage) { done = files_.save(stage); });
    return done;
  });
  offerMapServices(inputs_, runner_, config_.frames.map_frame);
  // With the sparse map, so that both can be loaded as one.
  inputs_.waitingTopic<std_msgs::UInt32>("tracking/map_saved", 1, [this](const auto&) {
    runner_.run([this](DenseStage& stage) { files_.saveWithSparse(stage); });
  });
  takeMotion(inputs_, [this](Stamp stamp, const MotionResult& motion) { runner_.take(stamp, motion); });
  inputs_.topic<sensor_msgs::Image>("segmentation/labels", 5,
                                    [this](const auto& labels) { runner_.take(labelsFromRos(labels)); });
  inputs_.topic<LabelInfo>("segmentation/label_info", 1, [this](const auto& info) { runner_.take(fromRos(*info)); });
  inputs_.topic<KeyframePoseArray>("tracking/keyframe_poses", 1, [this](const auto& map) {
    runner_.take(std::make_shared<const MapSnapshot>(fromRos(*map)));
  });
  inputs_.topic<TrackingReport>("tracking/state", 10, [this](const auto& report) {
    if (report->beside_keyframe) runner_.take(placeFromRos(*report));
  });
  // When the worker is far behind keyframes wait, but not the thread that takes the images in.
  inputs_.waitingTopic<KeyframeStamped>("tracking/keyframe", 50,
                                        [this](const auto& keyframe) { runner_.name(noticeFromRos(*keyframe)); });
  inputs_.images(config_.images.input, [this](PendingFrame frame) { runner_.offer(std::move(frame)); });
  inputs_.report(
      diagnostics_, [this] { return runner_.counters(); }, [this](auto& status) { describe(status); });
}

DenseRunner::Hooks MappingTopics::hooks() {
  return {[this] {
            return Running{motion_runs_(), network_runs_()};
          },
          [this](const KeyframeInput& input, const cv::Mat1b& removed, StepTime time) {
            diagnostics_.record(input.keyframe.stamp, time);
            publishRemoved(input, removed);
          },
          [this](DenseStage& stage) {
            publisher_.publish(stage);
            files_.keepForRecovery(stage);
          }};
}

/// What a keyframe's map leaves out, for who wants to look.
void MappingTopics::publishRemoved(const KeyframeInput& input, const cv::Mat1b& removed) {
  if (removed_.getNumSubscribers() == 0) return;
  const cv::Mat1b nothing = cv::Mat1b::zeros(input.frame.gray.size());
  removed_.publish(toRos(headerOf(input.frame), "mono8", removed.empty() ? nothing : removed));
}

void MappingTopics::describe(StageDiagnostics::Status& status) {
  const KeyframeInputs::Counts counts = runner_.counts();
  diagnostics_.addFault(status, "keyframes without images", counts.without_images);
  status.add("keyframes without mask", counts.without_mask);
  status.add("keyframes left out for want of labels", counts.unlabelled);
  status.add("keyframes left out since nobody can tell what moves", counts.untold);
  publisher_.report(status);
  if (runner_.waiting() > DenseRunner::kQueue / 2) {
    status.mergeSummaryf(diagnostic_msgs::DiagnosticStatus::WARN, "%zu keyframes wait to be mapped", runner_.waiting());
  }
}

using MappingNodelet = StageNodelet<MappingTopics>;

}  // namespace semantic_vslam

PLUGINLIB_EXPORT_CLASS(semantic_vslam::MappingNodelet, nodelet::Nodelet)
