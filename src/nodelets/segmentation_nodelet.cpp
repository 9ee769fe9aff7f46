// SPDX-FileCopyrightText: 2026 The semantic_vslam authors
// SPDX-License-Identifier: BSD-3-Clause
#include <semantic_vslam/KeyframePoseArray.h>
#include <semantic_vslam/KeyframeStamped.h>
#include <semantic_vslam/LabelInfo.h>
#include <std_msgs/Header.h>

#include <atomic>
#include <memory>
#include <optional>
#include <pluginlib/class_list_macros.hpp>
#include <string>
#include <vector>

#include "core/runtime/label_runner.h"
#include "core/segmentation/label_picture.h"
#include "ros/conversions.h"
#include "ros/parameters.h"
#include "ros/rgbd_converter.h"
#include "ros/rgbd_subscriber.h"
#include "ros/stage_nodelet.h"
#include "semantic_vslam/core/common/error.h"

namespace semantic_vslam {

struct SegmentationNodeletConfig {
  double budget_ms = 500.0;
  KeptInputConfig frames;
  SegmentationConfig segmentation;

  template <class Visitor>
  void visit(Visitor& v) {
    v.field("budget_ms", budget_ms, 1.0, 10000.0,
            "ms a keyframe may take before the diagnostics warn; keyframes come about twice a second");
    frames.visit(v);
    v.group("segmentation", segmentation);
  }
};

/// Images of keyframes, and of what tracking/labels_wanted names -> segmentation/labels (mono8, index into label_info),
/// segmentation/label_info (latched), segmentation/overlay when watched.
class SegmentationNodelet final : public StageNodelet {
 public:
  ~SegmentationNodelet() override { stop(); }

 private:
  void start() override;
  void stop() override;
  std::optional<LabelStage> openNetwork();
  void run(LabelStage stage, ros::NodeHandle nh, ros::NodeHandle private_nh);
  std::string problem() const;
  void report(StageDiagnostics::Status& status);
  void publish(const RgbdFrame& frame, const FrameLabels& labels);

  SegmentationNodeletConfig config_;
  std::atomic<bool> network_failed_{false};
  std::optional<RgbdConverter> converter_;  // runner only
  std_msgs::Header header_;                 // runner only; of the image in work
  ros::Publisher labels_publisher_, info_publisher_, overlay_publisher_;
  std::unique_ptr<StageDiagnostics> diagnostics_;
  std::unique_ptr<LabelRunner> runner_;
  // Last, so that callbacks stop before what they use is gone.
  std::vector<ros::Subscriber> subscribers_;
  std::unique_ptr<RgbdSubscriber> input_;
};

void SegmentationNodelet::start() {
  ros::NodeHandle nh = getNodeHandle(), private_nh = getPrivateNodeHandle();
  config_ = loadParameters<SegmentationNodeletConfig>(private_nh);
  std::optional<LabelStage> stage = openNetwork();
  if (!stage && !network_failed_) return;
  diagnostics_ = std::make_unique<StageDiagnostics>(nh, private_nh, getName(), "segmentation", config_.budget_ms);
  if (stage) run(std::move(*stage), nh, private_nh);
  diagnostics_->start(nh,
                      {[this] { return problem(); }, [this] { return runner_ ? runner_->counters() : QueueCounters(); },
                       [this](StageDiagnostics::Status& status) { report(status); }});
}

/// A network that does not load costs the labels, not the robot: everything else goes on with motion detection.
std::optional<LabelStage> SegmentationNodelet::openNetwork() {
  try {
    LabelStage stage(config_.segmentation);
    if (stage.enabled()) return stage;  // else no model is configured; the stage has said so
  } catch (const ModelError& error) {
    NODELET_ERROR("%s; going on without labels", error.what());
    network_failed_ = true;
  }
  return std::nullopt;
}

void SegmentationNodelet::run(LabelStage stage, ros::NodeHandle nh, ros::NodeHandle private_nh) {
  labels_publisher_ = nh.advertise<sensor_msgs::Image>("segmentation/labels", 5);
  overlay_publisher_ = nh.advertise<sensor_msgs::Image>("segmentation/overlay", 1);
  info_publisher_ = nh.advertise<LabelInfo>("segmentation/label_info", 1, true);
  info_publisher_.publish(toRos(stage.labels()));
  converter_.emplace(config_.frames.input);
  runner_ = std::make_unique<LabelRunner>(
      std::move(stage), config_.frames.kept_frames,
      [this](const RgbdFrame& frame, const FrameLabels& labels, StepTime time) {
        publish(frame, labels);
        diagnostics_->record(frame.stamp, time);
      },
      [this] {
        network_failed_ = true;
        labels_publisher_.shutdown();  // so that nobody waits for labels any more
      });
  subscribers_.push_back(nh.subscribe<KeyframeStamped>(
      "tracking/keyframe", 10,
      [this](const KeyframeStampedConstPtr& keyframe) { runner_->ask(fromRos(keyframe->header.stamp)); }));
  subscribers_.push_back(nh.subscribe<std_msgs::Header>(
      "tracking/labels_wanted", 1,
      [this](const std_msgs::HeaderConstPtr& image) { runner_->ask(fromRos(image->stamp)); }));
  subscribers_.push_back(nh.subscribe<KeyframePoseArray>(
      "tracking/keyframe_poses", 1, [this](const KeyframePoseArrayConstPtr& map) { runner_->take(fromRos(*map)); }));
  input_ = std::make_unique<RgbdSubscriber>(nh, private_nh, config_.frames.input, [this](const RgbdMessages& messages) {
    runner_->offer(converter_->pending(messages, header_));
  });
}

void SegmentationNodelet::stop() {
  subscribers_.clear();
  if (diagnostics_) diagnostics_->stop();
  if (runner_) runner_->close();
  input_.reset();
  runner_.reset();
  diagnostics_.reset();
  for (ros::Publisher* publisher : {&labels_publisher_, &info_publisher_, &overlay_publisher_}) publisher->shutdown();
}

std::string SegmentationNodelet::problem() const {
  if (network_failed_) return "the network failed: there are no labels";
  return input_ ? input_->missing() : std::string();
}

void SegmentationNodelet::report(StageDiagnostics::Status& status) {
  if (!runner_) return;
  diagnostics_->addFault(status, "frames refused", converter_->refused());
  diagnostics_->addFault(status, "keyframes without images", runner_->withoutImages());
}

void SegmentationNodelet::publish(const RgbdFrame& frame, const FrameLabels& labels) {
  labels_publisher_.publish(toRos(header_, "mono8", labels.labels));
  if (overlay_publisher_.getNumSubscribers() > 0) {
    overlay_publisher_.publish(toRos(header_, "bgr8", drawLabels(frame.bgr, labels.labels, runner_->labels())));
  }
}

}  // namespace semantic_vslam

PLUGINLIB_EXPORT_CLASS(semantic_vslam::SegmentationNodelet, nodelet::Nodelet)
