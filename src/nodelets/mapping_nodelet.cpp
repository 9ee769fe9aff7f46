// SPDX-FileCopyrightText: 2026 The semantic_vslam authors
// SPDX-License-Identifier: BSD-3-Clause
#include <semantic_vslam/KeyframePoseArray.h>
#include <semantic_vslam/KeyframeStamped.h>
#include <semantic_vslam/LabelInfo.h>

#include <atomic>
#include <cstdint>
#include <functional>
#include <future>
#include <memory>
#include <mutex>
#include <optional>
#include <pluginlib/class_list_macros.hpp>
#include <set>
#include <string>
#include <utility>
#include <vector>

#include "core/dense/dense_mapper.h"
#include "core/dense/waiting_keyframes.h"
#include "core/runtime/worker.h"
#include "ros/conversions.h"
#include "ros/keyframe_inputs.h"
#include "ros/map_publisher.h"
#include "ros/parameters.h"
#include "ros/services.h"
#include "ros/stage_nodelet.h"
#include "semantic_vslam/core/common/error.h"
#include "semantic_vslam/core/common/label_set.h"

namespace semantic_vslam {

struct MappingNodeletConfig {
  std::string map_frame = "map";
  std::string output_directory = ".";
  double budget_ms = 300.0;
  double publish_period_s = 1.0;
  KeyframeInputsConfig inputs;
  DenseConfig dense;
  MapObjectsConfig objects;

  template <class Visitor>
  void visit(Visitor& v) {
    v.text("map_frame", map_frame, "frame_id of the maps");
    v.text("output_directory", output_directory, "where ~save writes cloud.pcd and map.ot");
    v.field("budget_ms", budget_ms, 1.0, 10000.0, "ms a keyframe may take before the diagnostics warn");
    v.field("publish_period_s", publish_period_s, 0.1, 60.0, "s between publications of a map that changes");
    inputs.visit(v);
    v.group("dense", dense);
    v.group("objects", objects);
  }
};

/// Images and poses of keyframes, motion masks and labels -> mapping/{semantic_cloud, octomap_binary, octomap_full,
/// projected_map, objects}. The maps follow tracking/keyframe_poses. All work on the map is done by one
/// worker.
class MappingNodelet final : public StageNodelet {
 public:
  ~MappingNodelet() override { stop(); }

 private:
  using Task = std::function<void()>;
  static constexpr std::size_t kQueue = 64;

  void start() override;
  void stop() override;
  void advertiseServices(ros::NodeHandle private_nh);
  void subscribe(ros::NodeHandle nh);
  void report(StageDiagnostics::Status& status);
  bool isOfNewestMap(std::uint32_t map_id);
  void onKeyframe(const KeyframeStampedConstPtr& message);
  void onKeyframePoses(const KeyframePoseArrayConstPtr& message);
  void onLabelInfo(const LabelInfoConstPtr& message);
  void onTimer();
  void runOnWorker(const Task& task);
  void wakeWorker();

  // Worker thread
  void work(const Task& task);
  void takeChanges();
  void integrate(const KeyframeStamped& keyframe, const KeyframeImages& images);
  void placeWaiting(const std::vector<KeyframePose>& poses);
  void startMap(std::uint32_t map_id);
  void publishMaps();
  void save();

  MappingNodeletConfig config_;
  std::optional<DenseMapper> mapper_;      // worker only
  LabelSet label_set_;                     // worker only
  std::uint32_t map_id_ = 0;               // worker only
  std::vector<KeyframePose> poses_;        // worker only; newest known
  WaitingKeyframes waiting_;               // worker only
  std::optional<MapPublisher> publisher_;  // worker only
  std::size_t published_rebuilds_ = 0;     // worker only
  ros::SteadyTime next_publication_;       // worker only; not before
  std::mutex mutex_;
  KeyframePoseArrayConstPtr new_poses_;    // guarded by mutex_
  std::optional<LabelSet> new_label_set_;  // guarded by mutex_
  std::set<std::uint32_t> left_maps_;      // guarded by mutex_
  std::atomic<bool> publication_due_{false};
  std::atomic<double> publication_s_{0.0};  // what the last one took
  std::atomic<std::uint32_t> newest_map_id_{0};
  std::atomic<std::size_t> keyframes_{0}, voxels_{0}, waiting_count_{0};

  std::unique_ptr<StageDiagnostics> diagnostics_;
  std::unique_ptr<Worker<Task>> worker_;
  std::vector<ros::Subscriber> subscribers_;
  Services services_;
  ros::SteadyTimer publish_timer_;
  std::unique_ptr<KeyframeInputs> inputs_;  // gather() by the worker only
};

void MappingNodelet::stop() {
  if (diagnostics_) diagnostics_->stop();
  if (inputs_) inputs_->close();  // the worker waits for nothing any more, nor does who waits for the worker
  for (ros::Subscriber& subscriber : subscribers_) subscriber.shutdown();
  services_.shutdown();
  publish_timer_.stop();
  worker_.reset();
  inputs_.reset();
  diagnostics_.reset();
  publisher_.reset();
}

void MappingNodelet::start() {
  ros::NodeHandle nh = getNodeHandle(), private_nh = getPrivateNodeHandle();
  config_ = loadParameters<MappingNodeletConfig>(private_nh);
  if (!config_.dense.enabled) {
    NODELET_INFO("dense.enabled is false: no dense map is made");
    return;
  }
  mapper_.emplace(config_.dense, label_set_);
  diagnostics_ = std::make_unique<StageDiagnostics>(nh, private_nh, getName(), "mapping", config_.budget_ms);
  publisher_.emplace(nh, config_.map_frame, config_.objects);
  worker_ = std::make_unique<Worker<Task>>(
      kQueue, QueuePolicy::kBlock, [this](const Task& task) { work(task); }, WorkerPriority::kKeyframes);
  inputs_ = std::make_unique<KeyframeInputs>(nh, private_nh, config_.inputs);
  // Services wait for the worker: they get threads of their own, so that images still come in meanwhile.
  advertiseServices(getMTPrivateNodeHandle());
  subscribe(nh);
  diagnostics_->start(nh, {[this] { return inputs_->missing(); }, [this] { return worker_->counters(); },
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
  // When the worker is far behind keyframes block, but not the thread that takes the images in.
  subscribers_.push_back(getMTNodeHandle().subscribe("tracking/keyframe", 50, &MappingNodelet::onKeyframe, this));
  publish_timer_ = nh.createSteadyTimer(ros::WallDuration(config_.publish_period_s),
                                        [this](const ros::SteadyTimerEvent&) { onTimer(); });
}

void MappingNodelet::report(StageDiagnostics::Status& status) {
  inputs_->report(*diagnostics_, status);
  status.add("keyframes in the map", keyframes_.load());
  status.add("keyframes whose place is not known yet", waiting_count_.load());
  status.add("voxels", voxels_.load());
  status.addf("last publication", "%.2f s", publication_s_.load());
  if (worker_->waiting() > kQueue / 2) {
    status.mergeSummaryf(diagnostic_msgs::DiagnosticStatus::WARN, "%zu keyframes wait to be mapped",
                         worker_->waiting());
  }
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

/// What came in on the images' thread must not block there: it is left in its slot, and taken with the next task.
void MappingNodelet::wakeWorker() {
  if (worker_->waiting() == 0) worker_->push([] {});
}

/// Keyframes and poses come on topics of their own, in no order: what still comes of a map that was left is not the
/// newest.
bool MappingNodelet::isOfNewestMap(std::uint32_t map_id) {
  std::lock_guard<std::mutex> lock(mutex_);
  if (left_maps_.count(map_id) > 0) return false;
  if (map_id != newest_map_id_) left_maps_.insert(newest_map_id_.exchange(map_id));
  return true;
}

void MappingNodelet::onKeyframe(const KeyframeStampedConstPtr& message) {
  if (!isOfNewestMap(message->map_id)) return;
  // The images are taken now: while the worker waits for labels, newer ones push them out.
  worker_->push(
      [this, message, images = inputs_->imagesNow(fromRos(message->header.stamp))] { integrate(*message, images); });
}

void MappingNodelet::onKeyframePoses(const KeyframePoseArrayConstPtr& message) {
  if (!isOfNewestMap(message->map_id)) return;
  {
    std::lock_guard<std::mutex> lock(mutex_);
    new_poses_ = message;
  }
  wakeWorker();
}

void MappingNodelet::onLabelInfo(const LabelInfoConstPtr& message) {
  {
    std::lock_guard<std::mutex> lock(mutex_);
    new_label_set_ = fromRos(*message);
  }
  wakeWorker();
}

void MappingNodelet::onTimer() {
  publication_due_ = true;
  wakeWorker();
}

/// A large map takes seconds to publish: three quarters of the time are left to the keyframes that wait.
void MappingNodelet::work(const Task& task) {
  constexpr int kRestPerWork = 3;
  takeChanges();
  task();
  const ros::SteadyTime begin = ros::SteadyTime::now();
  if (begin < next_publication_ || !publication_due_.exchange(false)) return;
  publishMaps();
  const ros::WallDuration taken = ros::SteadyTime::now() - begin;
  publication_s_ = taken.toSec();
  next_publication_ = ros::SteadyTime::now() + taken * kRestPerWork;
}

void MappingNodelet::takeChanges() {
  std::optional<LabelSet> label_set;
  KeyframePoseArrayConstPtr poses;
  {
    std::lock_guard<std::mutex> lock(mutex_);
    label_set.swap(new_label_set_);
    poses.swap(new_poses_);
  }
  // The same classes come again when their publisher is connected anew.
  if (label_set && label_set->classes != label_set_.classes) {
    label_set_ = *label_set;
    if (mapper_->keyframes() > 0) NODELET_WARN("the classes changed: the dense map starts anew");
    startMap(map_id_);
  }
  if (poses && poses->map_id == newest_map_id_) {
    if (poses->map_id != map_id_) startMap(poses->map_id);
    poses_ = fromRos(*poses);
    placeWaiting(poses_);
    mapper_->updatePoses(poses_);
  }
}

void MappingNodelet::integrate(const KeyframeStamped& keyframe, const KeyframeImages& images) {
  if (keyframe.map_id != newest_map_id_) return;  // of a map that is gone
  const Stamp stamp = fromRos(keyframe.header.stamp);
  auto input = inputs_->gather(KeyframeId(keyframe.id), stamp, images, label_set_);
  if (!input) return;
  const StageDiagnostics::Step timer(*diagnostics_, stamp);
  if (keyframe.map_id != map_id_) startMap(keyframe.map_id);
  waiting_.add(std::move(*input));
  placeWaiting(poses_);  // newer than its own, where they know it
  if (keyframe.placed) placeWaiting({fromRos(keyframe)});
}

/// Adds the waiting keyframes whose place in the world is known by now to the map.
void MappingNodelet::placeWaiting(const std::vector<KeyframePose>& poses) {
  const std::size_t before = waiting_.size();
  waiting_.place(poses, *mapper_);
  waiting_count_ = waiting_.size();
  if (waiting_.size() != before) publisher_->markChanged();
}

void MappingNodelet::startMap(std::uint32_t map_id) {
  map_id_ = map_id;
  poses_.clear();
  waiting_.clear();
  mapper_.emplace(config_.dense, label_set_);
  publisher_->markChanged();
}

void MappingNodelet::publishMaps() {
  mapper_->work();
  // During a rebuild the old map is served; it may also have ended elsewhere, as in save().
  if (std::exchange(published_rebuilds_, mapper_->rebuilds()) != mapper_->rebuilds()) publisher_->markChanged();
  keyframes_ = mapper_->keyframes();
  voxels_ = mapper_->voxels();
  publisher_->publish(*mapper_, label_set_);
}

void MappingNodelet::save() {
  if (mapper_->keyframes() == 0) {
    throw Error("the dense map is empty; the files in " + config_.output_directory + " are not touched");
  }
  mapper_->finish();
  mapper_->saveCloud(config_.output_directory + "/cloud.pcd");
  mapper_->saveOctomap(config_.output_directory + "/map.ot");
}

}  // namespace semantic_vslam

PLUGINLIB_EXPORT_CLASS(semantic_vslam::MappingNodelet, nodelet::Nodelet)
