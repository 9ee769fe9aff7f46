// SPDX-FileCopyrightText: 2026 The semantic_vslam authors
// SPDX-License-Identifier: BSD-3-Clause
//
// Runs the whole system over a rendered scenario or a TUM folder and tells which loops it closed, whether they are
// true, and the trajectory's error just before the first one and at the end.
#include <time.h>

#include <algorithm>
#include <cstdio>
#include <opencv2/core.hpp>
#include <optional>
#include <string>
#include <vector>

#include "core/common/arguments.h"
#include "core/common/atomic_file.h"
#include "core/common/config_arguments.h"
#include "core/common/progress.h"
#include "core/io/json_writer.h"
#include "core/io/stamp_association.h"
#include "core/io/trajectory.h"
#include "core/pipeline/sparse_slam.h"
#include "eval/open_recording.h"
#include "eval/run_report.h"
#include "eval/trajectory_error.h"
#include "semantic_vslam/core/common/error.h"
#include "semantic_vslam/core/pipeline/pipeline.h"

namespace {

using namespace semantic_vslam;

constexpr const char* kUsage =
    "usage: measure_loops (SEQUENCE_DIR --camera FILE | --scenario NAME) [options]\n"
    "Runs the whole system and prints one JSON object: the loops closed, whether they are true, and the trajectory's\n"
    "error (ATE RMSE, metres) over the frames up to the first closing just before it, and over all frames at the end.\n"
    "  --scenario NAME      rendered on the way in place of a TUM folder; make_synthetic_bag --list names them\n"
    "  --seed N, --size WxH, --fps N   of the scenario (1, 640x480, 30)\n"
    "  --frames N           stop after N frames\n"
    "  --set KEY=VALUE      a key of the configuration; may be repeated\n"
    "  --map FILE, --trajectory FILE   also save the sparse map and the frames' poses (TUM format)\n"
    "  --verbose            also print each frame's state and inliers on stderr\n";

// A loop whose relative pose is this far from the truth joins two places that are not one.
constexpr double kFalseM = 0.5, kFalseRad = 0.2;

SystemConfig readConfig(const Arguments& arguments) {
  SystemConfig config;
  config.dense.enabled = false;  // has no part in the loops
  config.segmentation.model.clear();
  applySettings(arguments, config);
  return config;
}

double trajectoryError(const std::vector<TimedPose>& truth, const std::vector<TimedPose>& estimate) {
  return absoluteTrajectoryError(truth, estimate).translation_m.rmse;
}

/// How far a loop's relative pose is from the truth; nothing where the ground truth has a gap.
std::optional<SE3> errorOf(const ClosedLoop& loop, const std::vector<TimedPose>& truth) {
  const TimedPose* current = closestPose(truth, loop.current, kAssociationGapS);
  const TimedPose* matched = closestPose(truth, loop.matched, kAssociationGapS);
  if (current == nullptr || matched == nullptr) return std::nullopt;
  const SE3 T_current_matched = current->T_world_camera.inverse() * matched->T_world_camera;
  return loop.T_current_matched * T_current_matched.inverse();
}

struct Outcome {
  std::size_t frames = 0, posed = 0;
  std::optional<double> ate_before_m;  ///< nothing without a loop
  double ate_m = 0.0;
};

double cpuSeconds() {
  timespec now{};
  clock_gettime(CLOCK_PROCESS_CPUTIME_ID, &now);
  return static_cast<double>(now.tv_sec) + 1e-9 * static_cast<double>(now.tv_nsec);
}

Outcome runThrough(FrameSource& frames, Pipeline& system, std::size_t most_frames, bool verbose) {
  Outcome outcome;
  const auto& truth = frames.groundTruth();
  if (truth.empty()) throw Error("the recording has no ground truth to judge loops by");
  std::vector<TimedPose> before;
  Progress progress(std::min(most_frames, frames.size()), "frames");
  while (outcome.frames < most_frames) {
    const auto frame = frames.next();
    if (!frame) break;
    if (system.slam().loopCount() == 0) before = system.slam().trajectory();
    const StepResult step = system.step(*frame);
    ++outcome.frames;
    if (!outcome.ate_before_m && system.slam().loopCount() > 0) outcome.ate_before_m = trajectoryError(truth, before);
    if (!verbose) {
      progress.show(outcome.frames, std::to_string(system.slam().keyframeCount()) + " keyframes, " +
                                        std::to_string(system.slam().loopCount()) + " loops");
    } else {
      std::fprintf(stderr, "%llu %s %d inliers of %d matches, %d features, %zu keyframes, %zu loops\n",
                   static_cast<unsigned long long>(frame->index), stateName(step.tracking.state), step.tracking.inliers,
                   step.tracking.matches, step.tracking.features, system.slam().keyframeCount(),
                   system.slam().loopCount());
    }
  }
  system.finish();
  const auto trajectory = system.slam().trajectory();
  outcome.posed = trajectory.size();
  outcome.ate_m = trajectoryError(truth, trajectory);
  return outcome;
}

void writeLoops(JsonWriter& json, const std::vector<ClosedLoop>& loops, const std::vector<TimedPose>& truth) {
  int wrong = 0, without_truth = 0;
  double worst_m = 0.0;
  for (const ClosedLoop& loop : loops) {
    const std::optional<SE3> error = errorOf(loop, truth);
    without_truth += error ? 0 : 1;
    if (!error) continue;
    worst_m = std::max(worst_m, error->translation().norm());
    wrong += error->translation().norm() > kFalseM || rotationAngle(*error) > kFalseRad ? 1 : 0;
  }
  json.field("loops", loops.size());
  json.field("false_loops", wrong);
  json.field("loops_without_truth", without_truth);
  json.field("worst_loop_error_m", worst_m);
}

int run(const Arguments& arguments, const SystemConfig& config) {
  const auto recording = openRecording(arguments, 30.0);
  const std::size_t most_frames = arguments.count("--frames", recording->size(), 1);
  for (const char* output : {"--map", "--trajectory"}) {
    if (const auto path = arguments.value(output)) requireWritable(*path);
  }
  Pipeline system(config);
  const Outcome outcome = runThrough(*recording, system, most_frames, arguments.has("--verbose"));
  if (const auto map = arguments.value("--map")) system.slam().saveMap(*map);
  if (const auto poses = arguments.value("--trajectory")) writeTumTrajectory(*poses, system.slam().trajectory());
  JsonWriter json;
  json.field("recording", arguments.positional().empty() ? *arguments.value("--scenario") : arguments.positional()[0]);
  json.field("frames", outcome.frames);
  json.field("posed", outcome.posed);
  json.field("keyframes", system.slam().keyframeCount());
  writeLoops(json, system.slam().closedLoops(), recording->groundTruth());
  outcome.ate_before_m ? json.field("ate_before_m", *outcome.ate_before_m) : json.null("ate_before_m");
  json.field("ate_m", outcome.ate_m);
  json.field("cpu_s", cpuSeconds());
  json.field("peak_memory_mb", peakMemoryMb());
  std::fputs(json.finish().c_str(), stdout);
  return 0;
}

}  // namespace

int main(int argc, char** argv) {
  return runTool(argc, argv, kUsage, [&] {
    cv::setNumThreads(1);
    const Arguments arguments(
        argc, argv,
        {"--camera", "--scenario", "--seed", "--size", "--fps", "--frames", "--set", "--map", "--trajectory"},
        {"--verbose"}, {0, 1});
    return run(arguments, readConfig(arguments));
  });
}
