// SPDX-FileCopyrightText: 2026 The semantic_vslam authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <algorithm>
#include <cmath>
#include <opencv2/core.hpp>

#include "core/motion/camera_motion.h"
#include "core/motion/work_grid.h"
#include "semantic_vslam/core/geometry/se3.h"
#include "semantic_vslam/core/motion/motion_config.h"

namespace semantic_vslam {

/// A frame's surfaces and where its camera stood: what later frames find their own surfaces in.
struct PlacedFrame {
  Stamp stamp;
  cv::Mat1f depth_m, surface_m;             ///< GridFrame's
  SE3 T_odometry_camera = SE3::Identity();  ///< by chained frame-to-frame motions
};

/// The present frame's surfaces in the eyes of an earlier frame's camera.
class PlaceLookup {
 public:
  struct Sighting {
    cv::Point cell;    ///< of the earlier frame
    float depth_m;     ///< of the surface, from the earlier camera
    float measured_m;  ///< what the earlier camera measured there; 0 = hole
    float margin_m;    ///< how far both may differ on one surface
    bool hole;         ///< the present frame has no depth there
    /// The surface was there then. A hole (a black screen, a lamp) that was a hole counts too.
    bool same() const {
      return hole ? measured_m <= 0.0F : measured_m > 0.0F && std::abs(measured_m - depth_m) < margin_m;
    }
  };

  /// Two frames whose poses come from one chain of frame-to-frame motions.
  PlaceLookup(const PlacedFrame& now, const PlacedFrame& earlier, const WorkGrid& grid, const RigidFlowConfig& config)
      : PlaceLookup(now, earlier, grid, config, kDriftMetresPerSecond * secondsBetween(earlier.stamp, now.stamp)) {}
  /// @param pose_error_m  what the poses of both may differ by from the truth, metres
  PlaceLookup(const PlacedFrame& now, const PlacedFrame& earlier, const WorkGrid& grid, const RigidFlowConfig& config,
              double pose_error_m)
      : now_(now),
        earlier_(earlier),
        grid_(grid),
        config_(config),
        T_earlier_now_(earlier.T_odometry_camera.inverse() * now.T_odometry_camera),
        base_margin_m_(static_cast<float>(config.min_depth_margin_m + pose_error_m)),
        seen_(grid.size().width) {}

  /// Calls look(x, sighting) for each cell of a row that lies in the earlier image.
  template <class Look>
  void row(int y, const Look& look) {
    const float *depth = now_.depth_m[y], *surface = now_.surface_m[y];
    grid_.projectRow(y, surface, T_earlier_now_, seen_);
    for (int x = 0; x < grid_.size().width; ++x) {
      const bool visible = surface[x] > 0.0F && seen_.depth_m[x] >= kNearestM;
      if (!visible || !grid_.contains({seen_.x[x], seen_.y[x]})) continue;
      const cv::Point cell(static_cast<int>(seen_.x[x] + 0.5F), static_cast<int>(seen_.y[x] + 0.5F));
      const float measured_m = earlier_.depth_m(cell);
      const float margin_m = base_margin_m_ + kMarginSigmas * depthSigma(config_, std::max(surface[x], measured_m));
      look(x, Sighting{cell, seen_.depth_m[x], measured_m, margin_m, depth[x] <= 0.0F});
    }
  }

 private:
  // Noise of both depths together that is tolerated, in standard deviations of one.
  static constexpr float kMarginSigmas = 4.0F;
  static constexpr float kNearestM = 0.1F;  // nearer than this to the earlier camera, nothing was seen
  // Error that chained frame-to-frame motions gather, metres per second.
  static constexpr double kDriftMetresPerSecond = 0.02;

  const PlacedFrame &now_, &earlier_;
  const WorkGrid& grid_;
  const RigidFlowConfig& config_;
  const CellTransform T_earlier_now_;
  const float base_margin_m_;
  ProjectedRow seen_;
};

}  // namespace semantic_vslam
