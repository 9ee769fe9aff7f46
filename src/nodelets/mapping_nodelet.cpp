// SPDX-FileCopyrightText: 2026 The semantic_vslam authors
// SPDX-License-Identifier: BSD-3-Clause
#include <nodelet/nodelet.h>
#include <semantic_vslam/KeyframePoseArray.h>
#include <semantic_vslam/KeyframeStamped.h>
#include <semantic_vslam/LabelInfo.h>

#include <atomic>
#include <chrono>
#include <cmath>
#include <functional>
#include <future>
#include <memory>
#include <mutex>
#include <optional>
#include <pluginlib/class_list_macros.hpp>
#include <string>
#include <vector>

#include "semantic_vslam/core/common/error.h"
#include "semantic_vslam/core/dense/dense_mapper.h"
#include "semantic_vslam/core/segmentation/dynamic_objects.h"
#include "semantic_vslam/core/segmentation/segmentation_config.h"
#include "semantic_vslam/ros/conversions.h"
#include "semantic_vslam/ros/map_publisher.h"
#include "semantic_vslam/ros/parameters.h"
#include "semantic_vslam/ros/rgbd_converter.h"
#include "semantic_vslam/ros/rgbd_subscriber.h"
#include "semantic_vslam/ros/services.h"
#include "semantic_vslam/ros/stage_diagnostics.h"
#include "semantic_vslam/ros/stamped_buffer.h"
#include "semantic_vslam/ros/worker.h"

namespace semantic_vslam {

/// What the map needs to know of segmentation's configuration.
struct DecisionConfig {
  double phi = SegmentationConfig{}.phi;

  template <class Visitor>
  void visit(Visitor& v) {
    v.field("phi", phi, 0.0, 1.0, "eq. (5): an object moves when more than this share of its mask moves");
  }
};

struct MappingNodeletConfig {
  std::string map_frame = "map";
  std::string output_directory = ".";
  double budget_ms = 300.0;
  double labels_wait_s = 0.0;
  double mask_wait_s = 0.5;
  double publish_period_s = 1.0;
  int kept_frames = 30;
  RgbdInputConfig input;
  DecisionConfig segmentation;
  DenseConfig dense;
  MapObjectsConfig objects;

  template <class Visitor>
  void visit(Visitor& v) {
    v.text("map_frame", map_frame, "frame_id of the maps");
    v.text("output_directory", output_directory, "where ~save writes cloud.pcd and map.ot");
    v.field("budget_ms", budget_ms, 1.0, 10000.0, "ms a keyframe may take before the diagnostics warn");
    v.field("labels_wait_s", labels_wait_s, 0.0, 30.0,
            "s a keyframe waits for its labels before it enters the map without; 0 where no network runs");
    v.field("mask_wait_s", mask_wait_s, 0.0, 30.0, "s a keyframe waits for its motion mask");
    v.field("publish_period_s", publish_period_s, 0.1, 60.0, "s between publications of a map that changes");
    v.field("kept_frames", kept_frames, 2, 300, "newest images that wait for the tracker to name one of them");
    v.group("input", input);
    v.group("segmentation", segmentation);
    v.group("dense", dense);
    v.group("objects", objects);
  }
};

/// Images and poses of keyframes, motion masks and labels -> mapping/{semantic_cloud, octomap_binary, octomap_full,
/// projected_map, objects}, latched. The maps follow tracking/keyframe_poses. All work on the map is done by one
/// worker.
class MappingNodelet final : public nodelet::Nodelet {
 public:
  ~MappingNodelet() override;

 private:
  using Task = std::function<void()>;

  void onInit() override;
  void start();
  void advertiseServices(ros::NodeHandle private_nh);
  void subscribe(ros::NodeHandle nh);
  void report(StageDiagnostics::Status& status);
  void onKeyframe(const KeyframeStampedConstPtr& message);
  void onKeyframePoses(const KeyframePoseArrayConstPtr& message);
  void onLabelInfo(const LabelInfoConstPtr& message);
  void onTimer();
  void runOnWorker(const Task& task);

  // Worker thread
  void integrate(const KeyframeStamped& keyframe, std::optional<RgbdMessages> messages);
  cv::Mat1b withMovingObjects(const cv::Mat1b& mask, const cv::Mat1b& labels) const;
  void startMap(std::uint32_t map_id);
  void publishMaps();
  void save();

  MappingNodeletConfig config_;
  std::optional<RgbdConverter> converter_;  // worker only
  std::optional<DenseMapper> mapper_;       // worker only
  LabelSet label_set_;                      // worker only
  std::uint32_t map_id_ = 0;                // worker only
  std::optional<MapPublisher> publisher_;   // worker only
  std::unique_ptr<StampedBuffer<RgbdMessages>> frames_;
  StampedBuffer<cv::Mat1b> masks_{90};  // 3 s: longer than labels let a keyframe wait
  StampedBuffer<cv::Mat1b> labels_{10};
  std::atomic<bool> publication_due_{false}, motion_watched_{false};
  std::atomic<std::size_t> images_missing_{0}, masks_missing_{0}, labels_missing_{0}, keyframes_{0}, voxels_{0};

  std::unique_ptr<StageDiagnostics> diagnostics_;
  std::unique_ptr<Worker<Task>> worker_;
  ros::Subscriber mask_subscriber_;
  std::vector<ros::Subscriber> subscribers_;
  Services services_;
  ros::SteadyTimer publish_timer_;
  std::unique_ptr<RgbdSubscriber> input_;
};

MappingNodelet::~MappingNodelet() {
  mask_subscriber_.shutdown();
  for (ros::Subscriber& subscriber : subscribers_) subscriber.shutdown();
  services_.shutdown();
  publish_timer_.stop();
  if (diagnostics_) diagnostics_->stop();
  input_.reset();
  if (frames_) frames_->close();
  masks_.close();
  labels_.close();
  worker_.reset();
}

void MappingNodelet::onInit() {
  try {
    start();
  } catch (const Error& error) {
    NODELET_FATAL("%s", error.what());
    throw;  // the loader gives the nodelet up; a node ends
  }
}

void MappingNodelet::start() {
  installRosLogSink();
  ros::NodeHandle nh = getNodeHandle(), private_nh = getPrivateNodeHandle();
  config_ = loadParameters<MappingNodeletConfig>(private_nh);
  converter_.emplace(config_.input);
  mapper_.emplace(config_.dense, label_set_);
  frames_ = std::make_unique<StampedBuffer<RgbdMessages>>(config_.kept_frames);
  diagnostics_ = std::make_unique<StageDiagnostics>(nh, private_nh, getName(), "mapping", config_.budget_ms);
  publisher_.emplace(nh, config_.map_frame, config_.objects);
  worker_ = std::make_unique<Worker<Task>>(
      64, QueuePolicy::kBlock, [](const Task& task) { task(); }, WorkerPriority::kKeyframes);
  // Services wait for the worker: they get threads of their own, so that images still come in meanwhile.
  advertiseServices(getMTPrivateNodeHandle());
  subscribe(nh);
  diagnostics_->start(nh, {[this] { return input_->missing(); }, [this] { return worker_->counters(); },
                           [this](StageDiagnostics::Status& status) { report(status); }});
}

void MappingNodelet::advertiseServices(ros::NodeHandle private_nh) {
  services_.addTrigger(private_nh, "clear", [this] {
    runOnWorker([this] { startMap(map_id_); });
    return std::string("the dense map is empty");
  });
  services_.addTrigger(private_nh, "save", [this] {
    runOnWorker([this] { save(); });
    return "cloud.pcd and map.ot saved in " + config_.output_directory;
  });
}

void MappingNodelet::subscribe(ros::NodeHandle nh) {
  subscribers_.push_back(nh.subscribe("segmentation/label_info", 1, &MappingNodelet::onLabelInfo, this));
  subscribers_.push_back(nh.subscribe("tracking/keyframe_poses", 1, &MappingNodelet::onKeyframePoses, this));
  const auto keep = [](StampedBuffer<cv::Mat1b>& buffer) {
    return boost::function<void(const sensor_msgs::ImageConstPtr&)>(
        [&buffer](const sensor_msgs::ImageConstPtr& message) {
          try {
            buffer.put(fromRos(message->header.stamp), maskFromRos(message));
          } catch (const Error& error) {
            ROS_ERROR_THROTTLE(5.0, "mask refused: %s", error.what());
          }
        });
  };
  mask_subscriber_ = nh.subscribe<sensor_msgs::Image>("motion/mask", 10, keep(masks_));
  subscribers_.push_back(nh.subscribe<sensor_msgs::Image>("segmentation/labels", 5, keep(labels_)));
  // Keyframes block when the worker is behind, on a thread of their own.
  subscribers_.push_back(getMTNodeHandle().subscribe("tracking/keyframe", 50, &MappingNodelet::onKeyframe, this));
  input_ = std::make_unique<RgbdSubscriber>(nh, config_.input, [this](const RgbdMessages& messages) {
    frames_->put(fromRos(messages.rgb->header.stamp), messages);
  });
  publish_timer_ = nh.createSteadyTimer(ros::WallDuration(config_.publish_period_s),
                                        [this](const ros::SteadyTimerEvent&) { onTimer(); });
}

void MappingNodelet::report(StageDiagnostics::Status& status) {
  status.add("frames refused", converter_->refused());
  status.add("keyframes in the map", keyframes_.load());
  status.add("voxels", voxels_.load());
  status.add("keyframes without images", images_missing_.load());
  status.add("keyframes without mask", masks_missing_.load());
  status.add("keyframes without labels", labels_missing_.load());
}

/// Waits until the worker has done it; what it throws is thrown here.
void MappingNodelet::runOnWorker(const Task& task) {
  std::promise<void> done;
  worker_->push([&] {
    try {
      task();
      done.set_value();
    } catch (const Error&) {
      done.set_exception(std::current_exception());
    }
  });
  done.get_future().get();
}

void MappingNodelet::onKeyframe(const KeyframeStampedConstPtr& message) {
  // The images are taken now: while the worker waits for labels, newer ones would push them out.
  worker_->push(
      [this, message, messages = frames_->find(fromRos(message->header.stamp))] { integrate(*message, messages); });
}

void MappingNodelet::onKeyframePoses(const KeyframePoseArrayConstPtr& message) {
  worker_->push([this, message] {
    if (message->map_id != map_id_) startMap(message->map_id);
    const std::size_t rebuilds = mapper_->rebuilds();
    mapper_->updatePoses(fromRos(*message));
    if (mapper_->rebuilds() != rebuilds) publisher_->markChanged();
  });
}

void MappingNodelet::onLabelInfo(const LabelInfoConstPtr& message) {
  worker_->push([this, label_set = fromRos(*message)] {
    label_set_ = label_set;
    if (mapper_->keyframes() > 0) NODELET_WARN("the classes changed: the dense map starts anew");
    startMap(map_id_);
  });
}

void MappingNodelet::onTimer() {
  motion_watched_ = mask_subscriber_.getNumPublishers() > 0;
  if (publication_due_.exchange(true)) return;  // the last one still waits for the worker
  worker_->push([this] {
    publication_due_ = false;
    publishMaps();
  });
}

void MappingNodelet::integrate(const KeyframeStamped& keyframe, std::optional<RgbdMessages> messages) {
  const auto milliseconds = [](double seconds) { return std::chrono::milliseconds(std::lround(seconds * 1e3)); };
  const Stamp stamp = fromRos(keyframe.header.stamp);
  // The tracker may be a moment ahead of this nodelet's own pairing.
  if (!messages) messages = frames_->waitFor(stamp, std::chrono::milliseconds(500));
  if (!messages) {
    ++images_missing_;
    return;
  }
  const auto labels = labels_.waitFor(stamp, milliseconds(config_.labels_wait_s));
  if (config_.labels_wait_s > 0 && !labels) ++labels_missing_;

  const auto mask = masks_.waitFor(stamp, milliseconds(motion_watched_ ? config_.mask_wait_s : 0.0));
  if (!mask) ++masks_missing_;
  if (!mask && !labels && motion_watched_) return;  // nobody can say where people are in it: it stays out of the map

  const StageDiagnostics::Step timer(*diagnostics_, stamp);
  const std::optional<RgbdFrame> frame = converter_->convert(*messages);
  if (!frame) return;
  if (keyframe.map_id != map_id_) startMap(keyframe.map_id);
  const cv::Mat1b label_image = labels.value_or(cv::Mat1b());
  const cv::Mat1b dynamic = withMovingObjects(mask.value_or(cv::Mat1b()), label_image);
  mapper_->add(KeyframeId(keyframe.id), *frame, label_image, dynamic, fromRos(keyframe.pose));
  publisher_->markChanged();
}

/// Motion as the mask has it, and what eq. (5) removes as a whole: all of a movable object of which enough moves.
cv::Mat1b MappingNodelet::withMovingObjects(const cv::Mat1b& mask, const cv::Mat1b& labels) const {
  if (labels.empty() || (!mask.empty() && mask.size() != labels.size())) return mask;
  cv::Mat1b removed;
  decideDynamic(labels, label_set_, mask, config_.segmentation.phi, &removed);
  return mask.empty() ? removed : cv::Mat1b(cv::max(removed, mask));
}

void MappingNodelet::startMap(std::uint32_t map_id) {
  map_id_ = map_id;
  mapper_.emplace(config_.dense, label_set_);
  publisher_->markChanged();
}

void MappingNodelet::publishMaps() {
  if (mapper_->busy()) {
    mapper_->work();
    publisher_->markChanged();
  }
  keyframes_ = mapper_->keyframes();
  voxels_ = mapper_->voxels();
  publisher_->publish(*mapper_, label_set_);
}

void MappingNodelet::save() {
  mapper_->finish();
  mapper_->saveCloud(config_.output_directory + "/cloud.pcd");
  mapper_->saveOctomap(config_.output_directory + "/map.ot");
}

}  // namespace semantic_vslam

PLUGINLIB_EXPORT_CLASS(semantic_vslam::MappingNodelet, nodelet::Nodelet)
