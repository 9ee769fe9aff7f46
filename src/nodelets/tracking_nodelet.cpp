// SPDX-FileCopyrightText: 2026 The semantic_vslam authors
// SPDX-License-Identifier: BSD-3-Clause
#include <atomic>
#include <memory>
#include <mutex>
#include <optional>
#include <pluginlib/class_list_macros.hpp>
#include <string>
#include <utility>
#include <vector>

#include "core/pipeline/sparse_slam.h"
#include "core/runtime/worker.h"
#include "ros/conversions.h"
#include "ros/motion_mask_input.h"
#include "ros/parameters.h"
#include "ros/rgbd_converter.h"
#include "ros/rgbd_subscriber.h"
#include "ros/services.h"
#include "ros/stage_nodelet.h"
#include "ros/tracking_publisher.h"
#include "semantic_vslam/core/common/error.h"
#include "semantic_vslam/core/io/trajectory.h"

namespace semantic_vslam {

// A driver's clock or the network may put frames out of order by less than this.
constexpr double kLongestDisorderS = 5.0;

struct TrackingNodeletConfig {
  double budget_ms = 33.0;
  double path_period_s = 0.5;
  std::string map_file = "map.slam";
  std::string trajectory_file = "trajectory.txt";
  MotionMaskConfig masks;
  RgbdInputConfig input;
  FramesConfig frames;
  InitialPoseConfig initial_pose;
  SparseSlamConfig slam;

  template <class Visitor>
  void visit(Visitor& v) {
    v.field("budget_ms", budget_ms, 1.0, 1000.0, "ms a frame may take before the diagnostics warn; 33 keeps 30 Hz");
    v.field("path_period_s", path_period_s, 0.05, 60.0, "s between publications of the path");
    v.text("map_file", map_file, "sparse map that ~save_map writes and ~load_map reads");
    v.text("trajectory_file", trajectory_file, "where ~save_trajectory writes, TUM format, optical frame in the map");
    masks.visit(v);
    v.group("input", input);
    v.group("frames", frames);
    v.group("initial_pose", initial_pose);
    slam.visit(v);  // tracking and mapping, as in a configuration file
  }
};

/// Images and motion masks -> pose on tf and tracking/{odometry, pose, path, state, keyframe, keyframe_poses, points}.
/// Owner of the sparse map.
class TrackingNodelet final : public StageNodelet {
 public:
  ~TrackingNodelet() override { stop(); }

 private:
  void start() override;
  void stop() override;
  void advertiseServices(ros::NodeHandle private_nh);
  void report(StageDiagnostics::Status& status);
  void dropMap();

  // Worker thread
  double clockBackS() const;
  bool takesOlder(Stamp stamp);
  void step(const RgbdMessages& messages);

  TrackingNodeletConfig config_;
  std::optional<RgbdConverter> converter_;  // worker only
  StageTimes times_;
  std::mutex step_mutex_;             // a frame and its publication are one with the map they belong to
  std::unique_ptr<SparseSlam> slam_;  // step() by the worker only
  std::unique_ptr<TrackingPublisher> publisher_;
  std::unique_ptr<MotionMaskInput> masks_;
  Stamp last_stamp_;      // worker only
  ros::Time last_clock_;  // worker only; at the frame before
  std::atomic<TrackingState> state_{TrackingState::kInitialising};
  std::atomic<int> inliers_{0};
  std::atomic<bool> paused_{false};
  std::atomic<std::size_t> posed_{0}, lost_{0}, without_mask_{0}, skipped_with_motion_{0}, waited_for_labels_{0},
      out_of_order_{0};

  std::unique_ptr<StageDiagnostics> diagnostics_;
  std::unique_ptr<Worker<RgbdMessages>> worker_;
  Services services_;
  std::unique_ptr<RgbdSubscriber> input_;
};

void TrackingNodelet::stop() {
  services_.shutdown();
  if (diagnostics_) diagnostics_->stop();
  input_.reset();
  if (masks_) masks_->close();
  worker_.reset();
  masks_.reset();
  diagnostics_.reset();
  publisher_.reset();
}

void TrackingNodelet::start() {
  ros::NodeHandle nh = getNodeHandle(), private_nh = getPrivateNodeHandle();
  config_ = loadParameters<TrackingNodeletConfig>(private_nh);
  converter_.emplace(config_.input);
  slam_ = std::make_unique<SparseSlam>(config_.slam, SparseSlam::Mode::kBackground);
  publisher_ = std::make_unique<TrackingPublisher>(nh, config_.frames, config_.initial_pose, config_.path_period_s);

  diagnostics_ = std::make_unique<StageDiagnostics>(nh, private_nh, getName(), "tracking", config_.budget_ms);
  worker_ = std::make_unique<Worker<RgbdMessages>>(config_.input.queue_size, QueuePolicy::kDropOldest,
                                                   [this](const RgbdMessages& messages) { step(messages); });
  masks_ = std::make_unique<MotionMaskInput>(nh, config_.masks);
  // Services wait for a frame or for bundle adjustment: on threads of their own, so that images still come in.
  advertiseServices(getMTPrivateNodeHandle());
  input_ = std::make_unique<RgbdSubscriber>(nh, private_nh, config_.input,
                                            [this](const RgbdMessages& messages) { worker_->push(messages); });
  diagnostics_->start(nh, {[this] { return input_->missing(); }, [this] { return worker_->counters(); },
                           [this](StageDiagnostics::Status& status) { report(status); }});
}

void TrackingNodelet::advertiseServices(ros::NodeHandle private_nh) {
  services_.addTrigger(private_nh, "reset", [this] {
    dropMap();
    return std::string("map and trajectory are dropped");
  });
  services_.addTrigger(private_nh, "save_map", [this] {
    const std::size_t keyframes = slam_->saveMap(config_.map_file);
    return "map of " + std::to_string(keyframes) + " keyframes saved in " + config_.map_file;
  });
  services_.addTrigger(private_nh, "load_map", [this] {
    SavedMap saved = slam_->readMap(config_.map_file);  // takes long: tracking goes on
    std::lock_guard<std::mutex> lock(step_mutex_);
    slam_->loadMap(std::move(saved));
    state_ = TrackingState::kLost;  // no longer initialising: the camera is looked for in the map
    publisher_->startMap(TrackingPublisher::Anchor::kKeep);
    return "map loaded from " + config_.map_file;
  });
  services_.addTrigger(private_nh, "save_trajectory", [this] {
    const std::vector<TimedPose> poses = publisher_->trajectory(*slam_);
    if (poses.empty()) throw Error("no frame has a pose yet; " + config_.trajectory_file + " is not touched");
    writeTumTrajectory(config_.trajectory_file, poses);
    return std::to_string(poses.size()) + " poses saved in " + config_.trajectory_file;
  });
  services_.addSwitch(private_nh, "pause", [this](bool on) { paused_ = on; });
  services_.addSwitch(private_nh, "localization_only", [this](bool on) { slam_->setLocalizationOnly(on); });
}

void TrackingNodelet::report(StageDiagnostics::Status& status) {
  status.add("state", stateName(state_));
  status.add("inliers", inliers_.load());
  status.add("keyframes", slam_->keyframeCount());
  status.add("landmarks", slam_->landmarkCount());
  status.add("loops closed", slam_->loopCount());
  status.add("frames with a pose", posed_.load());
  status.add("frames without", lost_.load());
  status.add("paused", paused_.load());
  diagnostics_->addFault(status, "frames refused", converter_->refused());
  status.add("frames without mask", without_mask_.load());
  diagnostics_->addFault(status, "frames skipped as motion did", skipped_with_motion_);
  diagnostics_->addFault(status, "frames that waited for labels", waited_for_labels_);
  diagnostics_->addFault(status, "frames older than the one before", out_of_order_);
  status.add("transforms sent", publisher_->tf().sent());
  if (diagnostics_->addFault(status, "transforms not found", publisher_->tf().failedLookups())) {
    status.mergeSummary(diagnostic_msgs::DiagnosticStatus::WARN, publisher_->tf().lastFailure());
  }
  for (const StageSummary& stage : times_.summarize()) {
    status.addf("cpu median of " + stage.stage, "%.1f ms", stage.cpu.median_ms);
  }
  times_.clear();
  if (state_ == TrackingState::kLost) status.mergeSummary(diagnostic_msgs::DiagnosticStatus::ERROR, "lost");
}

void TrackingNodelet::dropMap() {
  std::lock_guard<std::mutex> lock(step_mutex_);
  slam_->reset();
  publisher_->startMap(TrackingPublisher::Anchor::kAtNextFrame);
  masks_->restart();
  state_ = TrackingState::kInitialising;
}

/// @return by how much a simulated clock has gone back since the last frame, s
double TrackingNodelet::clockBackS() const {
  return ros::Time::isSimTime() ? (last_clock_ - ros::Time::now()).toSec() : 0.0;
}

/// A recording that is played again begins a new map, unless the map is one to localise in. The map of a living camera
/// stays, whatever its driver or the clock do: drivers step back by some seconds (librealsense's global time where the
/// device's counter wraps, every 72 minutes), and a clock that is set may do so by any time.
/// @return whether the frame is to be tracked though it is not newer than the one before
bool TrackingNodelet::takesOlder(Stamp stamp) {
  const double back_s = secondsBetween(stamp, last_stamp_);
  const bool played_again = clockBackS() > 0.0;
  if (played_again && !slam_->localizationOnly()) {
    NODELET_WARN("the clock went back, as when a recording is played again: map and trajectory are dropped");
    dropMap();
    return true;
  }
  if (!played_again && back_s <= kLongestDisorderS) {
    NODELET_WARN_THROTTLE(1.0, "stamps went back by %.3f s: frames are passed over until newer ones come", back_s);
    return false;
  }
  NODELET_WARN("stamps went back by %.1f s: the map stays, the trajectory begins anew", back_s);
  std::lock_guard<std::mutex> lock(step_mutex_);
  slam_->startTimeAnew();
  masks_->restart();
  return true;
}

void TrackingNodelet::step(const RgbdMessages& messages) {
  if (paused_) return;
  const std_msgs::Header& image = messages.rgb->header;
  const Stamp stamp = fromRos(image.stamp);
  // A recording's first frames may come before its clock.
  if ((stamp <= last_stamp_ || clockBackS() > kLongestDisorderS) && !takesOlder(stamp)) {
    ++out_of_order_;
    return;
  }
  last_stamp_ = stamp;
  last_clock_ = ros::Time::now();
  const std::optional<RgbdFrame> frame = converter_->convert(messages);
  if (!frame) return;
  const cv::Mat1b mask = masks_->maskOf(image, frame->gray.size());
  if (mask.empty() && masks_->passedOver(stamp) && worker_->waiting() > 0) {
    ++skipped_with_motion_;  // both stages are behind: track the frames that the motion stage had time for
    return;
  }
  if (mask.empty()) ++without_mask_;
  const std::optional<BodyTransforms> body = publisher_->lookUp(image);
  if (!body) return;  // counted; the next frame may know

  std::lock_guard<std::mutex> lock(step_mutex_);
  if (state_ == TrackingState::kInitialising && !masks_->readyToStart(stamp, !mask.empty())) {
    ++waited_for_labels_;
    return;
  }
  const StageDiagnostics::Step timer(*diagnostics_, stamp);
  const SparseStep result = slam_->step(*frame, mask, times_);
  if (result.new_world) publisher_->startMap(TrackingPublisher::Anchor::kAtNextFrame);
  state_ = result.tracking.state;
  inliers_ = result.tracking.inliers;
  ++(state_ == TrackingState::kOk || state_ == TrackingState::kRecentlyLost ? posed_ : lost_);

  TrackedFrameReport report;
  report.has_mask = !mask.empty();
  if (report.has_mask) report.dynamic_share = cv::countNonZero(mask >= 128) / static_cast<double>(mask.total());
  report.cpu_ms = timer.cpuMs();
  publisher_->publish(image, *body, result, *slam_, report);
}

}  // namespace semantic_vslam

PLUGINLIB_EXPORT_CLASS(semantic_vslam::TrackingNodelet, nodelet::Nodelet)
