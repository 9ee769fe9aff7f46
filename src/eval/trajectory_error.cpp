// SPDX-FileCopyrightText: 2026 The semantic_vslam authors
// SPDX-License-Identifier: BSD-3-Clause
#include "eval/trajectory_error.h"

#include <algorithm>
#include <cassert>
#include <cmath>
#include <optional>

#include "semantic_vslam/core/common/error.h"
#include "semantic_vslam/core/common/stage_timing.h"

namespace semantic_vslam {
namespace {

std::vector<Stamp> stampsOf(const std::vector<TimedPose>& poses) {
  std::vector<Stamp> stamps;
  for (const TimedPose& pose : poses) stamps.push_back(pose.stamp);
  return stamps;
}

double medianIntervalS(const std::vector<TimedPose>& poses) {
  std::vector<double> intervals_s;
  for (std::size_t i = 1; i < poses.size(); ++i) {
    intervals_s.push_back(secondsBetween(poses[i - 1].stamp, poses[i].stamp));
  }
  return intervals_s.empty() ? 0.0 : quantile(intervals_s, 0.5);
}

constexpr double kDegPerRad = 180.0 / M_PI;

}  // namespace

ErrorStatistics statisticsOf(const std::vector<double>& errors) {
  assert(!errors.empty());
  const double count = static_cast<double>(errors.size());
  double sum = 0.0, sum_of_squares = 0.0;
  for (const double error : errors) {
    sum += error;
    sum_of_squares += error * error;
  }
  ErrorStatistics statistics;
  statistics.count = errors.size();
  statistics.mean = sum / count;
  statistics.rmse = std::sqrt(sum_of_squares / count);
  statistics.median = quantile(errors, 0.5);
  double variance = 0.0;
  for (const double error : errors) variance += (error - statistics.mean) * (error - statistics.mean) / count;
  statistics.stddev = std::sqrt(variance);
  const auto [min, max] = std::minmax_element(errors.begin(), errors.end());
  statistics.min = *min;
  statistics.max = *max;
  return statistics;
}

void write(JsonWriter& json, const char* name, const ErrorStatistics& statistics) {
  json.beginObject(name);
  json.field("rmse", statistics.rmse);
  json.field("mean", statistics.mean);
  json.field("median", statistics.median);
  json.field("std", statistics.stddev);
  json.field("min", statistics.min);
  json.field("max", statistics.max);
  json.field("count", statistics.count);
  json.endObject();
}

AbsoluteTrajectoryError absoluteTrajectoryError(const std::vector<TimedPose>& truth,
                                                const std::vector<TimedPose>& estimate, double max_gap_s,
                                                bool with_scale) {
  const auto pairs = associateStamps(stampsOf(estimate), stampsOf(truth), max_gap_s);
  if (pairs.size() < 2) {
    throw Error("only " + std::to_string(pairs.size()) + " of " + std::to_string(estimate.size()) +
                " estimated poses have a true pose close in time; do both trajectories belong to one recording?");
  }
  std::vector<Eigen::Vector3d> estimate_m, truth_m;
  for (const auto& [i, j] : pairs) {
    estimate_m.push_back(estimate[i].T_world_camera.translation());
    truth_m.push_back(truth[j].T_world_camera.translation());
  }
  AbsoluteTrajectoryError result;
  result.truth_from_estimate = alignPoints(estimate_m, truth_m, with_scale);
  std::vector<double> errors_m;
  for (std::size_t k = 0; k < pairs.size(); ++k) {
    const Eigen::Vector3d aligned_m = result.truth_from_estimate.apply(estimate_m[k]);
    errors_m.push_back((aligned_m - truth_m[k]).norm());
    result.matches.push_back({estimate[pairs[k].first].stamp, truth_m[k], aligned_m, errors_m.back()});
  }
  result.translation_m = statisticsOf(errors_m);
  return result;
}

RelativePoseError relativePoseError(const std::vector<TimedPose>& truth, const std::vector<TimedPose>& estimate,
                                    double delta_s) {
  const std::int64_t delta_ns = Stamp::fromSeconds(delta_s).ns;
  const double max_gap_s = 2.0 * medianIntervalS(truth);
  std::vector<double> translations_m, rotations_deg;
  for (const TimedPose& begin : estimate) {
    const TimedPose& end = *closestPose(estimate, Stamp{begin.stamp.ns + delta_ns});
    if (&end == &estimate.back()) continue;
    const TimedPose* true_begin = closestPose(truth, begin.stamp, max_gap_s);
    const TimedPose* true_end = closestPose(truth, end.stamp, max_gap_s);
    if (true_begin == nullptr || true_end == nullptr) continue;
    const SE3 moved = begin.T_world_camera.inverse() * end.T_world_camera;
    const SE3 truly_moved = true_begin->T_world_camera.inverse() * true_end->T_world_camera;
    const SE3 drift = truly_moved.inverse() * moved;  // eq. (1) of Sturm et al.
    translations_m.push_back(drift.translation().norm());
    rotations_deg.push_back(rotationAngle(drift) * kDegPerRad);
  }
  if (translations_m.size() < 2) {
    throw Error("no two pairs of estimated poses are " + std::to_string(delta_s) +
                " s apart and have true poses close in time");
  }
  return {statisticsOf(translations_m), statisticsOf(rotations_deg)};
}

}  // namespace semantic_vslam
