// SPDX-FileCopyrightText: 2026 The semantic_vslam authors
// SPDX-License-Identifier: BSD-3-Clause
#include <semantic_vslam/KeyframePoseArray.h>
#include <semantic_vslam/LabelInfo.h>
#include <semantic_vslam/MotionReport.h>
#include <semantic_vslam/MotionThresholdsConfig.h>
#include <semantic_vslam/TrackingReport.h>

#include <memory>
#include <mutex>
#include <optional>
#include <pluginlib/class_list_macros.hpp>
#include <vector>

#include "core/motion/flow_colour.h"
#include "core/runtime/motion_runner.h"
#include "ros/conversions.h"
#include "ros/parameters.h"
#include "ros/rgbd_converter.h"
#include "ros/rgbd_subscriber.h"
#include "ros/stage_nodelet.h"
#include "ros/threshold_server.h"

namespace semantic_vslam {

struct MotionNodeletConfig {
  double budget_ms = 33.0;
  RgbdInputConfig input;
  MotionConfig motion;
  RemovalConfig removal;

  template <class Visitor>
  void visit(Visitor& v) {
    v.field("budget_ms", budget_ms, 1.0, 1000.0, "ms a frame may take before the diagnostics warn; 33 keeps 30 Hz");
    v.group("input", input);
    v.group("motion", motion);
    v.group("depth_noise", motion.rigid.depth_noise);
    v.group("removal", removal);
  }
};

/// Images -> motion/mask (mono8, probability 0..255 that a pixel is on a moving object), motion/flow_image when
/// watched, motion/report. Labels and keyframe poses, late as they are, count from the next frame on.
class MotionNodelet final : public StageNodelet {
 public:
  ~MotionNodelet() override { stop(); }

 private:
  void start() override;
  void stop() override;
  void subscribe(ros::NodeHandle nh, ros::NodeHandle private_nh);
  void describe(StageDiagnostics::Status& status);
  void publish(const RgbdFrame& frame, const MotionResult& motion, StepTime time);

  MotionNodeletConfig config_;
  std::optional<RgbdConverter> converter_;  // runner only
  std_msgs::Header header_;                 // runner only; of the image in work
  std::mutex mutex_;
  MotionReport newest_;  // guarded by mutex_
  ros::Publisher mask_publisher_, flow_publisher_, report_publisher_;
  std::unique_ptr<StageDiagnostics> diagnostics_;
  std::unique_ptr<MotionRunner> runner_;
  // Last, so that callbacks stop before what they use is gone.
  std::unique_ptr<ThresholdServer<MotionThresholdsConfig, MotionNodeletConfig>> thresholds_;
  std::vector<ros::Subscriber> subscribers_;
  std::unique_ptr<RgbdSubscriber> input_;
};

void MotionNodelet::start() {
  ros::NodeHandle nh = getNodeHandle(), private_nh = getPrivateNodeHandle();
  config_ = loadParameters<MotionNodeletConfig>(private_nh);
  converter_.emplace(config_.input);
  mask_publisher_ = nh.advertise<sensor_msgs::Image>("motion/mask", 5);
  flow_publisher_ = nh.advertise<sensor_msgs::Image>("motion/flow_image", 1);
  report_publisher_ = nh.advertise<MotionReport>("motion/report", 30);
  diagnostics_ = std::make_unique<StageDiagnostics>(nh, private_nh, getName(), "motion", config_.budget_ms);
  runner_ = std::make_unique<MotionRunner>(
      MotionStage(config_.motion, config_.removal), config_.input.queue_size,
      [this](const RgbdFrame& frame, const MotionResult& motion, StepTime time) { publish(frame, motion, time); });
  subscribe(nh, private_nh);
  diagnostics_->start(nh, {[this] { return input_->missing(); }, [this] { return runner_->counters(); },
                           [this](StageDiagnostics::Status& status) { describe(status); }});
}

void MotionNodelet::subscribe(ros::NodeHandle nh, ros::NodeHandle private_nh) {
  thresholds_ = std::make_unique<ThresholdServer<MotionThresholdsConfig, MotionNodeletConfig>>(
      private_nh, config_, [this](const MotionNodeletConfig& accepted) {
        validateConfig(accepted);
        runner_->take(accepted.motion);
        runner_->take(accepted.removal);
      });
  subscribers_.push_back(nh.subscribe<LabelInfo>(
      "segmentation/label_info", 1, [this](const LabelInfoConstPtr& info) { runner_->take(fromRos(*info)); }));
  subscribers_.push_back(nh.subscribe<sensor_msgs::Image>(
      "segmentation/labels", 5, labelsFromRos([this](FrameLabels labels) { runner_->take(std::move(labels)); })));
  subscribers_.push_back(nh.subscribe<KeyframePoseArray>(
      "tracking/keyframe_poses", 1,
      [this](const KeyframePoseArrayConstPtr& poses) { runner_->take(fromRos(*poses)); }));
  subscribers_.push_back(
      nh.subscribe<TrackingReport>("tracking/state", 10, [this](const TrackingReportConstPtr& report) {
        if (report->state != TrackingReport::OK) return;
        runner_->take(TimedPose{fromRos(report->header.stamp), fromRos(report->camera)});
      }));
  input_ = std::make_unique<RgbdSubscriber>(nh, private_nh, config_.input, [this](const RgbdMessages& messages) {
    runner_->push(converter_->pending(messages, header_));
  });
}

void MotionNodelet::stop() {
  if (diagnostics_) diagnostics_->stop();
  input_.reset();
  subscribers_.clear();
  thresholds_.reset();
  runner_.reset();
  diagnostics_.reset();
  for (ros::Publisher* publisher : {&mask_publisher_, &flow_publisher_, &report_publisher_}) publisher->shutdown();
}

void MotionNodelet::describe(StageDiagnostics::Status& status) {
  diagnostics_->addFault(status, "frames refused", converter_->refused());
  status.add("label images used", runner_->labelsTaken());
  status.add("label images too late", runner_->labelsTooLate());
  std::lock_guard<std::mutex> lock(mutex_);
  status.add("model", motionModelName(static_cast<MotionModel>(newest_.model)));
  status.add("inliers", newest_.inliers);
  status.add("dynamic share", newest_.dynamic_share);
}

void MotionNodelet::publish(const RgbdFrame& frame, const MotionResult& motion, StepTime time) {
  auto report = boost::make_shared<MotionReport>(toRos(header_, motion));
  report->cpu_ms = static_cast<float>(time.cpu_ms);
  report_publisher_.publish(report);
  mask_publisher_.publish(toRos(header_, "mono8", motion.dynamic));
  if (flow_publisher_.getNumSubscribers() > 0 && !motion.flow_px.empty()) {
    flow_publisher_.publish(toRos(header_, "bgr8", flowPicture(motion.flow_px)));
  }
  diagnostics_->record(frame.stamp, time);
  std::lock_guard<std::mutex> lock(mutex_);
  newest_ = *report;
}

}  // namespace semantic_vslam

PLUGINLIB_EXPORT_CLASS(semantic_vslam::MotionNodelet, nodelet::Nodelet)
