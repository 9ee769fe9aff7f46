// SPDX-FileCopyrightText: 2026 The semantic_vslam authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <opencv2/core.hpp>
#include <string>
#include <vector>

#include "core/dense/keyframe_cloud.h"
#include "semantic_vslam/core/common/label_set.h"
#include "semantic_vslam/core/geometry/se3.h"

namespace semantic_vslam {

struct MapPictureConfig {
  int view_width_px = 800;
  int view_height_px = 600;
  double point_m = 0.014;

  template <class Visitor>
  void visit(Visitor& v) {
    v.field("view_width_px", view_width_px, 160, 4000, "width of each of the four views");
    v.field("view_height_px", view_height_px, 120, 4000, "height of each of the four views");
    v.field("point_m", point_m, 0.001, 1.0,
            "edge of a drawn point; a little more than the cloud's resolution closes it");
  }
};

/// The direction against gravity, in the world: the normal of the plane that holds most points among those within 50
/// degrees of prior_up (a floor or a desk). Seeded RANSAC: the same cloud gives the same answer.
/// @param prior_up  e.g. (0, -1, 0), up in the first camera's optical frame, which is roughly level
/// @return unit vector; prior_up where no plane holds a twentieth of the points
Eigen::Vector3d estimateUpDirection(const std::vector<LabelledPoint>& cloud, const Eigen::Vector3d& prior_up);

/// A picture of a labelled cloud, drawn without a display: in perspective from behind the camera's path and from above,
/// each in the colours of the camera and of the labels, with the path, a scale bar and a legend of the labels in it.
/// @param cloud       in the world, the first camera's optical frame
/// @param trajectory  T_world_camera in order of time; may be empty
/// @return 8-bit BGR, 2 x view_width_px wide, a little over 2 x view_height_px high. @throws ConfigError
cv::Mat3b drawMapPicture(const std::vector<LabelledPoint>& cloud, const std::vector<SE3>& trajectory,
                         const LabelSet& labels, const MapPictureConfig& config);

/// Writes it as a PNG file, whole or not at all. @throws FileError naming path and cause.
void saveMapPicture(const std::string& path, const std::vector<LabelledPoint>& cloud,
                    const std::vector<SE3>& trajectory, const LabelSet& labels, const MapPictureConfig& config);

}  // namespace semantic_vslam
