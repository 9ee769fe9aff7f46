// SPDX-FileCopyrightText: 2026 The semantic_vslam authors
// SPDX-License-Identifier: BSD-3-Clause
//
// Takes the camera's sight away in many ways and measures how the system comes back.
#include <chrono>
#include <cstdio>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <opencv2/core.hpp>
#include <string>
#include <vector>

#include "core/common/arguments.h"
#include "core/common/atomic_file.h"
#include "core/common/config_arguments.h"
#include "core/io/json_writer.h"
#include "core/motion/motion_detector.h"
#include "core/pipeline/sparse_slam.h"
#include "eval/fault_injection.h"
#include "eval/open_recording.h"
#include "eval/trajectory_error.h"
#include "semantic_vslam/core/common/error.h"
#include "semantic_vslam/core/pipeline/pipeline.h"

namespace {

using namespace semantic_vslam;
namespace fs = std::filesystem;
using Clock = std::chrono::steady_clock;

constexpr const char* kUsage =
    "usage: measure_recovery SEQUENCE_DIR --camera FILE [options]\n"
    "Plays a TUM folder with cuts of 1 to 3 s (black images or missing frames), with the lens covered from the middle "
    "on,\n"
    "and in its own saved map; tells on stderr what became of it and prints one JSON object.\n"
    "  --runs N             runs with cuts, five cuts each, run i drawn by seed i (10)\n"
    "  --starts N           starts in the saved map, spread over the first half of the recording (5)\n"
    "  --set KEY=VALUE      a key of the configuration; may be repeated\n";

constexpr double kFps = 30.0;
constexpr int kMostFramesNeeded = 10;
constexpr double kWrongM = 0.05;

struct Setup {
  const Arguments& arguments;
  SystemConfig config;
};

double secondsSince(Clock::time_point begin) { return std::chrono::duration<double>(Clock::now() - begin).count(); }

/// Gives all frames of a source to the system. @return what it said of each
std::vector<ToldPose> play(FrameSource& source, Pipeline& system) {
  std::vector<ToldPose> told;
  while (const auto frame = source.next()) {
    const StepResult step = system.step(*frame);
    told.push_back({frame->index, frame->stamp, step.tracking.state, step.T_world_camera()});
  }
  return told;
}

struct CutsResult {
  int cuts = 0, recovered = 0, wrong = 0;
  std::vector<double> ate_m;  ///< of each run's trajectory
};

void playCuts(const Setup& setup, std::uint64_t seed, CutsResult& result) {
  TumSequence recording = openTumFolder(setup.arguments);
  const std::vector<Cut> cuts = drawCuts(recording.size(), kFps, CutPlan(), seed);
  CutSource source(recording, cuts);
  Pipeline system(setup.config);
  const std::vector<ToldPose> told = play(source, system);
  system.finish();
  for (const Recovery& recovery : scoreRecovery(cuts, told, source.groundTruth())) {
    const bool recovered = recovery.frames_needed > 0 && recovery.frames_needed <= kMostFramesNeeded;
    const bool wrong = recovery.worst_error_m > kWrongM;
    ++result.cuts;
    result.recovered += recovered ? 1 : 0;
    result.wrong += wrong ? 1 : 0;
    std::fprintf(stderr, "run %2llu  %-7s  frames %3llu to %3llu  back after %3d frames  worst error %.3f m%s%s\n",
                 static_cast<unsigned long long>(seed), cutName(recovery.cut.kind),
                 static_cast<unsigned long long>(recovery.cut.begin), static_cast<unsigned long long>(recovery.cut.end),
                 recovery.frames_needed, recovery.worst_error_m, recovered ? "" : "  LATE", wrong ? "  WRONG" : "");
  }
  result.ate_m.push_back(absoluteTrajectoryError(source.groundTruth(), system.slam().trajectory()).translation_m.rmse);
  std::fprintf(stderr, "run %2llu  ATE %.4f m\n", static_cast<unsigned long long>(seed), result.ate_m.back());
}

/// The lens is covered at the middle and stays so. @return whether LOST is told at the end and the map is what it was
bool coverForGood(const Setup& setup) {
  TumSequence recording = openTumFolder(setup.arguments);
  const std::uint64_t middle = recording.size() / 2;
  CutSource source(recording, {{middle, recording.size(), Cut::Kind::kBlack}});
  Pipeline system(setup.config);
  std::size_t keyframes = 0, landmarks = 0;
  TrackingState state = TrackingState::kInitialising;
  while (const auto frame = source.next()) {
    state = system.step(*frame).tracking.state;
    if (frame->index >= middle) continue;
    keyframes = system.slam().keyframeCount();
    landmarks = system.slam().landmarkCount();
  }
  std::fprintf(stderr, "covered for good: state %s, keyframes %zu -> %zu, landmarks %zu -> %zu\n", stateName(state),
               keyframes, system.slam().keyframeCount(), landmarks, system.slam().landmarkCount());
  const bool kept = system.slam().keyframeCount() == keyframes && system.slam().landmarkCount() == landmarks;
  return state == TrackingState::kLost && kept;
}

std::string bytesOf(const std::string& path) {
  std::ifstream in(path, std::ios::binary);
  return {std::istreambuf_iterator<char>(in), std::istreambuf_iterator<char>()};
}

struct SavedMapResult {
  std::vector<double> frames_needed, ate_m;
  bool unchanged = true;
  double start_s = 0.0;  ///< opening the system and the map
};

void relocaliseFrom(const Setup& setup, const std::string& map_file, std::size_t first, SavedMapResult& result) {
  TumSequence recording = openTumFolder(setup.arguments);
  recording.skip(first);
  SparseSlam slam(setup.config.slam);
  slam.loadMap(map_file);
  MotionDetector motion(setup.config.motion);
  StageTimes times;
  int needed = -1, given = 0;
  std::vector<TimedPose> online;
  while (const auto frame = recording.next()) {
    ++given;
    const SparseStep step = slam.step(*frame, motion.detect(*frame).dynamic, times, true);
    if (step.tracking.state != TrackingState::kOk) continue;
    if (needed < 0) needed = given;
    online.push_back({frame->stamp, step.tracking.T_camera_world.inverse()});
  }
  const AtomicFile after(map_file + ".after");
  slam.saveMap(after.temporary());
  result.unchanged = result.unchanged && bytesOf(map_file) == bytesOf(after.temporary());
  result.frames_needed.push_back(needed);
  result.ate_m.push_back(absoluteTrajectoryError(recording.groundTruth(), online).translation_m.rmse);
  std::fprintf(stderr, "saved map from frame %3zu: posed after %d frames, %zu of %d posed, ATE %.4f m\n", first, needed,
               online.size(), given, result.ate_m.back());
}

SavedMapResult relocaliseInSavedMap(const Setup& setup, std::size_t starts) {
  const AtomicFile scratch((fs::temp_directory_path() / "measure_recovery.map").string());  // never committed
  const std::string& map_file = scratch.temporary();
  std::size_t frames = 0;
  {
    TumSequence recording = openTumFolder(setup.arguments);
    frames = recording.size();
    Pipeline system(setup.config);
    play(recording, system);
    system.finish();
    system.slam().saveMap(map_file);
  }
  SavedMapResult result;
  const auto begin = Clock::now();
  {
    Pipeline system(setup.config);
    SparseSlam slam(setup.config.slam);
    slam.loadMap(map_file);
    result.start_s = secondsSince(begin);
  }
  for (std::size_t i = 0; i < starts; ++i) relocaliseFrom(setup, map_file, (i + 1) * frames / (2 * starts), result);
  return result;
}

int run(const Arguments& arguments) {
  Setup setup{arguments, SystemConfig()};
  setup.config.dense.enabled = false;  // has no part in where the camera is
  setup.config.segmentation.model.clear();
  applySettings(arguments, setup.config);

  CutsResult cuts;
  const std::size_t runs = arguments.count("--runs", 10), starts = arguments.count("--starts", 5);
  for (std::size_t i = 1; i <= runs; ++i) playCuts(setup, i, cuts);
  const bool lost_and_kept = coverForGood(setup);
  const SavedMapResult saved = starts > 0 ? relocaliseInSavedMap(setup, starts) : SavedMapResult();

  JsonWriter json;
  json.beginObject("cuts");
  json.field("count", cuts.cuts);
  json.field("back_within_10_frames", cuts.recovered);
  json.field("wrong_place", cuts.wrong);
  json.field("ate_m", cuts.ate_m);
  json.endObject();
  json.field("covered_for_good_is_lost_and_keeps_map", lost_and_kept);
  json.beginObject("saved_map");
  json.field("frames_needed", saved.frames_needed);
  json.field("ate_m", saved.ate_m);
  json.field("bytes_unchanged", saved.unchanged);
  json.field("start_s", saved.start_s);
  json.endObject();
  std::fputs(json.finish().c_str(), stdout);
  return 0;
}

}  // namespace

int main(int argc, char** argv) {
  return runTool(argc, argv, kUsage, [&] {
    cv::setNumThreads(1);  // sums are added in one order
    return run(Arguments(argc, argv, {"--camera", "--runs", "--starts", "--set"}, {}, {1, 1}));
  });
}
