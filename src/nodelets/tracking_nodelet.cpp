// SPDX-FileCopyrightText: 2026 The semantic_vslam authors
// SPDX-License-Identifier: BSD-3-Clause
#include <std_msgs/Header.h>

#include <atomic>
#include <memory>
#include <optional>
#include <pluginlib/class_list_macros.hpp>
#include <string>
#include <utility>

#include "core/runtime/tracking_runner.h"
#include "ros/conversions.h"
#include "ros/motion_input.h"
#include "ros/node_configs.h"
#include "ros/parameters.h"
#include "ros/sparse_map_files.h"
#include "ros/stage_nodelet.h"
#include "ros/tracking_publisher.h"
#include "semantic_vslam/core/common/error.h"

namespace semantic_vslam {

/// Images and motion masks -> pose on tf and tracking/{odometry, pose, path, state, keyframe, keyframe_poses, points},
/// and tracking/labels_wanted while the start waits for labels. Owner of the sparse map.
class TrackingTopics {
 public:
  explicit TrackingTopics(const NodeletHandles& node);

 private:
  TrackingRunner::Hooks hooks();
  Running running();
  void offerServices();
  PendingFrame withBody(PendingFrame frame);
  void describe(StageDiagnostics::Status& status);

  const TrackingNodeConfig config_;
  // Ids of an earlier run of this node must not pass for ours with whoever kept its keyframes.
  const std::uint32_t first_map_id_ = ros::WallTime::now().sec;
  const Published motion_runs_, network_runs_;
  std::atomic<bool> paused_{false}, network_seen_{false}, nobody_labels_{false};
  TrackingPublisher publisher_;
  ros::Publisher labels_wanted_;
  StageDiagnostics diagnostics_;
  TrackingRunner runner_;
  SparseMapFiles files_;
  NodeInputs inputs_;
};

TrackingTopics::TrackingTopics(const NodeletHandles& node)
    : config_(loadParameters<TrackingNodeConfig>(node.private_nh)),
      motion_runs_(node.nh, "motion/mask"),
      network_runs_(node.nh, "segmentation/labels"),
      publisher_(node.nh, config_.frames, config_.initial_pose, config_.people, config_.path_period_s, first_map_id_),
      labels_wanted_(node.nh.advertise<std_msgs::Header>("tracking/labels_wanted", 1)),
      diagnostics_(node, "tracking", config_.budget_ms),
      runner_(TrackingStage(config_.slam, config_.waits, config_.removal, first_map_id_), config_.waits,
              config_.input.queue_size, hooks()),
      files_(node, config_.folders.output_directory, runner_, publisher_),
      inputs_(node) {
  files_.begin(config_.folders.map, config_.localization_only);
  offerServices();
  publisher_.tellIdle(false);
  inputs_.every(0.5, [this] { publisher_.tellIdle(paused_); });
  inputs_.everyWaiting(1.0, [this] { files_.keepForRecovery(); });
  takeMotion(inputs_, [this](Stamp stamp, const MotionResult& motion) { runner_.take(stamp, motion); });
  inputs_.topic<sensor_msgs::Image>("segmentation/labels", 2,
                                    [this](const auto& labels) { runner_.take(labelsFromRos(labels)); });
  inputs_.topic<LabelInfo>("segmentation/label_info", 1, [this](const auto& info) {
    nobody_labels_ = info->classes.size() <= 1;  // the background
    runner_.take(fromRos(*info));
  });
  inputs_.images(config_.input, [this](PendingFrame frame) {
    if (!paused_) runner_.push(withBody(std::move(frame)));
  });
  inputs_.report(
      diagnostics_, [this] { return runner_.counters(); }, [this](auto& status) { describe(status); });
}

TrackingRunner::Hooks TrackingTopics::hooks() {
  return {[this] { return running(); },
          [this](const TrackingInput& input, const TrackingOutput& output, StepTime time) {
            if (!network_seen_) nobody_labels_ = true;  // it has waited once; label_info takes it back
            publisher_.publish(input, output, time);
            diagnostics_.record(input.frame.stamp, time);
          },
          [this](const std::shared_ptr<const MapSnapshot>& map) { publisher_.publishMap(*map); },
          [this](Stamp stamp) {
            std_msgs::Header image;
            image.stamp = toRos(stamp);
            labels_wanted_.publish(image);
          },
          [this](Stamp stamp) { return publisher_.wishes(stamp); }};
}

/// A network that was there and is gone has broken down; one that nothing was heard of yet may still be loading.
Running TrackingTopics::running() {
  const bool network = network_runs_();
  if (network) network_seen_ = true;
  return {motion_runs_(), network || (!network_seen_ && !nobody_labels_)};
}

PendingFrame TrackingTopics::withBody(PendingFrame frame) {
  frame.decode = [this, decode = std::move(frame.decode)]() -> std::optional<RgbdFrame> {
    std::optional<RgbdFrame> decoded = paused_ ? std::nullopt : decode();
    if (decoded && !publisher_.locateBody(*decoded)) return std::nullopt;  // counted; the next frame may know
    return decoded;
  };
  return frame;
}

void TrackingTopics::offerServices() {
  inputs_.trigger("reset", [this] {
    if (runner_.localizationOnly()) {
      throw Error("localization_only is on, in which no map is made or dropped; call it with false first");
    }
    runner_.change([](TrackingStage& stage) { stage.reset(); });
    files_.forget();
    return std::string("map and trajectory are dropped; the next frames begin a new map");
  });
  inputs_.trigger("save_map", [this] { return files_.saveMap(); });
  inputs_.trigger("load_map", [this] { return files_.loadMap(); });
  inputs_.trigger("save_trajectory", [this] { return files_.saveTrajectory(); });
  inputs_.onOff("pause", [this](bool on) {
    paused_ = on;
    publisher_.tellIdle(on);
    return std::string(on ? "paused: images are passed over until pause is called with false; the map stays"
                          : "running: the next images are tracked");
  });
  inputs_.onOff("localization_only", [this](bool on) { return files_.localizeOnly(on); });
}

void TrackingTopics::describe(StageDiagnostics::Status& status) {
  const TrackingRunner::Counts counts = runner_.counts();
  publisher_.report(diagnostics_, status);
  if (paused_ && status.level == diagnostic_msgs::DiagnosticStatus::OK) status.message = "paused";
  status.add("paused", paused_.load());
  status.add("localisation only", runner_.localizationOnly());
  status.add("frames without mask", counts.without_mask);
  diagnostics_.addFault(status, "frames skipped as motion did", counts.skipped_with_motion);
  diagnostics_.addFault(status, "frames that waited for labels", counts.waited_for_labels);
  diagnostics_.addFault(status, "frames out of order by their stamps", counts.out_of_order);
  for (const StageSummary& stage : runner_.times().summarize()) {
    status.addf("cpu median of " + stage.stage, "%.1f ms", stage.cpu.median_ms);
  }
  runner_.times().clear();
}

using TrackingNodelet = StageNodelet<TrackingTopics>;

}  // namespace semantic_vslam

PLUGINLIB_EXPORT_CLASS(semantic_vslam::TrackingNodelet, nodelet::Nodelet)
