// SPDX-FileCopyrightText: 2026 The semantic_vslam authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <cstddef>
#include <vector>

#include "core/geometry/rigid_alignment.h"
#include "core/io/json_writer.h"
#include "core/io/stamp_association.h"
#include "core/io/trajectory.h"

namespace semantic_vslam {

struct ErrorStatistics {
  std::size_t count = 0;
  double rmse = 0.0, mean = 0.0, median = 0.0;
  double stddev = 0.0;  ///< of the population, as the benchmark gives it
  double min = 0.0, max = 0.0;
};

/// @param errors  not empty
ErrorStatistics statisticsOf(const std::vector<double>& errors);

/// As an object of that name.
void write(JsonWriter& json, const char* name, const ErrorStatistics& statistics);

/// One estimated position beside the true one.
struct MatchedPosition {
  Stamp stamp;                                                 ///< of the estimate
  Eigen::Vector3d truth_world_m = Eigen::Vector3d::Zero();     ///< metres, in the frame of the ground truth
  Eigen::Vector3d estimate_world_m = Eigen::Vector3d::Zero();  ///< after alignment, in the same frame
  double error_m = 0.0;
};

struct AbsoluteTrajectoryError {
  ErrorStatistics translation_m;
  PointAlignment truth_from_estimate;
  std::vector<MatchedPosition> matches;  ///< in order of time
};

/// Absolute trajectory error (Sturm et al. 2012, section IV-B; the benchmark's evaluate_ate): positions are paired by
/// stamp, aligned by one rigid motion, and compared.
/// @param with_scale  also align the scale; the benchmark does not
/// @throws Error if fewer than two poses have a partner.
AbsoluteTrajectoryError absoluteTrajectoryError(const std::vector<TimedPose>& truth,
                                                const std::vector<TimedPose>& estimate,
                                                double max_gap_s = kAssociationGapS, bool with_scale = false);

struct RelativePoseError {
  ErrorStatistics translation_m;
  ErrorStatistics rotation_deg;
};

/// Relative pose error (Sturm et al. 2012, section IV-A; the benchmark's evaluate_rpe with a fixed delta in seconds and
/// no limit on pairs): the drift between every estimated pose and the one that is closest to delta_s later. Kept as the
/// benchmark has them: pairs that end at the very last pose are left out; the true pose is the closest one, and must be
/// within twice the median interval of the ground truth.
/// @throws Error if fewer than two pairs are found.
RelativePoseError relativePoseError(const std::vector<TimedPose>& truth, const std::vector<TimedPose>& estimate,
                                    double delta_s = 1.0);

}  // namespace semantic_vslam
