// SPDX-FileCopyrightText: 2026 The semantic_vslam authors
// SPDX-License-Identifier: BSD-3-Clause
//
// Renders a furnished room with walking people to a bag or a TUM folder, with everything that is true about it.
#include <algorithm>
#include <atomic>
#include <condition_variable>
#include <csignal>
#include <cstdio>
#include <functional>
#include <map>
#include <memory>
#include <mutex>
#include <opencv2/core.hpp>
#include <string>
#include <thread>
#include <vector>

#include "core/common/arguments.h"
#include "core/common/progress.h"
#include "core/io/tum_writer.h"
#include "core/runtime/this_thread.h"
#include "eval/scenario_source.h"
#include "ros/recording_bag.h"
#include "semantic_vslam/core/common/error.h"

namespace {

using namespace semantic_vslam;

constexpr const char* kUsage =
    "usage: make_synthetic_bag (--out FILE.bag | --tum DIR) [options]\n"
    "Renders a furnished room with people: colour, depth as a Kinect sees it, true pose, masks and labels.\n"
    "  --out FILE.bag      TUM's topics: /camera/rgb/image_color rgb8, /camera/depth/image 32FC1 m, camera_info; and\n"
    "                      /groundtruth/pose, /groundtruth/mask (255 = person or moving), /groundtruth/labels\n"
    "  --tum DIR           a TUM folder: rgb/ depth/ mask/ labels/, lists, groundtruth.txt, camera.yaml\n"
    "  --scenario NAME     what happens (walking); --list names them\n"
    "  --seed N            textures, furniture, people and path (1)\n"
    "  --seconds S         length (as long as the scenario naturally is)\n"
    "  --size WxH          px (640x480)\n"
    "  --fps N             frames a second (30)\n"
    "  --jpeg              colour as JPEG 95 in a TUM folder, a quarter of the size\n"
    "  --lz4               compress the bag, about half the size\n"
    "  --small             a bag of a sixth of the size: bz2, and colour without noise, in steps of 4\n"
    "  --threads N         frames rendered at once (2); the result does not depend on it\n"
    "  --random-views N    instead of a scenario, N unrelated random rooms, people and views, to train networks on\n"
    "  --list              print the scenarios\n";

std::atomic<bool> interrupted{false};
static_assert(std::atomic<bool>::is_always_lock_free, "set by a signal handler");

void onSignal(int) { interrupted = true; }

/// Where frames go: a bag or a folder.
class Sink {
 public:
  virtual ~Sink() = default;
  virtual void write(const SyntheticFrame& frame) = 0;
  virtual void finish() = 0;
};

/// What must stay out of a map: people, and whatever else moves.
cv::Mat1b dynamicMask(const SyntheticFrame& frame) { return frame.person_mask | frame.moving_mask; }

/// Six bits a channel, which nobody sees and bz2 makes half as large.
cv::Mat3b coarseColour(const cv::Mat3b& bgr) {
  cv::Mat3b coarse = bgr.clone();
  for (cv::Vec3b& pixel : coarse) {
    for (int channel = 0; channel < 3; ++channel) pixel[channel] = static_cast<std::uint8_t>((pixel[channel] & ~3) + 2);
  }
  return coarse;
}

class BagSink : public Sink {
 public:
  BagSink(const std::string& path, const CameraIntrinsics& camera, rosbag::CompressionType compression)
      : bag_(path, camera, compression), coarse_(compression == rosbag::compression::BZ2) {}
  void write(const SyntheticFrame& frame) override {
    const Stamp stamp = frame.frame.stamp;
    bag_.writePoseMessage(stamp, frame.T_world_camera);
    bag_.writeColour(stamp, coarse_ ? coarseColour(frame.frame.bgr) : frame.frame.bgr);
    bag_.writeDepth(stamp, frame.frame.depth_m);
    bag_.writeMask(stamp, dynamicMask(frame));
    bag_.writeLabels(stamp, frame.labels);
  }
  void finish() override { bag_.close(); }

 private:
  RecordingBag bag_;
  const bool coarse_;
};

class FolderSink : public Sink {
 public:
  FolderSink(const std::string& path, const CameraIntrinsics& camera, bool jpeg)
      : writer_(path, camera, jpeg ? TumWriter::ColorFormat::kJpeg95 : TumWriter::ColorFormat::kPng) {}
  void write(const SyntheticFrame& frame) override {
    writer_.write({frame.frame.stamp, frame.frame.bgr, frame.frame.depth_m, dynamicMask(frame), frame.labels,
                   frame.T_world_camera});
  }
  void finish() override { writer_.finish(); }

 private:
  TumWriter writer_;
};

/// Makes items 0..count-1 on several threads and hands them on one by one in order.
class OrderedProduction {
 public:
  using Make = std::function<SyntheticFrame(int index)>;

  OrderedProduction(int count, int threads, Make make) : count_(count), ahead_(2 * threads), make_(std::move(make)) {
    for (int i = 0; i < threads; ++i) workers_.emplace_back([this] { work(); });
  }
  ~OrderedProduction() {
    {
      std::lock_guard<std::mutex> lock(mutex_);
      stopped_ = true;
    }
    changed_.notify_all();
    for (auto& worker : workers_) worker.join();
  }

  /// @return the next item in order. What make() threw for it is thrown here.
  SyntheticFrame take() {
    std::unique_lock<std::mutex> lock(mutex_);
    changed_.wait(lock, [this] { return error_ || made_.count(taken_) != 0; });
    if (error_) std::rethrow_exception(error_);
    SyntheticFrame item = std::move(made_.at(taken_));
    made_.erase(taken_++);
    lock.unlock();
    changed_.notify_all();
    return item;
  }

 private:
  void work() {
    nameThread("render");
    std::unique_lock<std::mutex> lock(mutex_);
    while (true) {
      changed_.wait(lock, [this] { return stopped_ || started_ >= count_ || started_ < taken_ + ahead_; });
      if (stopped_ || started_ >= count_) return;
      const int index = started_++;
      lock.unlock();
      std::exception_ptr error;
      SyntheticFrame item;
      try {
        item = make_(index);
      } catch (...) {
        error = std::current_exception();
      }
      lock.lock();
      if (error) error_ = error;
      made_[index] = std::move(item);
      changed_.notify_all();
    }
  }

  const int count_, ahead_;
  const Make make_;
  std::mutex mutex_;
  std::condition_variable changed_;
  std::map<int, SyntheticFrame> made_;  // guarded by mutex_
  int started_ = 0, taken_ = 0;         // guarded by mutex_
  bool stopped_ = false;                // guarded by mutex_
  std::exception_ptr error_;            // guarded by mutex_
  std::vector<std::thread> workers_;    // started last
};

void produce(int count, int threads, const OrderedProduction::Make& make, Sink& sink) {
  OrderedProduction production(count, threads, make);
  Progress progress(static_cast<std::size_t>(count), "frames");
  for (int i = 0; i < count; ++i) {
    sink.write(production.take());
    if (interrupted) throw Error("interrupted: nothing is left of the unfinished recording");
    progress.show(static_cast<std::size_t>(i) + 1);
  }
  sink.finish();
}

void printScenarios() {
  for (const auto& [name, description] : listScenarios()) std::printf("%-20s %s\n", name.c_str(), description.c_str());
}

rosbag::CompressionType compressionOf(const Arguments& arguments) {
  if (arguments.has("--small") && arguments.has("--lz4")) throw UsageError("give either --small or --lz4");
  if (arguments.has("--small")) return rosbag::compression::BZ2;
  return arguments.has("--lz4") ? rosbag::compression::LZ4 : rosbag::compression::Uncompressed;
}

SyntheticFrame renderRandomView(std::uint64_t seed, int index, const CameraIntrinsics& camera) {
  const SyntheticRoom room(makeRandomView(seed * 1000003ULL + static_cast<std::uint64_t>(index)), camera);
  SyntheticFrame frame = room.render(kRandomViewTimeS);
  frame.frame.stamp = Stamp::fromSeconds(1000.0 + index);  // one a second, so that names tell the index
  return frame;
}

int run(const Arguments& arguments) {
  if (arguments.has("--list")) {
    printScenarios();
    return 0;
  }
  const auto bag = arguments.value("--out"), folder = arguments.value("--tum");
  if (bag.has_value() == folder.has_value()) throw UsageError("give either --out FILE.bag or --tum DIR");
  if (folder && arguments.has("--small")) throw UsageError("--small is for a bag (--out); a folder takes --jpeg");
  const auto camera = syntheticCamera(arguments.value("--size").value_or("640x480"));
  const auto seed = static_cast<std::uint64_t>(arguments.count("--seed", 1));
  const int threads = static_cast<int>(std::clamp<std::size_t>(arguments.count("--threads", 2), 1, 64));
  const auto views = static_cast<int>(arguments.count("--random-views", 1, 1));
  const bool random = arguments.has("--random-views");

  std::unique_ptr<SyntheticRoom> room;
  if (!random) {
    const double seconds = arguments.has("--seconds") ? arguments.positiveNumber("--seconds", 0.0) : 0.0;
    Scenario scenario = makeScenario(arguments.value("--scenario").value_or("walking"), seed, seconds);
    scenario.fps = arguments.positiveNumber("--fps", 30.0);
    if (arguments.has("--small")) scenario.sensor.color_noise = 0.0;
    room = std::make_unique<SyntheticRoom>(scenario, camera);
  }
  std::unique_ptr<Sink> sink;
  if (bag) {
    sink = std::make_unique<BagSink>(*bag, camera, compressionOf(arguments));
  } else {
    sink = std::make_unique<FolderSink>(*folder, camera, arguments.has("--jpeg"));
  }
  std::signal(SIGINT, onSignal);
  std::signal(SIGTERM, onSignal);
  cv::setNumThreads(1);
  if (random) {
    produce(
        views, threads, [&](int i) { return renderRandomView(seed, i, camera); }, *sink);
  } else {
    produce(
        room->frameCount(), threads, [&](int i) { return room->render(room->frameTime(i)); }, *sink);
  }
  std::printf("%s\n", (bag ? *bag : *folder).c_str());
  return 0;
}

}  // namespace

int main(int argc, char** argv) {
  return runTool(argc, argv, kUsage, [&] {
    return run(Arguments(
        argc, argv,
        {"--out", "--tum", "--scenario", "--seed", "--seconds", "--size", "--fps", "--threads", "--random-views"},
        {"--jpeg", "--lz4", "--small", "--list"}, {}));
  });
}
