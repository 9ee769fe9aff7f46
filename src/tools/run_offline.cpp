// SPDX-FileCopyrightText: 2026 The semantic_vslam authors
// SPDX-License-Identifier: BSD-3-Clause
//
// Runs the whole system over a recording, without a ROS master.
#include <algorithm>
#include <chrono>
#include <csignal>
#include <cstdio>
#include <exception>
#include <filesystem>
#include <memory>
#include <opencv2/core.hpp>
#include <optional>
#include <string>
#include <thread>

#include "core/common/arguments.h"
#include "core/common/atomic_file.h"
#include "core/common/config_arguments.h"
#include "core/common/progress.h"
#include "core/io/image_file.h"
#include "core/io/trajectory.h"
#include "core/pipeline/sparse_slam.h"
#include "core/runtime/bounded_queue.h"
#include "core/runtime/read_ahead.h"
#include "eval/open_recording.h"
#include "eval/run_recorder.h"
#include "ros/bag_source.h"
#include "ros/node_configs.h"
#include "semantic_vslam/core/common/error.h"
#include "semantic_vslam/core/pipeline/pipeline.h"
#include "semantic_vslam/core/runtime/pipeline_runner.h"

namespace {

using namespace semantic_vslam;
namespace fs = std::filesystem;
using Clock = std::chrono::steady_clock;

constexpr const char* kUsage =
    "usage: run_offline SEQUENCE_DIR_OR_BAG --camera FILE --out DIR [options]\n"
    "Runs a TUM folder or a bag through the whole system. DIR gets trajectory.txt and keyframes.txt (TUM format),\n"
    "cloud.pcd, map.ot, mesh.ply, timing.csv, summary.json and overview.png.\n"
    "  --camera FILE        cfg/cameras/*.yaml; a bag may do without it: then its camera_info holds\n"
    "  --config FILE        YAML with any of the keys of --list-config; it may be the nodes' file: what they alone "
    "have\n"
    "                       counts for nothing here\n"
    "  --set KEY=VALUE      one key; may be repeated, holds over --config\n"
    "  --deterministic      one thread, nothing dropped, the same bytes out for the same bytes in (the default, said\n"
    "                       for the record: it refuses --realtime)\n"
    "                       (results so far are written every minute, and at every end, early or not: summary.json,\n"
    "                       written last, says how the run ended)\n"
    "  --realtime           frames come at the pace of their stamps and are decoded ahead; each "
    "stage\n"
    "                       has threads of its own, and frames that wait too long are dropped, the oldest first\n"
    "  --masks              also write masks/STAMP.png: what tracking left out, 255; and, but with --realtime,\n"
    "                       removed/STAMP.png: what each keyframe's map left out, 0..255, 128 and more\n"
    "  --start N            first frame, from 0\n"
    "  --frames N           frames to run at most\n"
    "  --color-topic, --depth-topic, --info-topic NAME   for a bag whose topics are not recognised\n"
    "  --list-config        print every key with its value, bounds and meaning\n";

// Frames decoded ahead at the pace of their stamps: one second.
constexpr std::size_t kReadAhead = 30;
// What a run that is killed loses at most.
constexpr std::chrono::seconds kWritingPeriod{60};

volatile std::sig_atomic_t stop_requested = 0;

/// The first signal ends the run and writes what there is; a second one kills as usual.
void requestStop(int signal) {
  stop_requested = signal;
  std::signal(signal, SIG_DFL);
}

const char* signalName(int signal) {
  switch (signal) {
    case SIGINT: return "interrupted (SIGINT)";
    case SIGTERM: return "terminated (SIGTERM)";
    default: return "hung up (SIGHUP)";
  }
}

struct Options {
  std::string recording, out;
  bool realtime = false, masks = false;
  std::size_t start = 0, frames = 0;
};

SystemConfig readConfig(const Arguments& arguments) {
  SystemConfig config;
  if (const auto file = arguments.value("--config")) loadSharedConfigFile(config, *file);
  applySettings(arguments, config);
  return config;
}

std::unique_ptr<FrameSource> openFolderOrBag(const Arguments& arguments) {
  if (arguments.positional().empty()) throw UsageError("which recording? Give a TUM folder or a bag");
  const std::string& path = arguments.positional()[0];
  if (fs::is_directory(path)) return std::make_unique<TumSequence>(openTumFolder(arguments));
  if (!fs::exists(path)) throw FileError("recording '" + path + "' does not exist");
  std::shared_ptr<const CameraModel> camera;
  if (const auto file = arguments.value("--camera")) camera = std::make_shared<CameraModel>(loadCameraFile(*file));
  const RecordingTopics topics{arguments.value("--color-topic").value_or(""),
                               arguments.value("--depth-topic").value_or(""),
                               arguments.value("--info-topic").value_or("")};
  return std::make_unique<BagSource>(path, camera, topics);
}

double secondsSince(Clock::time_point begin) { return std::chrono::duration<double>(Clock::now() - begin).count(); }

std::string messageOf(const std::exception_ptr& error) {
  try {
    std::rethrow_exception(error);
  } catch (const std::exception& known) {
    return known.what();
  }
}

/// The time at which a camera would have sent each frame.
class Pacer {
 public:
  void wait(Stamp stamp) {
    if (!first_) {
      first_ = stamp;
      begin_ = Clock::now();
    }
    std::this_thread::sleep_until(dueAt(stamp));
  }
  /// To be called when its wait is over. @return when it was due; when decoding was later than half a period of 30 Hz,
  /// now
  Clock::time_point givenAt(Stamp stamp) {
    const double late_ms = 1e3 * secondsSince(dueAt(stamp));
    worst_ms_ = std::max(worst_ms_, late_ms);
    constexpr double kTimersLateMs = 15.0;  // waking up late is the machine's and counts
    return late_ms > kTimersLateMs ? Clock::now() : dueAt(stamp);
  }
  double worstLatenessMs() const { return worst_ms_; }

 private:
  Clock::time_point dueAt(Stamp stamp) const { return begin_ + std::chrono::nanoseconds(stamp.ns - first_->ns); }

  std::optional<Stamp> first_;
  Clock::time_point begin_;
  double worst_ms_ = 0.0;
};

void writeMask(const std::string& folder, Stamp stamp, const cv::Mat1b& dynamic, cv::Size size) {
  const cv::Mat1b mask = dynamic.empty() ? cv::Mat1b(cv::Mat1b::zeros(size)) : cv::Mat1b(dynamic >= 128);
  writeImageFile(folder + "/" + formatStamp(stamp) + ".png", mask);
}

/// Where the results of each frame go while the system runs, and all of them at its end.
class Output {
 public:
  Output(const Options& options, const DenseConfig& dense, const FrameSource& source, std::size_t frames)
      : options_(options), dense_(dense), source_(source), recorder_(options.recording), progress_(frames, "frames") {
    report().start_s = secondsSinceProcessStart();
  }

  void add(const RgbdFrame& frame, const StepResult& step, const cv::Mat1b& truth) {
    recorder_.add(frame, step, truth);
    if (options_.masks) writeMasks(frame, step);
    const std::size_t keyframes = step.map ? step.map->keyframes() : 0;
    progress_.show(report().frames, std::to_string(keyframes) + " keyframes, " + stateName(step.tracking.state));
  }
  /// Calls write() every minute, and so seldom that it takes a twentieth of the time at most.
  template <class Write>
  void nowAndThen(const Write& write) {
    if (Clock::now() < next_writing_) return;
    const Clock::time_point begin = Clock::now();
    write();
    next_writing_ = Clock::now() + std::max<Clock::duration>(kWritingPeriod, 20 * (Clock::now() - begin));
  }
  /// @param system  Pipeline or PipelineRunner
  template <class System>
  void write(System& system, bool at_end) {
    report().wall_s = secondsSince(begin_);
    report().skipped_broken = source_.skippedBroken();
    recorder_.writeResults(options_.out, {system.slam(), system.dense(), system.times()}, dense_, source_, at_end);
  }
  /// Writes all results, whatever ended the run, and only then throws what went wrong.
  template <class System>
  void finish(System& system, const std::exception_ptr& error) {
    progress_.end();
    system.finish();
    if (report().frames == 0) {
      if (error) std::rethrow_exception(error);
      throw FileError("'" + options_.recording + "': no frame could be read");
    }
    report().ended = error ? messageOf(error) : stop_requested != 0 ? signalName(stop_requested) : "complete";
    write(system, true);
    if (error) std::rethrow_exception(error);
  }
  const std::string& folder() const { return options_.out; }
  RunReport& report() { return recorder_.report(); }

 private:
  void writeMasks(const RgbdFrame& frame, const StepResult& step) const {
    writeMask(options_.out + "/masks", frame.stamp, step.removed, frame.bgr.size());
    for (const StepResult::Mapped& keyframe : step.mapped) {
      const cv::Mat1b nothing = cv::Mat1b::zeros(frame.bgr.size());
      writeImageFile(options_.out + "/removed/" + formatStamp(keyframe.stamp) + ".png",
                     keyframe.removed.empty() ? nothing : keyframe.removed);
    }
  }

  const Options& options_;
  const DenseConfig& dense_;
  const FrameSource& source_;
  RunRecorder recorder_;
  Progress progress_;
  const Clock::time_point begin_ = Clock::now();
  Clock::time_point next_writing_ = begin_ + kWritingPeriod;
};

/// @return what give() threw, so that what was computed before can be written
template <class Give>
std::exception_ptr giveFrames(std::size_t wanted, const Give& give) {
  try {
    for (std::size_t taken = 0; taken < wanted && stop_requested == 0 && give(); ++taken) {
    }
    return nullptr;
  } catch (const std::exception&) {
    return std::current_exception();
  }
}

/// Gives the frames one by one.
void runInOrder(FrameSource& source, std::size_t wanted, const SystemConfig& config, Output& output) {
  Pipeline system(config);
  const std::exception_ptr error = giveFrames(wanted, [&] {
    const std::optional<RgbdFrame> frame = source.next();
    if (!frame) return false;
    output.add(*frame, system.step(*frame), source.groundTruthMask());
    output.nowAndThen([&] { output.write(system, false); });
    return true;
  });
  output.finish(system, error);
}

/// A frame on its way: when it was given, which is later than due where decoding cannot keep pace, and its true mask.
struct Given {
  Stamp stamp;
  Clock::time_point at;
  cv::Mat1b mask;
};

/// Gives the frames at the pace of their stamps.
void runInRealTime(FrameSource& source, std::size_t wanted, const SystemConfig& config, Output& output) {
  Pacer pacer;
  BoundedQueue<Given> on_their_way(kReadAhead, QueuePolicy::kDropOldest);
  PipelineRunner system(config, [&](const RgbdFrame& frame, const StepResult& step) {
    std::optional<Given> given = on_their_way.tryPop();
    while (given && given->stamp < frame.stamp) given = on_their_way.tryPop();  // frames that were dropped
    if (given) output.report().latency_ms.push_back(1e3 * secondsSince(given->at));
    output.add(frame, step, given ? given->mask : cv::Mat1b());
  });
  std::exception_ptr error = giveFrames(wanted, [&] {
    const std::optional<RgbdFrame> frame = source.next();
    if (!frame) return false;
    pacer.wait(frame->stamp);
    on_their_way.push({frame->stamp, pacer.givenAt(frame->stamp), source.groundTruthMask()});
    output.nowAndThen(
        [&] { system.read([&](const SparseSlam& slam) { RunRecorder::writePoses(output.folder(), slam); }); });
    return system.push(*frame);
  });
  try {
    system.finish();
  } catch (const std::exception&) {
    error = std::current_exception();  // what the sink threw
  }
  output.report().dropped_late = system.dropped();
  output.report().keyframes_passed_over = system.keyframesPassedOver();
  output.report().decoding_late_ms = pacer.worstLatenessMs();
  output.finish(system, error);
}

Options readOptions(const Arguments& arguments, const FrameSource& source) {
  if (arguments.has("--deterministic") && arguments.has("--realtime")) {
    throw UsageError("--deterministic and --realtime exclude each other");
  }
  Options options;
  options.recording = arguments.positional()[0];
  options.out = arguments.value("--out").value_or("");
  if (options.out.empty()) throw UsageError("--out DIR is missing");
  options.realtime = arguments.has("--realtime");
  options.masks = arguments.has("--masks");
  options.start = arguments.count("--start", 0);
  options.frames = arguments.count("--frames", source.size(), 1);
  if (options.start >= source.size()) {
    throw UsageError("--start " + std::to_string(options.start) + " is past the recording's " +
                     std::to_string(source.size()) + " frames");
  }
  return options;
}

int run(const Arguments& arguments, const SystemConfig& config) {
  for (const int signal : {SIGINT, SIGTERM, SIGHUP}) std::signal(signal, requestStop);
  std::unique_ptr<FrameSource> source = openFolderOrBag(arguments);
  const Options options = readOptions(arguments, *source);
  std::error_code failed;
  fs::create_directories(options.masks ? options.out + "/masks" : options.out, failed);
  if (options.masks && !failed) fs::create_directories(options.out + "/removed", failed);
  if (failed) throw FileError("output folder '" + options.out + "' cannot be made: " + failed.message());
  requireWritable(options.out + "/summary.json");
  RunRecorder::clearFolder(options.out);
  if (options.realtime) source = std::make_unique<ReadAhead>(std::move(source), kReadAhead);

  source->skip(options.start);
  const std::size_t wanted = std::min(options.frames, source->size() - options.start);
  Output output(options, config.dense, *source, wanted);
  (options.realtime ? runInRealTime : runInOrder)(*source, wanted, config, output);
  std::fputs(toText(output.report()).c_str(), stdout);
  return 0;
}

}  // namespace

int main(int argc, char** argv) {
  return runTool(argc, argv, kUsage, [&] {
    cv::setNumThreads(1);  // so that thread CPU time is all of it, and sums are added in one order
    const Arguments arguments(argc, argv,
                              {"--camera", "--out", "--config", "--set", "--start", "--frames", "--color-topic",
                               "--depth-topic", "--info-topic"},
                              {"--deterministic", "--realtime", "--masks", "--list-config"}, {0, 1});
    const SystemConfig config = readConfig(arguments);
    if (!arguments.has("--list-config")) return run(arguments, config);
    std::fputs(describe(listConfig(config)).c_str(), stdout);
    return 0;
  });
}
