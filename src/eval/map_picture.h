// SPDX-FileCopyrightText: 2026 The semantic_vslam authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <opencv2/core.hpp>
#include <vector>

#include "eval/map_score.h"
#include "semantic_vslam/core/camera/camera_model.h"
#include "semantic_vslam/core/common/label_set.h"

namespace semantic_vslam {

/// The map as a camera sees it, with what is wrong in red, beside what it should be.
/// @param right_view  the empty room's map or a true image, of the camera's size
cv::Mat3b drawBesideTruth(const std::vector<LabelledPoint>& map, const std::vector<LabelledPoint>& wrong,
                          const cv::Mat3b& right_view, const SE3& T_world_camera, const CameraModel& camera,
                          double point_size_m);

/// The navigation grid over the true plan. Truth: white is passable, gray is not. Grid: green is free, blue occupied,
/// red free though something stands there.
/// @param grid  in the room's frame
cv::Mat3b drawGrid(const OccupancyGrid& grid, double low_m, double high_m, const RoomTruth& truth);

/// The things of the room from above, as seen, in the colours of their classes, a disc at the centroid of each; over
/// them the boxes of the map's objects, a cross at the centroid of each.
/// @param objects  in the room's frame
cv::Mat3b drawObjects(const std::vector<MapObject>& objects, const SeenRoom& room, const LabelSet& labels);

}  // namespace semantic_vslam
