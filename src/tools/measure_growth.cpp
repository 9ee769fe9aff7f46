// SPDX-FileCopyrightText: 2026 The semantic_vslam authors
// SPDX-License-Identifier: BSD-3-Clause
//
// Runs the whole system over a TUM folder back and forth several times and tells how the sparse map grows.
#include <algorithm>
#include <cstdio>
#include <filesystem>
#include <opencv2/core.hpp>
#include <string>
#include <vector>

#include "core/common/arguments.h"
#include "core/common/atomic_file.h"
#include "core/common/config_arguments.h"
#include "core/io/json_writer.h"
#include "core/pipeline/sparse_slam.h"
#include "eval/open_recording.h"
#include "eval/run_report.h"
#include "semantic_vslam/core/pipeline/pipeline.h"

namespace {

using namespace semantic_vslam;

constexpr const char* kUsage =
    "usage: measure_growth SEQUENCE_DIR --camera FILE [options]\n"
    "Runs a TUM folder forth and back without a pause and prints one JSON object with the sparse map's size after "
    "each\n"
    "pass: keyframes, landmarks, and bytes of the saved map.\n"
    "  --passes N      (10)\n"
    "  --frames N      of a pass, from the start (all)\n"
    "  --set KEY=VALUE a key of the configuration; may be repeated\n";

/// Sizes of the map after each pass.
struct Growth {
  std::vector<double> keyframes, landmarks, bytes, posed_share;
};

SystemConfig readConfig(const Arguments& arguments) {
  SystemConfig config;
  config.dense.enabled = false;  // it is the sparse map that is looked at
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

/// Steps through one pass. @param first  index and stamp go on from pass to pass, one frame apart
/// @return share of the frames that got a pose
double runPass(TumSequence& sequence, std::size_t frames, bool backwards, std::uint64_t first, Pipeline& system) {
  constexpr std::int64_t kFrameNs = 33'333'333;
  std::size_t posed = 0;
  for (std::size_t i = 0; i < frames; ++i) {
    sequence.seek(backwards ? frames - 1 - i : i);
    std::optional<RgbdFrame> frame = sequence.next();
    if (!frame) continue;
    frame->index = first + i;
    frame->stamp = Stamp{1'000'000'000'000 + static_cast<std::int64_t>(frame->index) * kFrameNs};
    posed += system.step(*frame).posed() ? 1 : 0;
  }
  return static_cast<double>(posed) / static_cast<double>(frames);
}

int run(const Arguments& arguments, const SystemConfig& config) {
  TumSequence sequence = openTumFolder(arguments);
  const std::size_t frames = std::min(arguments.count("--frames", sequence.size(), 1), sequence.size());
  const std::size_t passes = arguments.count("--passes", 10, 1);
  Pipeline system(config);
  Growth growth;
  for (std::size_t pass = 0; pass < passes; ++pass) {
    growth.posed_share.push_back(runPass(sequence, frames, pass % 2 == 1, pass * frames, system));
    growth.keyframes.push_back(static_cast<double>(system.slam().keyframeCount()));
    growth.landmarks.push_back(static_cast<double>(system.slam().landmarkCount()));
    growth.bytes.push_back(savedBytes(system.slam()));
    std::fprintf(stderr, "pass %zu: %.0f keyframes, %.0f landmarks, %.2f MB, %.1f %% posed\n", pass + 1,
                 growth.keyframes.back(), growth.landmarks.back(), 1e-6 * growth.bytes.back(),
                 100.0 * growth.posed_share.back());
  }
  JsonWriter json;
  json.field("keyframes", growth.keyframes);
  json.field("landmarks", growth.landmarks);
  json.field("map_bytes", growth.bytes);
  json.field("posed_share", growth.posed_share);
  json.field("loops", system.slam().loopCount());
  json.field("peak_memory_mb", peakMemoryMb());
  std::fputs(json.finish().c_str(), stdout);
  return 0;
}

}  // namespace

int main(int argc, char** argv) {
  return runTool(argc, argv, kUsage, [&] {
    cv::setNumThreads(1);
    const Arguments arguments(argc, argv, {"--camera", "--passes", "--frames", "--set"}, {}, {1, 1});
    return run(arguments, readConfig(arguments));
  });
}
