// SPDX-FileCopyrightText: 2026 The semantic_vslam authors
// SPDX-License-Identifier: BSD-3-Clause
#include <semantic_vslam/LabelInfo.h>
#include <semantic_vslam/MotionReport.h>
#include <semantic_vslam/MotionThresholdsConfig.h>

#include <algorithm>
#include <atomic>
#include <memory>
#include <mutex>
#include <optional>
#include <pluginlib/class_list_macros.hpp>
#include <utility>
#include <vector>

#include "core/motion/flow_colour.h"
#include "core/motion/motion_detector.h"
#include "core/runtime/worker.h"
#include "ros/conversions.h"
#include "ros/parameters.h"
#include "ros/rgbd_converter.h"
#include "ros/rgbd_subscriber.h"
#include "ros/stage_nodelet.h"
#include "ros/threshold_server.h"
#include "semantic_vslam/core/common/error.h"

namespace semantic_vslam {

constexpr std::size_t kMostWaiting = 10;  // label images; older ones would come too late in any case

struct MotionNodeletConfig {
  double budget_ms = 33.0;
  RgbdInputConfig input;
  MotionConfig motion;

  template <class Visitor>
  void visit(Visitor& v) {
    v.field("budget_ms", budget_ms, 1.0, 1000.0, "ms a frame may take before the diagnostics warn; 33 keeps 30 Hz");
    v.group("input", input);
    v.group("motion", motion);
  }
};

/// Images -> motion/mask (mono8, probability 0..255 that a pixel is on a moving object), motion/flow_image when
/// watched, motion/report. Labels, late as they are, are carried forward into the mask.
class MotionNodelet final : public StageNodelet {
 public:
  ~MotionNodelet() override { stop(); }

 private:
  void start() override;
  void stop() override;
  void onLabels(const sensor_msgs::ImageConstPtr& message);
  void onLabelInfo(const LabelInfoConstPtr& message);

  // Worker thread
  void step(const RgbdMessages& messages);
  void startAnew(Stamp stamp);
  void takeChanges();
  void publish(const std_msgs::Header& header, const MotionResult& result, double cpu_ms);
  void describe(StageDiagnostics::Status& status);  // callback thread

  MotionNodeletConfig config_;
  std::optional<RgbdConverter> converter_;  // worker only
  std::optional<MotionDetector> detector_;  // worker only
  Stamp last_stamp_;                        // worker only
  std::mutex mutex_;
  std::optional<MotionConfig> new_config_;               // guarded by mutex_
  std::vector<std::pair<Stamp, cv::Mat1b>> new_labels_;  // guarded by mutex_
  std::optional<LabelSet> label_set_;                    // guarded by mutex_; labels wait for it
  MotionReport newest_;                                  // guarded by mutex_
  std::atomic<std::size_t> labels_taken_{0}, labels_late_{0};

  ros::Publisher mask_publisher_, flow_publisher_, report_publisher_;
  std::unique_ptr<StageDiagnostics> diagnostics_;
  std::unique_ptr<Worker<RgbdMessages>> worker_;
  std::unique_ptr<ThresholdServer<MotionThresholdsConfig, MotionNodeletConfig>> thresholds_;
  ros::Subscriber labels_subscriber_, label_info_subscriber_;
  std::unique_ptr<RgbdSubscriber> input_;
};

void MotionNodelet::stop() {
  // Callbacks stop first, then the worker, then what both use.
  labels_subscriber_.shutdown();
  label_info_subscriber_.shutdown();
  thresholds_.reset();
  if (diagnostics_) diagnostics_->stop();
  input_.reset();
  worker_.reset();
  diagnostics_.reset();
  for (ros::Publisher* publisher : {&mask_publisher_, &flow_publisher_, &report_publisher_}) publisher->shutdown();
}

void MotionNodelet::start() {
  ros::NodeHandle nh = getNodeHandle(), private_nh = getPrivateNodeHandle();
  config_ = loadParameters<MotionNodeletConfig>(private_nh);
  converter_.emplace(config_.input);
  detector_.emplace(config_.motion);

  mask_publisher_ = nh.advertise<sensor_msgs::Image>("motion/mask", 5);
  flow_publisher_ = nh.advertise<sensor_msgs::Image>("motion/flow_image", 1);
  report_publisher_ = nh.advertise<MotionReport>("motion/report", 30);
  diagnostics_ = std::make_unique<StageDiagnostics>(nh, private_nh, getName(), "motion", config_.budget_ms);
  worker_ = std::make_unique<Worker<RgbdMessages>>(config_.input.queue_size, QueuePolicy::kDropOldest,
                                                   [this](const RgbdMessages& messages) { step(messages); });
  thresholds_ = std::make_unique<ThresholdServer<MotionThresholdsConfig, MotionNodeletConfig>>(
      private_nh, config_, [this](const MotionNodeletConfig& accepted) {
        validateConfig(accepted);
        std::lock_guard<std::mutex> lock(mutex_);
        new_config_ = accepted.motion;
      });
  label_info_subscriber_ = nh.subscribe("segmentation/label_info", 1, &MotionNodelet::onLabelInfo, this);
  labels_subscriber_ = nh.subscribe("segmentation/labels", 5, &MotionNodelet::onLabels, this);
  input_ = std::make_unique<RgbdSubscriber>(nh, private_nh, config_.input,
                                            [this](const RgbdMessages& messages) { worker_->push(messages); });
  diagnostics_->start(nh, {[this] { return input_->missing(); }, [this] { return worker_->counters(); },
                           [this](StageDiagnostics::Status& status) { describe(status); }});
}

void MotionNodelet::describe(StageDiagnostics::Status& status) {
  diagnostics_->addFault(status, "frames refused", converter_->refused());
  status.add("label images used", labels_taken_.load());
  status.add("label images too late", labels_late_.load());
  std::lock_guard<std::mutex> lock(mutex_);
  status.add("model", newest_.model == MotionReport::MODEL_RIGID_FLOW   ? "rigid_flow"
                      : newest_.model == MotionReport::MODEL_HOMOGRAPHY ? "homography"
                                                                        : "none");
  status.add("inliers", newest_.inliers);
  status.add("dynamic share", newest_.dynamic_share);
}

void MotionNodelet::onLabelInfo(const LabelInfoConstPtr& message) {
  std::lock_guard<std::mutex> lock(mutex_);
  label_set_ = fromRos(*message);
}

void MotionNodelet::onLabels(const sensor_msgs::ImageConstPtr& message) {
  try {
    std::lock_guard<std::mutex> lock(mutex_);
    new_labels_.emplace_back(fromRos(message->header.stamp), maskFromRos(message));
    if (new_labels_.size() > kMostWaiting) new_labels_.erase(new_labels_.begin());
  } catch (const Error& error) {
    NODELET_ERROR_THROTTLE(5.0, "labels refused: %s", error.what());
  }
}

/// What waits for a frame after this one is of the recording before.
void MotionNodelet::startAnew(Stamp stamp) {
  NODELET_WARN("stamps went back: motion starts anew");
  last_stamp_ = Stamp();
  std::lock_guard<std::mutex> lock(mutex_);
  new_labels_.erase(std::remove_if(new_labels_.begin(), new_labels_.end(),
                                   [stamp](const auto& labels) { return labels.first > stamp; }),
                    new_labels_.end());
}

/// Labels that are faster than their frame, or than the first list of classes, wait for it.
void MotionNodelet::takeChanges() {
  std::optional<MotionConfig> new_config;
  std::vector<std::pair<Stamp, cv::Mat1b>> new_labels;
  LabelSet label_set;
  {
    std::lock_guard<std::mutex> lock(mutex_);
    new_config.swap(new_config_);
    if (label_set_ && !new_labels_.empty()) {
      label_set = *label_set_;
      const auto waiting = std::stable_partition(new_labels_.begin(), new_labels_.end(),
                                                 [this](const auto& labels) { return labels.first <= last_stamp_; });
      new_labels.assign(new_labels_.begin(), waiting);
      new_labels_.erase(new_labels_.begin(), waiting);
    }
  }
  if (new_config) detector_->setConfig(*new_config);
  for (const auto& [stamp, labels] : new_labels) {
    ++(detector_->addLabels(stamp, labels, label_set) ? labels_taken_ : labels_late_);
  }
}

void MotionNodelet::step(const RgbdMessages& messages) {
  const StageDiagnostics::Step timer(*diagnostics_, fromRos(messages.rgb->header.stamp));
  const std::optional<RgbdFrame> frame = converter_->convert(messages);
  if (!frame) return;
  if (frame->stamp < last_stamp_) startAnew(frame->stamp);
  takeChanges();
  last_stamp_ = frame->stamp;
  const MotionResult result = detector_->detect(*frame);
  publish(messages.rgb->header, result, timer.cpuMs());
}

void MotionNodelet::publish(const std_msgs::Header& header, const MotionResult& result, double cpu_ms) {
  auto report = boost::make_shared<MotionReport>();
  report->header = header;
  report->model = result.model == MotionModel::kRigidFlow    ? MotionReport::MODEL_RIGID_FLOW
                  : result.model == MotionModel::kHomography ? MotionReport::MODEL_HOMOGRAPHY
                                                             : MotionReport::MODEL_NONE;
  report->inliers = static_cast<std::uint32_t>(result.inliers);
  report->dynamic_share = static_cast<float>(result.dynamic_share);
  report->cpu_ms = static_cast<float>(cpu_ms);
  if (result.labels) report->labels = toRos(*result.labels);
  report_publisher_.publish(report);  // first: who gets the mask knows by then whose labels are in it
  mask_publisher_.publish(toRos(header, "mono8", result.dynamic));
  if (flow_publisher_.getNumSubscribers() > 0 && !result.flow_px.empty()) {
    flow_publisher_.publish(toRos(header, "bgr8", flowPicture(result.flow_px)));
  }
  std::lock_guard<std::mutex> lock(mutex_);
  newest_ = *report;
}

}  // namespace semantic_vslam

PLUGINLIB_EXPORT_CLASS(semantic_vslam::MotionNodelet, nodelet::Nodelet)
