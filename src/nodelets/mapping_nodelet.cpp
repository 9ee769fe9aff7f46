// SPDX-FileCopyrightText: 2026 The semantic_vslam authors
// SPDX-License-Identifier: BSD-3-Clause
#include <semantic_vslam/KeyframePoseArray.h>
#include <semantic_vslam/KeyframeStamped.h>
#include <semantic_vslam/LabelInfo.h>

#include <atomic>
#include <memory>
#include <optional>
#include <pluginlib/class_list_macros.hpp>
#include <string>
#include <utility>
#include <vector>

#include "core/runtime/dense_runner.h"
#include "ros/conversions.h"
#include "ros/map_publisher.h"
#include "ros/motion_input.h"
#include "ros/parameters.h"
#include "ros/rgbd_converter.h"
#include "ros/rgbd_subscriber.h"
#include "ros/services.h"
#include "ros/stage_nodelet.h"
#include "semantic_vslam/core/common/error.h"

namespace semantic_vslam {

struct MappingNodeletConfig {
  std::string map_frame = "map";
  std::string output_directory = ".";
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
    v.text("output_directory", output_directory, "where ~save writes cloud.pcd and map.ot");
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
/// projected_map, objects}, and mapping/removed when watched. The maps follow tracking/keyframe_poses.
class MappingNodelet final : public StageNodelet {
 public:
  ~MappingNodelet() override { stop(); }

 private:
  void start() override;
  void stop() override;
  void run(ros::NodeHandle nh);
  void subscribe(ros::NodeHandle nh, ros::NodeHandle private_nh);
  void advertiseServices(ros::NodeHandle private_nh);
  void report(StageDiagnostics::Status& status);
  void publish(DenseStage& stage);
  void publishRemoved(const KeyframeInput& input, const cv::Mat1b& removed);
  void save(DenseStage& stage) const;

  MappingNodeletConfig config_;
  std::optional<MapPublisher> publisher_;   // runner only
  std::optional<RgbdConverter> converter_;  // runner only
  std_msgs::Header header_;                 // runner only; of the image in work
  std::size_t published_ = 0;               // runner only; DenseStage::changes() then
  ros::SteadyTime next_publication_;        // runner only; not before
  std::atomic<bool> publication_due_{false};
  std::atomic<double> publication_s_{0.0};  // what the last one took
  std::atomic<std::size_t> keyframes_{0}, voxels_{0}, unplaced_{0};
  ros::Publisher removed_publisher_;
  std::unique_ptr<StageDiagnostics> diagnostics_;
  std::unique_ptr<DenseRunner> runner_;
  // Last, so that callbacks stop before what they use is gone.
  std::vector<ros::Subscriber> subscribers_;
  ros::Subscriber labels_;
  std::unique_ptr<MotionInput> motion_;
  std::unique_ptr<RgbdSubscriber> input_;
  Services services_;
  ros::SteadyTimer publish_timer_;
};

void MappingNodelet::start() {
  ros::NodeHandle nh = getNodeHandle(), private_nh = getPrivateNodeHandle();
  config_ = loadParameters<MappingNodeletConfig>(private_nh);
  if (!config_.dense.enabled) {
    NODELET_INFO("dense.enabled is false: no dense map is made");
    return;
  }
  diagnostics_ = std::make_unique<StageDiagnostics>(nh, private_nh, getName(), "mapping", config_.budget_ms);
  publisher_.emplace(nh, config_.map_frame, config_.objects);
  converter_.emplace(config_.frames.input);
  removed_publisher_ = nh.advertise<sensor_msgs::Image>("mapping/removed", 5);
  run(nh);
  // Services wait for the worker: they get threads of their own, so that images still come in meanwhile.
  advertiseServices(getMTPrivateNodeHandle());
  subscribe(nh, private_nh);
  diagnostics_->start(nh, {[this] { return input_->missing(); }, [this] { return runner_->counters(); },
                           [this](StageDiagnostics::Status& status) { report(status); }});
}

void MappingNodelet::run(ros::NodeHandle nh) {
  const auto running = [this] { return Running{motion_ && motion_->runs(), labels_.getNumPublishers() > 0}; };
  runner_ = std::make_unique<DenseRunner>(
      DenseStage(config_.dense, config_.removal), config_.inputs, config_.frames.kept_frames,
      DenseRunner::Hooks{running,
                         [this](const KeyframeInput& input, const cv::Mat1b& removed, StepTime time) {
                           diagnostics_->record(input.keyframe.stamp, time);
                           publishRemoved(input, removed);
                         },
                         [this](DenseStage& stage) { publish(stage); }});
  publish_timer_ = nh.createSteadyTimer(ros::WallDuration(config_.publish_period_s), [this](const auto&) {
    publication_due_ = true;
    runner_->wake();
  });
}

void MappingNodelet::subscribe(ros::NodeHandle nh, ros::NodeHandle private_nh) {
  motion_ = std::make_unique<MotionInput>(
      nh, [this](Stamp stamp, const MotionResult& motion) { runner_->take(stamp, motion); });
  labels_ = nh.subscribe<sensor_msgs::Image>(
      "segmentation/labels", 5, labelsFromRos([this](const FrameLabels& labels) { runner_->take(labels); }));
  subscribers_.push_back(nh.subscribe<LabelInfo>(
      "segmentation/label_info", 1, [this](const LabelInfoConstPtr& info) { runner_->take(fromRos(*info)); }));
  subscribers_.push_back(
      nh.subscribe<KeyframePoseArray>("tracking/keyframe_poses", 1, [this](const KeyframePoseArrayConstPtr& map) {
        runner_->take(std::make_shared<const MapSnapshot>(fromRos(*map)));
      }));
  // When the worker is far behind keyframes block, but not the thread that takes the images in.
  subscribers_.push_back(getMTNodeHandle().subscribe<KeyframeStamped>(
      "tracking/keyframe", 50,
      [this](const KeyframeStampedConstPtr& keyframe) { runner_->name(noticeFromRos(*keyframe)); }));
  input_ = std::make_unique<RgbdSubscriber>(nh, private_nh, config_.frames.input, [this](const RgbdMessages& messages) {
    runner_->offer(converter_->pending(messages, header_));
  });
}

void MappingNodelet::advertiseServices(ros::NodeHandle private_nh) {
  services_.addTrigger(private_nh, "clear", [this] {
    runner_->run([](DenseStage& stage) { stage.clear(); });
    return std::string("the dense map is empty");
  });
  services_.addTrigger(private_nh, "save", [this] {
    runner_->run([this](DenseStage& stage) { save(stage); });
    return "cloud.pcd and map.ot saved in " + config_.output_directory;
  });
}

void MappingNodelet::stop() {
  if (diagnostics_) diagnostics_->stop();
  if (runner_) runner_->close();  // nobody waits for anything any more, nor does who waits for the runner
  input_.reset();
  if (motion_) motion_->shutdown();
  labels_.shutdown();
  subscribers_.clear();
  services_.shutdown();
  publish_timer_.stop();
  runner_.reset();
  motion_.reset();  // which the runner asks
  diagnostics_.reset();
  publisher_.reset();
  removed_publisher_.shutdown();
}

void MappingNodelet::report(StageDiagnostics::Status& status) {
  const KeyframeInputs::Counts counts = runner_->counts();
  diagnostics_->addFault(status, "frames refused", converter_->refused());
  diagnostics_->addFault(status, "keyframes without images", counts.without_images);
  status.add("keyframes without mask", counts.without_mask);
  status.add("keyframes left out for want of labels", counts.unlabelled);
  status.add("keyframes in the map", keyframes_.load());
  status.add("keyframes whose place is not known yet", unplaced_.load());
  status.add("voxels", voxels_.load());
  status.addf("last publication", "%.2f s", publication_s_.load());
  if (runner_->waiting() > DenseRunner::kQueue / 2) {
    status.mergeSummaryf(diagnostic_msgs::DiagnosticStatus::WARN, "%zu keyframes wait to be mapped",
                         runner_->waiting());
  }
}

/// A large map takes seconds to publish: three quarters of the time are left to the keyframes that wait.
void MappingNodelet::publish(DenseStage& stage) {
  constexpr int kRestPerWork = 3;
  unplaced_ = stage.waiting();
  const ros::SteadyTime begin = ros::SteadyTime::now();
  if (begin < next_publication_ || !publication_due_.exchange(false)) return;
  stage.map().work();
  // During a rebuild the old map is served.
  if (std::exchange(published_, stage.changes()) != stage.changes()) publisher_->markChanged();
  keyframes_ = stage.map().keyframes();
  voxels_ = stage.map().voxels();
  publisher_->publish(stage.map(), stage.labels());
  const ros::WallDuration taken = ros::SteadyTime::now() - begin;
  publication_s_ = taken.toSec();
  next_publication_ = ros::SteadyTime::now() + taken * kRestPerWork;
}

/// What a keyframe's map leaves out, for who wants to look.
void MappingNodelet::publishRemoved(const KeyframeInput& input, const cv::Mat1b& removed) {
  if (removed_publisher_.getNumSubscribers() == 0) return;
  const cv::Mat1b nothing = cv::Mat1b::zeros(input.frame.gray.size());
  removed_publisher_.publish(toRos(header_, "mono8", removed.empty() ? nothing : removed));
}

void MappingNodelet::save(DenseStage& stage) const {
  if (stage.map().keyframes() == 0) {
    throw Error("the dense map is empty; the files in " + config_.output_directory + " are not touched");
  }
  stage.map().finish();
  stage.map().saveCloud(config_.output_directory + "/cloud.pcd");
  stage.map().saveOctomap(config_.output_directory + "/map.ot");
}

}  // namespace semantic_vslam

PLUGINLIB_EXPORT_CLASS(semantic_vslam::MappingNodelet, nodelet::Nodelet)
