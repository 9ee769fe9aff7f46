// SPDX-FileCopyrightText: 2026 The semantic_vslam authors
// SPDX-License-Identifier: BSD-3-Clause
#include <semantic_vslam/KeyframePoseArray.h>
#include <semantic_vslam/KeyframeStamped.h>
#include <semantic_vslam/LabelInfo.h>
#include <std_msgs/UInt32.h>
#include <unistd.h>

#include <memory>
#include <optional>
#include <pluginlib/class_list_macros.hpp>
#include <string>

#include "core/dense/dense_map_file.h"
#include "core/runtime/dense_runner.h"
#include "ros/conversions.h"
#include "ros/map_publisher.h"
#include "ros/motion_input.h"
#include "ros/parameters.h"
#include "ros/recovery.h"
#include "ros/stage_nodelet.h"
#include "semantic_vslam/core/common/error.h"

namespace semantic_vslam {

constexpr const char* kDenseFile = "/map.dense";

struct MappingNodeletConfig {
  std::string map_frame = "map";
  std::string output_directory = ".";
  std::string map;
  double budget_ms = 300.0;
  double publish_period_s = 1.0;
  KeyframeInputsConfig inputs;
  KeptInputConfig frames;
  RemovalConfig removal;
  DenseConfig dense;
  MapObjectsConfig objects;

  template <class Visitor>
  void visit(Visitor& v) {
    v.text("map_frame", map_frame, "frame_id of the maps");
    v.text("output_directory", output_directory,
           "where ~save writes cloud.pcd, map.ot, mesh.ply and map.dense, of which the last is read when tracking "
           "loads the map it "
           "belongs to");
    v.text("map", map, "folder with a saved map that tracking loads at the start, see its ~map");
    v.field("budget_ms", budget_ms, 1.0, 10000.0, "ms a keyframe may take before the diagnostics warn");
    v.field("publish_period_s", publish_period_s, 0.1, 60.0, "s between publications of a map that changes");
    inputs.visit(v);
    frames.visit(v);
    v.group("removal", removal);
    v.group("dense", dense);
    v.group("depth_noise", dense.keyframe.depth_noise);
    v.group("objects", objects);
  }
};

/// Images and poses of keyframes, motion masks and labels -> mapping/{semantic_cloud, octomap_binary, octomap_full,
/// projected_map, objects, object_markers}, and mapping/removed when watched. The maps follow tracking/keyframe_poses.
class MappingTopics {
 public:
  explicit MappingTopics(const NodeletHandles& node);
  ~MappingTopics() { runner_.close(); }  // nobody waits for anything any more, nor does who waits for the runner

 private:
  DenseRunner::Hooks hooks();
  void publishRemoved(const KeyframeInput& input, const cv::Mat1b& removed);
  std::optional<DenseMapContent> saved(std::uint32_t map_id) const;
  void save(DenseStage& stage) const;
  void describe(StageDiagnostics::Status& status);

  const MappingNodeletConfig config_;
  const std::string output_;
  Recovery recovery_;  // of the runner's thread, but while it is made
  const Published motion_runs_, network_runs_;
  MapPublisher publisher_;
  ros::Publisher removed_;
  StageDiagnostics diagnostics_;
  DenseRunner runner_;
  NodeInputs inputs_;
};

MappingTopics::MappingTopics(const NodeletHandles& node)
    : config_(loadParameters<MappingNodeletConfig>(node.private_nh)),
      output_(outputFolder(config_.output_directory)),
      recovery_(node.private_nh, "map.dense"),
      motion_runs_(node.nh, "motion/mask"),
      network_runs_(node.nh, "segmentation/labels"),
      publisher_(node.nh, config_.map_frame, config_.objects),
      removed_(node.nh.advertise<sensor_msgs::Image>("mapping/removed", 5)),
      diagnostics_(node, "mapping", config_.budget_ms),
      runner_(DenseStage(config_.dense, config_.removal, [this](std::uint32_t map_id) { return saved(map_id); }),
              config_.inputs, config_.frames.kept_frames, hooks()),
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
    runner_.run([this](DenseStage& stage) { save(stage); });
    return "cloud.pcd, map.ot, mesh.ply and map.dense saved in " + output_;
  });
  // With the sparse map, so that both can be loaded as one.
  inputs_.waitingTopic<std_msgs::UInt32>("tracking/map_saved", 1, [this](const auto&) {
    runner_.run([this](DenseStage& stage) {
      if (stage.map().keyframes() > 0) stage.save(output_ + kDenseFile);
    });
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
  inputs_.images(config_.frames.input, [this](PendingFrame frame) { runner_.offer(std::move(frame)); });
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
            recovery_.keep(stage.changes() + stage.map().keyframes(), [&](const std::string& path) {
              if (stage.map().keyframes() > 0) stage.save(path);
            });
          }};
}

/// As it was saved with the sparse map, or left by this node when it was killed.
std::optional<DenseMapContent> MappingTopics::saved(std::uint32_t map_id) const {
  const std::string loaded = config_.map.empty() ? "" : config_.map + kDenseFile;
  for (const std::string& path : {recovery_.left().value_or(""), loaded, output_ + kDenseFile}) {
    if (path.empty() || access(path.c_str(), F_OK) != 0) continue;
    try {
      DenseMapContent content = readDenseMap(path);
      if (content.map_id == map_id) return content;
    } catch (const FileError& error) {
      ROS_ERROR("%s; going on without it", error.what());
    }
  }
  return std::nullopt;
}

/// What a keyframe's map leaves out, for who wants to look.
void MappingTopics::publishRemoved(const KeyframeInput& input, const cv::Mat1b& removed) {
  if (removed_.getNumSubscribers() == 0) return;
  const cv::Mat1b nothing = cv::Mat1b::zeros(input.frame.gray.size());
  removed_.publish(toRos(headerOf(input.frame), "mono8", removed.empty() ? nothing : removed));
}

void MappingTopics::save(DenseStage& stage) const {
  stage.map().finish();
  stage.save(output_ + kDenseFile);
  stage.map().saveCloud(output_ + "/cloud.pcd");
  stage.map().saveOctomap(output_ + "/map.ot");
  stage.map().saveMesh(output_ + "/mesh.ply");
}

void MappingTopics::describe(StageDiagnostics::Status& status) {
  const KeyframeInputs::Counts counts = runner_.counts();
  diagnostics_.addFault(status, "keyframes without images", counts.without_images);
  status.add("keyframes without mask", counts.without_mask);
  status.add("keyframes left out for want of labels", counts.unlabelled);
  publisher_.report(status);
  if (runner_.waiting() > DenseRunner::kQueue / 2) {
    status.mergeSummaryf(diagnostic_msgs::DiagnosticStatus::WARN, "%zu keyframes wait to be mapped", runner_.waiting());
  }
}

using MappingNodelet = StageNodelet<MappingTopics>;

}  // namespace semantic_vslam

PLUGINLIB_EXPORT_CLASS(semantic_vslam::MappingNodelet, nodelet::Nodelet)
