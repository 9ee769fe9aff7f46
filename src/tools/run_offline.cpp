// SPDX-FileCopyrightText: 2026 The semantic_vslam authors
// SPDX-License-Identifier: BSD-3-Clause
//
// Runs the whole system over a recording, without a ROS master.
#include <unistd.h>

#include <algorithm>
#include <chrono>
#include <csignal>
#include <cstdio>
#include <filesystem>
#include <memory>
#include <opencv2/core.hpp>
#include <optional>
#include <string>
#include <thread>

#include "semantic_vslam/core/common/arguments.h"
#include "semantic_vslam/core/common/config_fields.h"
#include "semantic_vslam/core/common/error.h"
#include "semantic_vslam/core/common/log.h"
#include "semantic_vslam/core/eval/overview_picture.h"
#include "semantic_vslam/core/eval/run_report.h"
#include "semantic_vslam/core/io/atomic_file.h"
#include "semantic_vslam/core/io/image_file.h"
#include "semantic_vslam/core/io/tum_sequence.h"
#include "semantic_vslam/core/pipeline/slam_system.h"
#include "semantic_vslam/ros/bag_source.h"

namespace {

using namespace semantic_vslam;
namespace fs = std::filesystem;
using Clock = std::chrono::steady_clock;

constexpr const char* kUsage =
    "usage: run_offline SEQUENCE_DIR_OR_BAG --camera FILE --out DIR [options]\n"
    "Runs a TUM folder or a bag through the whole system. DIR gets "
    "trajectory.txt and keyframes.txt (TUM format),\n"
    "cloud.pcd, map.ot, timing.csv, summary.json and overview.png.\n"
    "  --camera FILE        cfg/cameras/*.yaml; a bag may do without it: then "
    "its camera_info holds\n"
    "  --config FILE        YAML with any of the keys of --list-config\n"
    "  --set KEY=VALUE      one key; may be repeated, holds over --config\n"
    "  --deterministic      one thread, nothing dropped, the same bytes out "
    "for the same bytes in (the default, said\n"
    "                       for the record: it refuses --realtime)\n"
    "  --realtime           frames come at the pace of their stamps, mapping "
    "runs in the background, and a frame that\n"
    "                       comes too late is dropped\n"
    "  --masks              also write masks/STAMP.png: what tracking took as "
    "moving, 255\n"
    "  --start N            first frame, from 0\n"
    "  --frames N           frames to run at most\n"
    "  --color-topic, --depth-topic, --info-topic NAME   for a bag whose "
    "topics are not recognised\n"
    "  --list-config        print every key with its value, bounds and "
    "meaning\n";

volatile std::sig_atomic_t stop_requested = 0;

/// The first Ctrl-C ends the run and writes what there is; a second one kills
/// as usual.
void requestStop(int) {
  stop_requested = 1;
  std::signal(SIGINT, SIG_DFL);
}

struct Options {
  std::string recording, out;
  bool realtime = false, masks = false;
  std::size_t start = 0, frames = 0;
};

SystemConfig readConfig(const Arguments& arguments) {
  SystemConfig config;
  if (const auto file = arguments.value("--config")) loadConfigFile(config, *file);
  for (const std::string& assignment : arguments.values("--set")) {
    const std::size_t equals = assignment.find('=');
    if (equals == std::string::npos) throw UsageError("--set " + assignment + ": expected KEY=VALUE");
    setConfig(config, assignment.substr(0, equals), assignment.substr(equals + 1));
  }
  return config;
}

int printConfig(const SystemConfig& config) {
  for (const ConfigEntry& entry : listConfig(config)) {
    std::printf("%-45s %-14s %s%s%s\n", entry.key.c_str(), entry.value.empty() ? "\"\"" : entry.value.c_str(),
                entry.bounds.c_str(), entry.bounds.empty() ? "" : "  ", entry.documentation.c_str());
  }
  return 0;
}

std::unique_ptr<FrameSource> openRecording(const Arguments& arguments, const std::string& path) {
  std::shared_ptr<const CameraModel> camera;
  if (const auto file = arguments.value("--camera")) camera = std::make_shared<CameraModel>(loadCameraFile(*file));
  if (fs::is_directory(path)) {
    if (!camera) throw UsageError("a folder of images needs --camera FILE (cfg/cameras/*.yaml)");
    return std::make_unique<TumSequence>(path, camera);
  }
  if (!fs::exists(path)) throw FileError("recording '" + path + "' does not exist");
  const RecordingTopics topics{arguments.value("--color-topic").value_or(""),
                               arguments.value("--depth-topic").value_or(""),
                               arguments.value("--info-topic").value_or("")};
  return std::make_unique<BagSource>(path, camera, topics);
}

/// One line on the terminal that shows where the run is; a line now and then
/// where output goes to a file.
class Progress {
 public:
  explicit Progress(std::size_t total) : total_(total), terminal_(isatty(STDERR_FILENO) != 0) {}

  void show(std::size_t done, const char* state, std::size_t keyframes) {
    const double elapsed_s = std::chrono::duration<double>(Clock::now() - begin_).count();
    const bool due = terminal_ ? elapsed_s - last_s_ > 0.2 : elapsed_s - last_s_ > 10.0;
    if (!due && done != total_) return;
    last_s_ = elapsed_s;
    std::fprintf(stderr, "%s%zu/%zu frames, %.1f fps, %zu keyframes, %s     %s", terminal_ ? "\r" : "", done, total_,
                 static_cast<double>(done) / elapsed_s, keyframes, state, terminal_ ? "" : "\n");
  }
  void end() const {
    if (terminal_) std::fputc('\n', stderr);
  }

 private:
  const std::size_t total_;
  const bool terminal_;
  const Clock::time_point begin_ = Clock::now();
  double last_s_ = 0.0;
};

/// Holds frames back until their time has come.
class Pacer {
 public:
  /// @return false if the frame comes too late to be worth its time.
  bool wait(Stamp stamp) {
    // A camera that buffers two frames, as drivers do, loses what comes later
    // than this.
    constexpr auto kMaxLate = std::chrono::milliseconds(66);
    if (!first_) {
      first_ = stamp;
      begin_ = Clock::now();
    }
    const auto due = begin_ + std::chrono::nanoseconds(stamp.ns - first_->ns);
    if (Clock::now() > due + kMaxLate) return false;
    std::this_thread::sleep_until(due);
    return true;
  }

 private:
  std::optional<Stamp> first_;
  Clock::time_point begin_;
};

/// The posed frame with most motion in it, for the overview.
struct Sample {
  double dynamic_share = -1.0;
  Stamp stamp;
  cv::Mat3b bgr;
  cv::Mat1b dynamic;
};

const char* motionModelName(MotionModel model) {
  switch (model) {
    case MotionModel::kNone: return "none";
    case MotionModel::kHomography: return "homography";
    case MotionModel::kRigidFlow: return "rigid_flow";
  }
  return "?";
}

void writeMask(const std::string& folder, Stamp stamp, const cv::Mat1b& dynamic, cv::Size size) {
  const cv::Mat1b mask = dynamic.empty() ? cv::Mat1b(cv::Mat1b::zeros(size)) : cv::Mat1b(dynamic >= 128);
  writeImageFile(folder + "/" + formatStamp(stamp) + ".png", mask);
}

/// Counts one frame's result, scores its mask, and keeps it if it is the best
/// sample so far.
void record(const RgbdFrame& frame, const StepResult& step, const FrameSource& source, RunReport& report,
            Sample& sample) {
  ++report.frames;
  ++report.frames_in_state[stateName(step.tracking.state)];
  const MotionResult& motion = step.motion;
  report.motion.push_back({frame.index, motionModelName(motion.model), motion.inliers, motion.dynamic_share});
  const cv::Mat1b truth = source.groundTruthMask();
  if (truth.size() == frame.bgr.size()) {
    report.mask.add(step.dynamic.empty() ? cv::Mat1b(cv::Mat1b::zeros(truth.size())) : step.dynamic, truth);
  }
  // More than half an image of moving things shows no room.
  if (step.posed && step.motion.dynamic_share > sample.dynamic_share && step.motion.dynamic_share < 0.5) {
    sample = {step.motion.dynamic_share, frame.stamp, frame.bgr, step.dynamic.clone()};
  }
}

/// Gives the frames to the system until the recording, the wanted number or the
/// user's patience ends.
Sample runFrames(FrameSource& source, SlamSystem& system, const Options& options, RunReport& report) {
  const std::size_t rest = source.size() > options.start ? source.size() - options.start : 0;
  const std::size_t wanted = std::min(options.frames, rest);
  Progress progress(wanted);
  Pacer pacer;
  Sample sample;
  source.skip(options.start);
  for (std::size_t taken = 0; taken < wanted; ++taken) {
    const std::optional<RgbdFrame> frame = source.next();
    if (!frame) break;
    if (options.realtime && !pacer.wait(frame->stamp)) {
      ++report.dropped_late;
      continue;
    }
    const StepResult step = system.step(*frame);
    record(*frame, step, source, report, sample);
    if (options.masks) writeMask(options.out + "/masks", frame->stamp, step.dynamic, frame->bgr.size());
    progress.show(taken + 1, stateName(step.tracking.state), system.slam().keyframeCount());
    if (stop_requested != 0) break;
  }
  progress.end();
  report.interrupted = stop_requested != 0;
  report.skipped_broken = source.skippedBroken();
  if (report.frames == 0) throw FileError("'" + options.recording + "': no frame could be read");
  return sample;
}

std::vector<TimedPose> posesOf(const std::vector<KeyframePose>& keyframes) {
  std::vector<TimedPose> poses;
  for (const KeyframePose& keyframe : keyframes) poses.push_back({keyframe.stamp, keyframe.T_world_camera});
  return poses;
}

/// Compares with the ground truth, where that is possible; says why not
/// otherwise.
void scoreTrajectory(const std::vector<TimedPose>& truth, const std::vector<TimedPose>& trajectory, RunReport& report) {
  if (truth.empty()) {
    logInfo("no ground truth beside the images: no trajectory error");
    return;
  }
  try {
    report.absolute = absoluteTrajectoryError(truth, trajectory);
    report.relative = relativePoseError(truth, trajectory);
  } catch (const Error& error) {
    logWarning(std::string("trajectory error: ") + error.what());
  }
}

void writePictures(const std::string& folder, const SlamSystem& system, const FrameSource& source,
                   const RunReport& report, const std::vector<TimedPose>& trajectory, const Sample& sample,
                   double cloud_resolution_m) {
  OverviewContent content;
  content.title = fs::path(report.sequence).filename().string();
  content.subtitle = headline(report);
  content.cloud = system.dense().cloud();
  content.cloud_resolution_m = cloud_resolution_m;
  content.labels = system.labels();
  content.trajectory = trajectory;
  content.truth = source.groundTruth();
  content.absolute = report.absolute;
  content.camera = source.camera();
  const auto pose =
      std::find_if(trajectory.begin(), trajectory.end(), [&](const TimedPose& p) { return p.stamp == sample.stamp; });
  if (pose != trajectory.end() && !sample.bgr.empty()) {
    content.sample_bgr = sample.bgr;
    content.sample_dynamic = sample.dynamic;
    content.sample_T_world_camera = pose->T_world_camera;
  }
  writeImageFile(folder + "/overview.png", drawOverview(content));
}

/// Writes everything that the run leaves. The map must be finished.
void writeResults(const SlamSystem& system, const SystemConfig& config, const FrameSource& source, const Sample& sample,
                  const Options& options, RunReport& report) {
  const std::vector<TimedPose> trajectory = system.slam().trajectory();
  writeTumTrajectory(options.out + "/trajectory.txt", trajectory);
  writeTumTrajectory(options.out + "/keyframes.txt", posesOf(system.slam().keyframePoses()));
  system.times().writeCsv(options.out + "/timing.csv");
  if (config.dense.enabled) {
    system.dense().saveCloud(options.out + "/cloud.pcd");
    system.dense().saveOctomap(options.out + "/map.ot");
  }
  report.posed = trajectory.size();
  report.keyframes = system.slam().keyframeCount();
  report.landmarks = system.slam().landmarkCount();
  report.cloud_points = system.dense().cloud().size();
  report.voxels = system.dense().voxels();
  report.stages = system.times().summarize();
  report.peak_memory_mb = peakMemoryMb();
  scoreTrajectory(source.groundTruth(), trajectory, report);
  writeTextAtomically(options.out + "/summary.json", toJson(report));
  writePictures(options.out, system, source, report, trajectory, sample, config.dense.cloud_resolution_m);
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
  options.frames = arguments.count("--frames", source.size());
  if (options.start >= source.size()) {
    throw UsageError("--start " + std::to_string(options.start) + " is past the recording's " +
                     std::to_string(source.size()) + " frames");
  }
  return options;
}

int run(const Arguments& arguments, const SystemConfig& config) {
  std::signal(SIGINT, requestStop);
  const std::unique_ptr<FrameSource> source = openRecording(arguments, arguments.positional()[0]);
  const Options options = readOptions(arguments, *source);
  std::error_code failed;
  fs::create_directories(options.masks ? options.out + "/masks" : options.out, failed);
  if (failed) throw FileError("output folder '" + options.out + "' cannot be made: " + failed.message());

  SlamSystem system(config, options.realtime ? SlamSystem::Mode::kBackground : SlamSystem::Mode::kSynchronous);
  RunReport report;
  report.sequence = options.recording;
  const auto begin = Clock::now();
  const Sample sample = runFrames(*source, system, options, report);
  system.finish();
  report.wall_s = std::chrono::duration<double>(Clock::now() - begin).count();
  writeResults(system, config, *source, sample, options, report);
  std::fputs(toText(report).c_str(), stdout);
  return 0;
}

}  // namespace

int main(int argc, char** argv) {
  return runTool(argc, argv, kUsage, [&] {
    cv::setNumThreads(1);  // so that thread CPU time is all of it, and sums are
                           // added in one order
    const bool list =
        std::any_of(argv + 1, argv + argc, [](const char* word) { return word == std::string("--list-config"); });
    const Arguments arguments(argc, argv,
                              {"--camera", "--out", "--config", "--set", "--start", "--frames", "--color-topic",
                               "--depth-topic", "--info-topic"},
                              {"--deterministic", "--realtime", "--masks", "--list-config"}, list ? 0 : 1);
    const SystemConfig config = readConfig(arguments);
    return list ? printConfig(config) : run(arguments, config);
  });
}
