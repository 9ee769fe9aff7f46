// SPDX-FileCopyrightText: 2026 The semantic_vslam authors
// SPDX-License-Identifier: BSD-3-Clause
#include <std_msgs/Header.h>

#include <atomic>
#include <memory>
#include <optional>
#include <pluginlib/class_list_macros.hpp>
#include <string>
#include <utility>
#include <vector>

#include "core/pipeline/sparse_slam.h"
#include "core/runtime/tracking_runner.h"
#include "ros/conversions.h"
#include "ros/motion_input.h"
#include "ros/parameters.h"
#include "ros/rgbd_converter.h"
#include "ros/rgbd_subscriber.h"
#include "ros/services.h"
#include "ros/stage_nodelet.h"
#include "ros/tracking_publisher.h"
#include "semantic_vslam/core/common/error.h"
#include "semantic_vslam/core/io/trajectory.h"

namespace semantic_vslam {

struct TrackingNodeletConfig {
  double budget_ms = 33.0;
  double path_period_s = 0.5;
  std::string map_file = "map.slam";
  std::string trajectory_file = "trajectory.txt";
  TrackingWaits waits;
  RgbdInputConfig input;
  FramesConfig frames;
  InitialPoseConfig initial_pose;
  RemovalConfig removal;
  PeopleConfig people;
  SparseSlamConfig slam;

  template <class Visitor>
  void visit(Visitor& v) {
    v.field("budget_ms", budget_ms, 1.0, 1000.0, "ms a frame may take before the diagnostics warn; 33 keeps 30 Hz");
    v.field("path_period_s", path_period_s, 0.05, 60.0, "s between publications of the path");
    v.text("map_file", map_file, "sparse map that ~save_map writes and ~load_map reads");
    v.text("trajectory_file", trajectory_file, "where ~save_trajectory writes, TUM format, optical frame in the map");
    waits.visit(v);
    v.group("input", input);
    v.group("frames", frames);
    v.group("initial_pose", initial_pose);
    v.group("removal", removal);
    v.group("people", people);
    slam.visit(v);  // tracking and mapping, as in a configuration file
  }
};

/// Images and motion masks -> pose on tf and tracking/{odometry, pose, path, state, keyframe, keyframe_poses, points},
/// and tracking/labels_wanted while the start waits for labels. Owner of the sparse map.
class TrackingNodelet final : public StageNodelet {
 public:
  ~TrackingNodelet() override { stop(); }

 private:
  void start() override;
  void stop() override;
  void run(ros::NodeHandle nh, std::uint32_t first_map_id);
  void subscribe(ros::NodeHandle nh, ros::NodeHandle private_nh);
  void advertiseServices(ros::NodeHandle private_nh);
  void report(StageDiagnostics::Status& status);
  std::optional<RgbdFrame> decode(const RgbdMessages& messages);
  void onTracked(const TrackingInput& input, const TrackingOutput& output, StepTime time);
  Running running();

  TrackingNodeletConfig config_;
  std::optional<RgbdConverter> converter_;  // runner only
  std_msgs::Header header_;                 // runner only; of the image in work
  std::optional<BodyTransforms> body_;      // runner only; at that image
  std::unique_ptr<TrackingPublisher> publisher_;
  std::atomic<TrackingState> state_{TrackingState::kInitialising};
  std::atomic<int> inliers_{0};
  std::atomic<std::size_t> posed_{0}, lost_{0}, keyframes_{0}, landmarks_{0}, loops_{0};
  std::atomic<bool> paused_{false}, labels_seen_{false}, nobody_labels_{false};
  std::unique_ptr<StageDiagnostics> diagnostics_;
  std::unique_ptr<TrackingRunner> runner_;
  // Last, so that callbacks stop before what they use is gone.
  Services services_;
  ros::Publisher labels_wanted_;
  std::vector<ros::Subscriber> subscribers_;
  ros::Subscriber labels_;
  std::unique_ptr<MotionInput> motion_;
  std::unique_ptr<RgbdSubscriber> input_;
};

void TrackingNodelet::start() {
  ros::NodeHandle nh = getNodeHandle(), private_nh = getPrivateNodeHandle();
  config_ = loadParameters<TrackingNodeletConfig>(private_nh);
  converter_.emplace(config_.input);
  // Ids of an earlier run of this node must not pass for ours with whoever kept its keyframes.
  const std::uint32_t first_map_id = ros::WallTime::now().sec;
  publisher_ = std::make_unique<TrackingPublisher>(nh, config_.frames, config_.initial_pose, config_.people,
                                                   config_.path_period_s, first_map_id);
  diagnostics_ = std::make_unique<StageDiagnostics>(nh, private_nh, getName(), "tracking", config_.budget_ms);
  run(nh, first_map_id);
  // Services wait for a frame or for bundle adjustment: on threads of their own, so that images still come in.
  advertiseServices(getMTPrivateNodeHandle());
  subscribe(nh, private_nh);
  diagnostics_->start(nh, {[this] { return input_->missing(); }, [this] { return runner_->counters(); },
                           [this](StageDiagnostics::Status& status) { report(status); }});
}

void TrackingNodelet::run(ros::NodeHandle nh, std::uint32_t first_map_id) {
  labels_wanted_ = nh.advertise<std_msgs::Header>("tracking/labels_wanted", 1);
  TrackingRunner::Hooks hooks;
  hooks.running = [this] { return running(); };
  hooks.tracked = [this](const auto& input, const auto& output, StepTime time) { onTracked(input, output, time); };
  hooks.map_changed = [this](const std::shared_ptr<const MapSnapshot>& map) {
    keyframes_ = map->keyframes();
    landmarks_ = map->landmarks;
    loops_ = map->loops;
    publisher_->publishMap(*map);
  };
  hooks.labels_wanted = [this](Stamp) { labels_wanted_.publish(header_); };
  hooks.wishes = [this] { return publisher_->wishes(fromRos(header_.stamp)); };
  runner_ = std::make_unique<TrackingRunner>(TrackingStage(config_.slam, config_.waits, config_.removal, first_map_id),
                                             config_.waits, config_.input.queue_size, std::move(hooks));
}

/// A network that was there and is gone has broken down; one that nothing was heard of yet may still be loading.
Running TrackingNodelet::running() {
  const bool network = labels_.getNumPublishers() > 0;
  if (network) labels_seen_ = true;
  return {motion_->runs(), network || (!labels_seen_ && !nobody_labels_)};
}

void TrackingNodelet::subscribe(ros::NodeHandle nh, ros::NodeHandle private_nh) {
  motion_ = std::make_unique<MotionInput>(
      nh, [this](Stamp stamp, const MotionResult& motion) { runner_->take(stamp, motion); });
  labels_ = nh.subscribe<sensor_msgs::Image>(
      "segmentation/labels", 2, labelsFromRos([this](const FrameLabels& labels) { runner_->take(labels); }));
  subscribers_.push_back(nh.subscribe<LabelInfo>("segmentation/label_info", 1, [this](const LabelInfoConstPtr& info) {
    nobody_labels_ = info->classes.size() <= 1;  // the background
    runner_->take(fromRos(*info));
  }));
  input_ = std::make_unique<RgbdSubscriber>(nh, private_nh, config_.input, [this](const RgbdMessages& messages) {
    PendingFrame pending = converter_->pending(messages, header_);
    pending.decode = [this, messages] { return decode(messages); };
    if (!paused_) runner_->push(std::move(pending));
  });
}

std::optional<RgbdFrame> TrackingNodelet::decode(const RgbdMessages& messages) {
  if (paused_) return std::nullopt;
  std::optional<RgbdFrame> frame = converter_->pending(messages, header_).decode();
  if (!frame) return std::nullopt;
  body_ = publisher_->lookUp(header_);
  return body_ ? frame : std::nullopt;  // counted; the next frame may know
}

void TrackingNodelet::onTracked(const TrackingInput& input, const TrackingOutput& output, StepTime time) {
  state_ = output.tracking.state;
  inliers_ = output.tracking.inliers;
  ++(state_ == TrackingState::kOk || state_ == TrackingState::kRecentlyLost ? posed_ : lost_);
  if (!labels_seen_) nobody_labels_ = true;  // it has waited once; label_info takes it back
  publisher_->publish(header_, *body_, input, output, time);
  diagnostics_->record(input.frame.stamp, time);
}

void TrackingNodelet::advertiseServices(ros::NodeHandle private_nh) {
  services_.addTrigger(private_nh, "reset", [this] {
    runner_->change([](TrackingStage& stage) { stage.reset(); });
    state_ = TrackingState::kInitialising;
    return std::string("map and trajectory are dropped");
  });
  services_.addTrigger(private_nh, "save_map", [this] {
    // Written from a copy: a slow disk must not hold up tracking.
    Map map;
    runner_->read([&](const TrackingStage& stage) { map = stage.slam().map(); });
    return "map of " + std::to_string(SparseSlam::saveMap(config_.map_file, map)) + " keyframes saved in " +
           config_.map_file;
  });
  services_.addTrigger(private_nh, "load_map", [this] {
    const std::shared_ptr<SavedMap> saved = runner_->stage().readMap(config_.map_file);  // long: tracking goes on
    runner_->change([&](TrackingStage& stage) {
      publisher_->keepAnchor();
      stage.loadMap(*saved);
    });
    state_ = TrackingState::kLost;  // no longer initialising: the camera is looked for in the map
    return "map loaded from " + config_.map_file;
  });
  services_.addTrigger(private_nh, "save_trajectory", [this] {
    std::vector<TimedPose> poses;
    runner_->read([&](const TrackingStage& stage) { poses = stage.slam().trajectory(); });
    poses = publisher_->inMap(std::move(poses));
    if (poses.empty()) throw Error("no frame has a pose yet; " + config_.trajectory_file + " is not touched");
    writeTumTrajectory(config_.trajectory_file, poses);
    return std::to_string(poses.size()) + " poses saved in " + config_.trajectory_file;
  });
  services_.addSwitch(private_nh, "pause", [this](bool on) { paused_ = on; });
  services_.addSwitch(private_nh, "localization_only", [this](bool on) { runner_->setLocalizationOnly(on); });
}

void TrackingNodelet::report(StageDiagnostics::Status& status) {
  const TrackingRunner::Counts counts = runner_->counts();
  status.add("state", stateName(state_));
  status.add("inliers", inliers_.load());
  status.add("keyframes", keyframes_.load());
  status.add("landmarks", landmarks_.load());
  status.add("loops closed", loops_.load());
  status.add("frames with a pose", posed_.load());
  status.add("frames without", lost_.load());
  status.add("paused", paused_.load());
  diagnostics_->addFault(status, "frames refused", converter_->refused());
  status.add("frames without mask", counts.without_mask);
  diagnostics_->addFault(status, "frames skipped as motion did", counts.skipped_with_motion);
  diagnostics_->addFault(status, "frames that waited for labels", counts.waited_for_labels);
  diagnostics_->addFault(status, "frames older than the one before", counts.out_of_order);
  status.add("transforms sent", publisher_->tf().sent());
  if (diagnostics_->addFault(status, "transforms not found", publisher_->tf().failedLookups())) {
    status.mergeSummary(diagnostic_msgs::DiagnosticStatus::WARN, publisher_->tf().lastFailure());
  }
  for (const StageSummary& stage : runner_->times().summarize()) {
    status.addf("cpu median of " + stage.stage, "%.1f ms", stage.cpu.median_ms);
  }
  runner_->times().clear();
  if (state_ == TrackingState::kLost) status.mergeSummary(diagnostic_msgs::DiagnosticStatus::ERROR, "lost");
}

void TrackingNodelet::stop() {
  services_.shutdown();
  if (diagnostics_) diagnostics_->stop();
  if (runner_) runner_->close();
  input_.reset();
  if (motion_) motion_->shutdown();
  labels_.shutdown();
  subscribers_.clear();
  runner_.reset();
  motion_.reset();  // which the runner asks
  diagnostics_.reset();
  publisher_.reset();
  labels_wanted_.shutdown();
}

}  // namespace semantic_vslam

PLUGINLIB_EXPORT_CLASS(semantic_vslam::TrackingNodelet, nodelet::Nodelet)
