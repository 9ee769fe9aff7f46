// SPDX-FileCopyrightText: 2026 The semantic_vslam authors
// SPDX-License-Identifier: BSD-3-Clause
//
// Runs the whole system over a TUM folder back and forth several times and tells how the sparse map grows.
#include <algorithm>
#include <cmath>
#include <cstdio>
#include <filesystem>
#include <opencv2/core.hpp>
#include <string>
#include <vector>

#include "core/common/arguments.h"
#include "core/common/atomic_file.h"
#include "core/common/config_arguments.h"
#include "core/dense/dense_mapper.h"
#include "core/io/json_writer.h"
#include "core/io/tum_sequence.h"
#include "core/pipeline/sparse_slam.h"
#include "eval/open_recording.h"
#include "eval/run_report.h"
#include "eval/trajectory_error.h"
#include "semantic_vslam/core/pipeline/pipeline.h"

namespace {

using namespace semantic_vslam;

constexpr const char* kUsage =
    "usage: measure_growth SEQUENCE_DIR --camera FILE [options]\n"
    "Runs a TUM folder forth and back without a pause and prints one JSON object with the size of the maps after each\n"
    "pass: keyframes, landmarks, bytes of the saved map, loops, points of the cloud, keyframes and bytes of the dense\n"
    "map, resident memory in MB; and the pass's trajectory error in metres, where there is ground truth.\n"
    "  --passes N      (10)\n"
    "  --every N       frame alone: a machine that keeps up with a part of them (1)\n"
    "  --dense         builds the dense map, too\n"
    "  --frames N      of a pass, from the start (all)\n"
    "  --set KEY=VALUE a key of the configuration; may be repeated\n";

/// Sizes of the map after each pass.
struct Growth {
  std::vector<double> keyframes, landmarks, bytes, posed_share, loops, points, dense_keyframes, dense_bytes, memory_mb,
      ate_m, worst_m;
};

SystemConfig readConfig(const Arguments& arguments) {
  SystemConfig config;
  config.dense.enabled = arguments.has("--dense");
  config.segmentation.model.clear();
  applySettings(arguments, config);
  return config;
}

double savedBytes(const SparseSlam& slam) {
  const AtomicFile scratch(
      (std::filesystem::temp_directory_path() / "measure_growth.map").string());  // never committed
  slam.saveMap(scratch.temporary());
  return static_cast<double>(std::filesystem::file_size(scratch.temporary()));
}

/// What of the frames is played.
struct Passes {
  std::size_t frames = 0, every = 1;
};

/// Steps through one pass. @param first  index and stamp go on from pass to pass, one frame apart
/// @return the poses as they were given, at the recording's own stamps, in order of these
std::vector<TimedPose> runPass(TumSequence& sequence, const Passes& played, bool backwards, std::uint64_t first,
                               Pipeline& system) {
  constexpr std::int64_t kFrameNs = 33'333'333;
  std::vector<TimedPose> posed;
  for (std::size_t i = 0; i < played.frames; i += played.every) {
    sequence.seek(backwards ? played.frames - 1 - i : i);
    std::optional<RgbdFrame> frame = sequence.next();
    if (!frame) continue;
    const Stamp recorded = frame->stamp;
    frame->index = first + i;
    frame->stamp = Stamp{1'000'000'000'000 + static_cast<std::int64_t>(frame->index) * kFrameNs};
    const StepResult result = system.step(*frame);
    if (result.posed()) posed.push_back({recorded, result.tracking.T_camera_world.inverse()});
  }
  if (backwards) std::reverse(posed.begin(), posed.end());
  return posed;
}

/// Looks at the maps after a pass.
void measure(const Pipeline& system, Growth& growth) {
  growth.keyframes.push_back(static_cast<double>(system.slam().keyframeCount()));
  growth.landmarks.push_back(static_cast<double>(system.slam().landmarkCount()));
  growth.bytes.push_back(savedBytes(system.slam()));
  growth.loops.push_back(static_cast<double>(system.slam().loopCount()));
  growth.points.push_back(static_cast<double>(system.cloud().size()));
  growth.dense_keyframes.push_back(static_cast<double>(system.dense().keyframes()));
  growth.dense_bytes.push_back(static_cast<double>(system.dense().memoryBytes()));
  growth.memory_mb.push_back(residentMemoryMb());
}

void write(JsonWriter& json, const Growth& growth) {
  json.field("keyframes", growth.keyframes);
  json.field("landmarks", growth.landmarks);
  json.field("map_bytes", growth.bytes);
  json.field("loops", growth.loops);
  json.field("cloud_points", growth.points);
  json.field("dense_keyframes", growth.dense_keyframes);
  json.field("dense_bytes", growth.dense_bytes);
  json.field("memory_mb", growth.memory_mb);
  json.field("posed_share", growth.posed_share);
  json.field("ate_m", growth.ate_m);
  json.field("worst_m", growth.worst_m);
}

int run(const Arguments& arguments, const SystemConfig& config) {
  TumSequence sequence = openTumFolder(arguments);
  const Passes played = {std::min(arguments.count("--frames", sequence.size(), 1), sequence.size()),
                         arguments.count("--every", 1, 1)};
  const std::size_t passes = arguments.count("--passes", 10, 1);
  const std::size_t steps = (played.frames + played.every - 1) / played.every;
  Pipeline system(config);
  Growth growth;
  for (std::size_t pass = 0; pass < passes; ++pass) {
    const auto posed = runPass(sequence, played, pass % 2 == 1, pass * played.frames, system);
    growth.posed_share.push_back(static_cast<double>(posed.size()) / static_cast<double>(steps));
    if (!sequence.groundTruth().empty() && posed.size() > 1) {
      const auto error = absoluteTrajectoryError(sequence.groundTruth(), posed).translation_m;
      growth.ate_m.push_back(error.rmse);
      growth.worst_m.push_back(error.max);
    }
    measure(system, growth);
    std::fprintf(
        stderr,
        "pass %zu: %.0f keyframes, %.0f landmarks, %.2f MB, %.1f %% posed, %.0f loops, %.0f points, %.0f dense "
        "keyframes, %.1f MB dense, %.0f MB resident, ATE %.4f m, worst %.3f m\n",
        pass + 1, growth.keyframes.back(), growth.landmarks.back(), 1e-6 * growth.bytes.back(),
        100.0 * growth.posed_share.back(), growth.loops.back(), growth.points.back(), growth.dense_keyframes.back(),
        1e-6 * growth.dense_bytes.back(), growth.memory_mb.back(), growth.ate_m.empty() ? NAN : growth.ate_m.back(),
        growth.worst_m.empty() ? NAN : growth.worst_m.back());
  }
  JsonWriter json;
  write(json, growth);
  json.field("peak_memory_mb", peakMemoryMb());
  std::fputs(json.finish().c_str(), stdout);
  return 0;
}

}  // namespace

int main(int argc, char** argv) {
  return runTool(argc, argv, kUsage, [&] {
    cv::setNumThreads(1);
    const Arguments arguments(argc, argv, {"--camera", "--passes", "--frames", "--every", "--set"}, {"--dense"},
                              {1, 1});
    return run(arguments, readConfig(arguments));
  });
}
