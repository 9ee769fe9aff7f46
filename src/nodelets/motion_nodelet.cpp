// SPDX-FileCopyrightText: 2026 The semantic_vslam authors
// SPDX-License-Identifier: BSD-3-Clause
#include <semantic_vslam/KeyframePoseArray.h>
#include <semantic_vslam/LabelInfo.h>
#include <semantic_vslam/MotionReport.h>
#include <semantic_vslam/MotionThresholdsConfig.h>
#include <semantic_vslam/TrackingReport.h>

#include <boost/make_shared.hpp>
#include <mutex>
#include <pluginlib/class_list_macros.hpp>

#include "core/motion/flow_colour.h"
#include "core/motion/mask_picture.h"
#include "core/runtime/motion_runner.h"
#include "ros/conversions.h"
#include "ros/node_configs.h"
#include "ros/parameters.h"
#include "ros/stage_nodelet.h"
#include "ros/threshold_server.h"

namespace semantic_vslam {

/// Images -> motion/mask (mono8, probability 0..255 that a pixel is on a moving object), motion/report, and when
/// watched motion/overlay and motion/flow_image. Labels and keyframe poses, late as they are, count from the next frame
/// on.
class MotionTopics {
 public:
  explicit MotionTopics(const NodeletHandles& node);

 private:
  void publish(const RgbdFrame& frame, const MotionResult& motion, StepTime time);
  void describe(StageDiagnostics::Status& status);

  const MotionNodeConfig config_;
  ros::Publisher mask_, overlay_, flow_, report_;
  StageDiagnostics diagnostics_;
  std::mutex mutex_;
  MotionReport newest_;  // guarded by mutex_
  MotionRunner runner_;
  ThresholdServer<MotionThresholdsConfig, MotionNodeConfig> thresholds_;
  NodeInputs inputs_;
};

MotionTopics::MotionTopics(const NodeletHandles& node)
    : config_(loadParameters<MotionNodeConfig>(node.private_nh)),
      mask_(node.nh.advertise<sensor_msgs::Image>("motion/mask", 5)),
      overlay_(node.nh.advertise<sensor_msgs::Image>("motion/overlay", 1)),
      flow_(node.nh.advertise<sensor_msgs::Image>("motion/flow_image", 1)),
      report_(node.nh.advertise<MotionReport>("motion/report", 30)),
      diagnostics_(node, "motion", config_.budget_ms),
      runner_(MotionStage(config_.motion, config_.removal), config_.input.queue_size,
              [this](const auto& frame, const auto& motion, StepTime time) { publish(frame, motion, time); }),
      thresholds_(node.private_nh, config_,
                  [this](const MotionNodeConfig& accepted) {
                    runner_.take(accepted.motion);
                    runner_.take(accepted.removal);
                  }),
      inputs_(node) {
  inputs_.topic<LabelInfo>("segmentation/label_info", 1, [this](const auto& info) { runner_.take(fromRos(*info)); });
  inputs_.topic<sensor_msgs::Image>("segmentation/labels", 5,
                                    [this](const auto& labels) { runner_.take(labelsFromRos(labels)); });
  inputs_.topic<KeyframePoseArray>("tracking/keyframe_poses", 1,
                                   [this](const auto& poses) { runner_.take(fromRos(*poses)); });
  inputs_.topic<TrackingReport>("tracking/state", 10, [this](const auto& report) {
    if (report->state != TrackingReport::OK) return;
    runner_.take(TimedPose{fromRos(report->header.stamp), fromRos(report->camera)});
  });
  inputs_.images(config_.input, [this](PendingFrame frame) { runner_.push(std::move(frame)); });
  inputs_.report(
      diagnostics_, [this] { return runner_.counters(); }, [this](auto& status) { describe(status); });
}

void MotionTopics::publish(const RgbdFrame& frame, const MotionResult& motion, StepTime time) {
  const std_msgs::Header header = headerOf(frame);
  const auto report = boost::make_shared<MotionReport>(toRos(header, motion));
  report->cpu_ms = static_cast<float>(time.cpu_ms);
  report_.publish(report);
  mask_.publish(toRos(header, "mono8", motion.dynamic));
  if (overlay_.getNumSubscribers() > 0) {
    overlay_.publish(toRos(header, "bgr8", maskPicture(frame.bgr, motion.dynamic)));
  }
  if (flow_.getNumSubscribers() > 0 && !motion.flow_px.empty()) {
    flow_.publish(toRos(header, "bgr8", flowPicture(motion.flow_px)));
  }
  diagnostics_.record(frame.stamp, time);
  const std::lock_guard<std::mutex> lock(mutex_);
  newest_ = *report;
}

void MotionTopics::describe(StageDiagnostics::Status& status) {
  status.add("label images used", runner_.labelsTaken());
  status.add("label images too late", runner_.labelsTooLate());
  diagnostics_.addFault(status, "frames too far apart to tell motion", runner_.framesFarApart(),
                        "more than 0.5 s after the one before by their stamps");
  const std::lock_guard<std::mutex> lock(mutex_);
  status.add("model", motionModelName(static_cast<MotionModel>(newest_.model)));
  status.add("inliers", newest_.inliers);
  status.add("dynamic share", newest_.dynamic_share);
}

using MotionNodelet = StageNodelet<MotionTopics>;

}  // namespace semantic_vslam

PLUGINLIB_EXPORT_CLASS(semantic_vslam::MotionNodelet, nodelet::Nodelet)
