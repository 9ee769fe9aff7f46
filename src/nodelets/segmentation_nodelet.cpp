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

#include "core/runtime/worker.h"
#include "core/segmentation/label_picture.h"
#include "core/segmentation/segmentation_stage.h"
#include "ros/conversions.h"
#include "ros/kept_frames.h"
#include "ros/parameters.h"
#include "ros/stage_nodelet.h"
#include "semantic_vslam/core/common/error.h"

namespace semantic_vslam {

/// The mapping nodelet decides what moves: no phi here.
struct LabellingConfig : SegmentationConfig {
  template <class Visitor>
  void visit(Visitor& v) {
    visitLabelling(v);
  }
};

struct SegmentationNodeletConfig {
  double budget_ms = 500.0;
  KeptFramesConfig frames;
  LabellingConfig segmentation;

  template <class Visitor>
  void visit(Visitor& v) {
    v.field("budget_ms", budget_ms, 1.0, 10000.0,
            "ms a keyframe may take before the diagnostics warn; keyframes come about twice a second");
    frames.visit(v);
    v.group("segmentation", segmentation);
  }
};

/// Images of keyframes -> segmentation/labels (mono8, index into label_info), segmentation/label_info (latched),
/// segmentation/overlay when watched. While the tracker has no keyframe every image is offered, so that it can
/// initialise without people, and twice a second where no keyframes come. Newest wins: what the network has no time
/// for is never labelled.
class SegmentationNodelet final : public StageNodelet {
 public:
  ~SegmentationNodelet() override { stop(); }

 private:
  void start() override;
  void stop() override;
  void run(ros::NodeHandle nh, ros::NodeHandle private_nh);
  void report(StageDiagnostics::Status& status);
  void openNetwork();
  std::string problem() const;
  void onKeyframe(const KeyframeStampedConstPtr& message);
  void onKeyframePoses(const KeyframePoseArrayConstPtr& message);

  /// Whether an image is to be labelled although it is no keyframe.
  bool isWanted(Stamp stamp) const;

  // Worker thread
  void step(Stamp stamp);
  void publish(const std_msgs::Header& header, const RgbdFrame& frame, const cv::Mat1b& labels);

  SegmentationNodeletConfig config_;
  std::optional<SegmentationStage> stage_;  // worker only; none without a network
  std::atomic<bool> network_failed_{false};
  std::atomic<bool> images_kept_{false};  // the worker can get at them
  std::atomic<bool> keyframe_seen_{false};
  std::atomic<Stamp> last_labelled_{Stamp()};

  ros::Publisher labels_publisher_, info_publisher_, overlay_publisher_;
  std::unique_ptr<StageDiagnostics> diagnostics_;
  std::unique_ptr<Worker<Stamp>> worker_;
  ros::Subscriber keyframe_subscriber_, keyframe_poses_subscriber_;
  std::unique_ptr<KeptFrames> frames_;
};

void SegmentationNodelet::stop() {
  keyframe_subscriber_.shutdown();
  keyframe_poses_subscriber_.shutdown();
  if (diagnostics_) diagnostics_->stop();
  if (frames_) frames_->close();
  worker_.reset();
  frames_.reset();
  diagnostics_.reset();
  for (ros::Publisher* publisher : {&labels_publisher_, &info_publisher_, &overlay_publisher_}) publisher->shutdown();
}

/// A network that does not load costs the labels, not the robot: everything else goes on with motion detection.
void SegmentationNodelet::openNetwork() {
  try {
    stage_.emplace(config_.segmentation);
    if (!stage_->enabled()) stage_.reset();  // no model is configured; the stage has said so
  } catch (const ModelError& error) {
    NODELET_ERROR("%s; going on without labels", error.what());
    network_failed_ = true;
  }
}

std::string SegmentationNodelet::problem() const {
  if (network_failed_) return "the network failed: there are no labels";
  return frames_ ? frames_->missing() : std::string();
}

void SegmentationNodelet::start() {
  ros::NodeHandle nh = getNodeHandle(), private_nh = getPrivateNodeHandle();
  config_ = loadParameters<SegmentationNodeletConfig>(private_nh);
  openNetwork();
  if (!stage_ && !network_failed_) return;
  diagnostics_ = std::make_unique<StageDiagnostics>(nh, private_nh, getName(), "segmentation", config_.budget_ms);
  if (stage_) run(nh, private_nh);
  diagnostics_->start(nh,
                      {[this] { return problem(); }, [this] { return worker_ ? worker_->counters() : QueueCounters(); },
                       [this](StageDiagnostics::Status& status) { report(status); }});
}

void SegmentationNodelet::run(ros::NodeHandle nh, ros::NodeHandle private_nh) {
  labels_publisher_ = nh.advertise<sensor_msgs::Image>("segmentation/labels", 5);
  overlay_publisher_ = nh.advertise<sensor_msgs::Image>("segmentation/overlay", 1);
  info_publisher_ = nh.advertise<LabelInfo>("segmentation/label_info", 1, true);
  info_publisher_.publish(toRos(stage_->labels()));

  worker_ = std::make_unique<Worker<Stamp>>(
      1, QueuePolicy::kDropOldest, [this](Stamp stamp) { step(stamp); }, WorkerPriority::kKeyframes);
  frames_ = std::make_unique<KeptFrames>(nh, private_nh, config_.frames, [this](Stamp stamp) {
    if (isWanted(stamp)) worker_->push(stamp);
  });
  images_kept_ = true;
  keyframe_subscriber_ = nh.subscribe("tracking/keyframe", 10, &SegmentationNodelet::onKeyframe, this);
  keyframe_poses_subscriber_ = nh.subscribe("tracking/keyframe_poses", 1, &SegmentationNodelet::onKeyframePoses, this);
}

bool SegmentationNodelet::isWanted(Stamp stamp) const {
  if (!images_kept_) return false;
  if (!keyframe_seen_) return true;
  return worker_->idle() && config_.segmentation.labelsAreDue(last_labelled_, stamp);
}

void SegmentationNodelet::report(StageDiagnostics::Status& status) {
  if (frames_) frames_->report(*diagnostics_, status);
}

void SegmentationNodelet::onKeyframe(const KeyframeStampedConstPtr& message) {
  keyframe_seen_ = true;
  worker_->push(fromRos(message->header.stamp));
}

void SegmentationNodelet::onKeyframePoses(const KeyframePoseArrayConstPtr& message) {
  keyframe_seen_ = !message->keyframes.empty();  // a tracker that dropped its map will start again
}

void SegmentationNodelet::step(Stamp stamp) {
  if (network_failed_ || stamp == last_labelled_) return;  // labelled before it was named a keyframe
  const std::optional<RgbdMessages> messages = frames_->waitFor(stamp);
  if (!messages) return;
  const StageDiagnostics::Step timer(*diagnostics_, stamp);
  const std::optional<RgbdFrame> frame = frames_->convert(*messages);
  if (!frame) return;
  const cv::Mat1b labels = stage_->process(*frame);
  if (!labels.empty()) {
    publish(messages->rgb->header, *frame, labels);
    last_labelled_ = stamp;
  }
  if (stage_->enabled()) return;
  network_failed_ = true;
  labels_publisher_.shutdown();  // so that nobody waits for labels any more
}

void SegmentationNodelet::publish(const std_msgs::Header& header, const RgbdFrame& frame, const cv::Mat1b& labels) {
  labels_publisher_.publish(toRos(header, "mono8", labels));
  if (overlay_publisher_.getNumSubscribers() > 0) {
    overlay_publisher_.publish(toRos(header, "bgr8", drawLabels(frame.bgr, labels, stage_->labels())));
  }
}

}  // namespace semantic_vslam

PLUGINLIB_EXPORT_CLASS(semantic_vslam::SegmentationNodelet, nodelet::Nodelet)
