// SPDX-FileCopyrightText: 2026 The semantic_vslam authors
// SPDX-License-Identifier: BSD-3-Clause
#include <nodelet/nodelet.h>

#include <atomic>
#include <chrono>
#include <memory>
#include <mutex>
#include <optional>
#include <pluginlib/class_list_macros.hpp>
#include <string>
#include <vector>

#include "semantic_vslam/core/common/error.h"
#include "semantic_vslam/core/io/trajectory.h"
#include "semantic_vslam/core/pipeline/sparse_slam.h"
#include "semantic_vslam/ros/conversions.h"
#include "semantic_vslam/ros/parameters.h"
#include "semantic_vslam/ros/rgbd_converter.h"
#include "semantic_vslam/ros/rgbd_subscriber.h"
#include "semantic_vslam/ros/services.h"
#include "semantic_vslam/ros/stage_diagnostics.h"
#include "semantic_vslam/ros/stamped_buffer.h"
#include "semantic_vslam/ros/tracking_publisher.h"
#include "semantic_vslam/ros/worker.h"

namespace semantic_vslam {

struct TrackingNodeletConfig {
  double budget_ms = 33.0;
  int mask_budget_ms = 60;
  double init_wait_s = 0.0;
  double path_period_s = 0.5;
  std::string map_file = "map.slam";
  std::string trajectory_file = "trajectory.txt";
  RgbdInputConfig input;
  FramesConfig frames;
  InitialPoseConfig initial_pose;
  SparseSlamConfig slam;

  template <class Visitor>
  void visit(Visitor& v) {
    v.field("budget_ms", budget_ms, 1.0, 1000.0, "ms a frame may take before the diagnostics warn; 33 keeps 30 Hz");
    v.field("mask_budget_ms", mask_budget_ms, 0, 1000,
            "ms a frame waits for its motion mask before it is tracked without; two frames at 30 Hz");
    v.field("init_wait_s", init_wait_s, 0.0, 60.0,
            "s the start waits for the first labels, so that no person enters the first map; 0 where no network runs");
    v.field("path_period_s", path_period_s, 0.05, 60.0, "s between publications of the path");
    v.text("map_file", map_file, "sparse map that ~save_map writes and ~load_map reads");
    v.text("trajectory_file", trajectory_file, "where ~save_trajectory writes, TUM format, optical frame in the map");
    v.group("input", input);
    v.group("frames", frames);
    v.group("initial_pose", initial_pose);
    slam.visit(v);  // tracking and mapping, as in a configuration file
  }
};

/// Images and motion masks -> pose on tf and tracking/{odometry, pose, path, state, keyframe, keyframe_poses, points}.
/// Owner of the sparse map.
class TrackingNodelet final : public nodelet::Nodelet {
 public:
  ~TrackingNodelet() override;

 private:
  void onInit() override;
  void start();
  void advertiseServices(ros::NodeHandle private_nh);
  void onMask(const sensor_msgs::ImageConstPtr& message);
  void onLabels(const sensor_msgs::ImageConstPtr& message);
  void report(StageDiagnostics::Status& status);
  void dropMap();

  // Worker thread
  void step(const RgbdMessages& messages);
  bool readyToStart(Stamp stamp);
  cv::Mat1b maskOf(const std_msgs::Header& image, cv::Size size);

  TrackingNodeletConfig config_;
  std::optional<RgbdConverter> converter_;  // worker only
  StageTimes times_;
  std::mutex step_mutex_;             // a frame and its publication are one with the map they belong to
  std::unique_ptr<SparseSlam> slam_;  // step() by the worker only
  std::unique_ptr<TrackingPublisher> publisher_;
  StampedBuffer<cv::Mat1b> masks_{30};
  Stamp last_stamp_;                                 // worker only
  std::optional<ros::SteadyTime> first_frame_time_;  // worker only
  std::atomic<TrackingState> state_{TrackingState::kInitialising};
  std::atomic<int> inliers_{0};
  std::atomic<bool> paused_{false}, labels_seen_{false};
  std::atomic<std::int64_t> labels_in_masks_after_ns_{0};
  std::atomic<std::size_t> posed_{0}, lost_{0}, without_mask_{0}, skipped_with_motion_{0}, waited_for_labels_{0};

  std::unique_ptr<StageDiagnostics> diagnostics_;
  std::unique_ptr<Worker<RgbdMessages>> worker_;
  ros::Subscriber mask_subscriber_, labels_subscriber_;
  Services services_;
  std::unique_ptr<RgbdSubscriber> input_;
};

TrackingNodelet::~TrackingNodelet() {
  mask_subscriber_.shutdown();
  labels_subscriber_.shutdown();
  services_.shutdown();
  if (diagnostics_) diagnostics_->stop();
  input_.reset();
  masks_.close();
  worker_.reset();
}

void TrackingNodelet::onInit() {
  try {
    start();
  } catch (const Error& error) {
    NODELET_FATAL("%s", error.what());
    throw;  // the loader gives the nodelet up; a node ends
  }
}

void TrackingNodelet::start() {
  installRosLogSink();
  ros::NodeHandle nh = getNodeHandle(), private_nh = getPrivateNodeHandle();
  config_ = loadParameters<TrackingNodeletConfig>(private_nh);
  converter_.emplace(config_.input);
  slam_ = std::make_unique<SparseSlam>(config_.slam, SparseSlam::Mode::kBackground);
  publisher_ = std::make_unique<TrackingPublisher>(nh, config_.frames, config_.initial_pose, config_.path_period_s);

  diagnostics_ = std::make_unique<StageDiagnostics>(nh, private_nh, getName(), "tracking", config_.budget_ms);
  worker_ = std::make_unique<Worker<RgbdMessages>>(config_.input.queue_size, QueuePolicy::kDropOldest,
                                                   [this](const RgbdMessages& messages) { step(messages); });
  mask_subscriber_ = nh.subscribe("motion/mask", 10, &TrackingNodelet::onMask, this);
  if (config_.init_wait_s > 0) {
    labels_subscriber_ = nh.subscribe("segmentation/labels", 2, &TrackingNodelet::onLabels, this);
  }
  advertiseServices(private_nh);
  input_ = std::make_unique<RgbdSubscriber>(nh, config_.input,
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
    slam_->saveMap(config_.map_file);
    return "map saved in " + config_.map_file;
  });
  services_.addTrigger(private_nh, "load_map", [this] {
    std::lock_guard<std::mutex> lock(step_mutex_);
    slam_->loadMap(config_.map_file);
    publisher_->startMap(TrackingPublisher::Anchor::kKeep);
    return "map loaded from " + config_.map_file;
  });
  services_.addTrigger(private_nh, "save_trajectory", [this] {
    const std::vector<TimedPose> poses = publisher_->trajectory(*slam_);
    writeTumTrajectory(config_.trajectory_file, poses);
    return std::to_string(poses.size()) + " poses saved in " + config_.trajectory_file;
  });
  services_.addSwitch(private_nh, "pause", [this](bool on) { paused_ = on; });
  services_.addSwitch(private_nh, "localization_only", [this](bool on) { slam_->setLocalizationOnly(on); });
}

void TrackingNodelet::onMask(const sensor_msgs::ImageConstPtr& message) {
  try {
    masks_.put(fromRos(message->header.stamp), maskFromRos(message));
  } catch (const Error& error) {
    NODELET_ERROR_THROTTLE(5.0, "mask refused: %s", error.what());
  }
}

/// The first labels are in the motion masks from the next mask on.
void TrackingNodelet::onLabels(const sensor_msgs::ImageConstPtr&) {
  labels_in_masks_after_ns_ = masks_.newest().value_or(Stamp{}).ns;
  labels_seen_ = true;
  labels_subscriber_.shutdown();
}

void TrackingNodelet::report(StageDiagnostics::Status& status) {
  status.add("state", stateName(state_));
  status.add("inliers", inliers_.load());
  status.add("keyframes", slam_->keyframeCount());
  status.add("landmarks", slam_->landmarkCount());
  status.add("loops closed", slam_->loopCount());
  status.add("frames with a pose", posed_.load());
  status.add("frames without", lost_.load());
  status.add("frames refused", converter_->refused());
  status.add("frames without mask", without_mask_.load());
  status.add("frames skipped as motion did", skipped_with_motion_.load());
  status.add("frames that waited for labels", waited_for_labels_.load());
  status.add("transforms sent", publisher_->tf().sent());
  status.add("transforms not found", publisher_->tf().failedLookups());
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
  state_ = TrackingState::kInitialising;
}

/// Whether the people of the first frames are known, or need not be waited for any longer.
bool TrackingNodelet::readyToStart(Stamp stamp) {
  if (config_.init_wait_s <= 0 || state_ != TrackingState::kInitialising) return true;
  if (labels_seen_) return stamp.ns > labels_in_masks_after_ns_;
  const ros::SteadyTime now = ros::SteadyTime::now();
  if (!first_frame_time_) first_frame_time_ = now;
  if ((now - *first_frame_time_).toSec() < config_.init_wait_s) return false;
  NODELET_WARN_ONCE("no labels within init_wait_s: starting without");
  return true;
}

/// The motion mask of a frame; empty if it did not come in time or does not fit.
cv::Mat1b TrackingNodelet::maskOf(const std_msgs::Header& image, cv::Size size) {
  // Without a motion nodelet there is nothing to wait for.
  const std::chrono::milliseconds budget(mask_subscriber_.getNumPublishers() > 0 ? config_.mask_budget_ms : 0);
  const cv::Mat1b mask = masks_.waitFor(fromRos(image.stamp), budget).value_or(cv::Mat1b());
  if (mask.empty() || mask.size() == size) return mask;
  NODELET_ERROR_THROTTLE(5.0, "motion/mask is %dx%d but the image %dx%d: tracked without", mask.cols, mask.rows,
                         size.width, size.height);
  return cv::Mat1b();
}

void TrackingNodelet::step(const RgbdMessages& messages) {
  if (paused_) return;
  const std_msgs::Header& image = messages.rgb->header;
  const Stamp stamp = fromRos(image.stamp);
  if (stamp < last_stamp_) {
    NODELET_WARN("stamps went back: map and trajectory are dropped");
    dropMap();
  }
  last_stamp_ = stamp;
  if (!readyToStart(stamp)) {
    ++waited_for_labels_;
    return;
  }
  const std::optional<RgbdFrame> frame = converter_->convert(messages);
  if (!frame) return;
  const std::optional<SE3> T_camera_body = publisher_->cameraFromBody(image);
  if (!T_camera_body) return;  // counted; the next frame may know
  const cv::Mat1b mask = maskOf(image, frame->gray.size());
  if (mask.empty() && masks_.newest() > stamp && worker_->waiting() > 0) {
    ++skipped_with_motion_;  // both stages are behind: track the frames that the motion stage had time for
    return;
  }
  if (mask.empty()) ++without_mask_;

  std::lock_guard<std::mutex> lock(step_mutex_);
  const StageDiagnostics::Step timer(*diagnostics_, stamp);
  const SparseStep result = slam_->step(*frame, mask, times_);
  state_ = result.tracking.state;
  inliers_ = result.tracking.inliers;
  ++(state_ == TrackingState::kOk || state_ == TrackingState::kRecentlyLost ? posed_ : lost_);

  TrackedFrameReport report;
  report.has_mask = !mask.empty();
  if (report.has_mask) report.dynamic_share = cv::countNonZero(mask >= 128) / static_cast<double>(mask.total());
  report.cpu_ms = timer.cpuMs();
  publisher_->publish(image, *T_camera_body, result, *slam_, report);
}

}  // namespace semantic_vslam

PLUGINLIB_EXPORT_CLASS(semantic_vslam::TrackingNodelet, nodelet::Nodelet)
