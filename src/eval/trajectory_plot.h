// SPDX-FileCopyrightText: 2026 The semantic_vslam authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <opencv2/core.hpp>
#include <string>
#include <vector>

#include "eval/plot_panel.h"
#include "eval/trajectory_error.h"

namespace semantic_vslam {

/// Draws both paths from above (x-y) and from the side (x-z) in the frame of the ground truth, with a line from every
/// estimated position to the true one, and the error over time below. Axes in metres and seconds.
/// @param truth  the whole ground truth; the part within the time of the estimate is drawn
/// @return 1500 x 1060 pixels
cv::Mat3b drawTrajectoryComparison(const std::vector<TimedPose>& truth, const AbsoluteTrajectoryError& error,
                                   const std::string& title);

/// Draws the position error over time into an area of a canvas. @param error  at least one match
void drawErrorOverTime(PlotCanvas& canvas, cv::Rect area_px, const AbsoluteTrajectoryError& error);

}  // namespace semantic_vslam
