// SPDX-FileCopyrightText: 2026 The semantic_vslam authors
// SPDX-License-Identifier: BSD-3-Clause
//
// Compares an estimated trajectory with the true one, as the TUM RGB-D benchmark does.
#include <cstdio>
#include <exception>
#include <filesystem>
#include <optional>
#include <string>

#include "core/common/arguments.h"
#include "core/io/image_file.h"
#include "core/io/json_writer.h"
#include "core/io/trajectory.h"
#include "eval/trajectory_error.h"
#include "eval/trajectory_plot.h"
#include "semantic_vslam/core/common/error.h"

namespace {

using namespace semantic_vslam;

constexpr const char* kUsage =
    "usage: evaluate_trajectory GROUNDTRUTH.txt ESTIMATE.txt [options]\n"
    "Absolute trajectory error (rigid alignment) and relative pose error over a fixed time, as the TUM RGB-D "
    "benchmark\n"
    "defines them. Both files: stamp tx ty tz qx qy qz qw.\n"
    "  --json          print JSON instead of a table\n"
    "  --plot FILE     draw both paths and the error over time (.png or .jpg)\n"
    "  --delta S       time over which the relative error is taken, s (1.0)\n"
    "  --max-gap S     poses further apart in time are not compared, s (0.02)\n"
    "  --scale         also align the scale (the benchmark does not)\n";

struct Evaluation {
  std::size_t truth_poses = 0, estimate_poses = 0;
  AbsoluteTrajectoryError absolute;
  RelativePoseError relative;
  double delta_s = 1.0;
};

std::string toJson(const Evaluation& e) {
  JsonWriter json;
  json.field("groundtruth_poses", e.truth_poses);
  json.field("estimate_poses", e.estimate_poses);
  json.field("matched_share", static_cast<double>(e.absolute.matches.size()) / static_cast<double>(e.estimate_poses));
  json.field("scale", e.absolute.truth_from_estimate.scale);
  json.field("rpe_delta_s", e.delta_s);
  write(json, "ate_m", e.absolute.translation_m);
  write(json, "rpe_translation_m", e.relative.translation_m);
  write(json, "rpe_rotation_deg", e.relative.rotation_deg);
  return json.finish();
}

void printRow(const char* name, const ErrorStatistics& s) {
  std::printf("%-24s %9.4f %9.4f %9.4f %9.4f %9.4f %9.4f\n", name, s.rmse, s.mean, s.median, s.stddev, s.min, s.max);
}

void printTable(const Evaluation& e) {
  std::printf("%zu of %zu estimated poses compared\n", e.absolute.matches.size(), e.estimate_poses);
  if (e.absolute.truth_from_estimate.scale != 1.0) {
    std::printf("scale of the estimate %.4f\n", e.absolute.truth_from_estimate.scale);
  }
  std::printf("%-24s %9s %9s %9s %9s %9s %9s\n", "", "rmse", "mean", "median", "std", "min", "max");
  printRow("ATE (m)", e.absolute.translation_m);
  char name[64];
  std::snprintf(name, sizeof name, "RPE over %g s (m)", e.delta_s);
  printRow(name, e.relative.translation_m);
  std::snprintf(name, sizeof name, "RPE over %g s (deg)", e.delta_s);
  printRow(name, e.relative.rotation_deg);
}

int evaluate(const Arguments& arguments) {
  const auto& files = arguments.positional();
  const auto truth = readTumTrajectory(files[0]), estimate = readTumTrajectory(files[1]);
  Evaluation e;
  e.truth_poses = truth.size();
  e.estimate_poses = estimate.size();
  e.delta_s = arguments.positiveNumber("--delta", 1.0);
  e.absolute = absoluteTrajectoryError(truth, estimate, arguments.positiveNumber("--max-gap", kAssociationGapS),
                                       arguments.has("--scale"));
  e.relative = relativePoseError(truth, estimate, e.delta_s);
  if (const auto plot = arguments.value("--plot")) {
    const std::string name = std::filesystem::path(files[1]).filename().string();
    writeImageFile(*plot, drawTrajectoryComparison(truth, e.absolute, name));
  }
  if (arguments.has("--json")) {
    std::fputs(toJson(e).c_str(), stdout);
  } else {
    printTable(e);
  }
  return 0;
}

}  // namespace

int main(int argc, char** argv) {
  return runTool(argc, argv, kUsage, [&] {
    const Arguments arguments(argc, argv, {"--plot", "--delta", "--max-gap"}, {"--json", "--scale"}, {2, 2});
    return evaluate(arguments);
  });
}
