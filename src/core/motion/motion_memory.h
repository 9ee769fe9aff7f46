// SPDX-FileCopyrightText: 2026 The semantic_vslam authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <opencv2/core.hpp>

#include "core/motion/depth_vote.h"
#include "core/motion/rigid_flow.h"
#include "core/motion/work_grid.h"
#include "semantic_vslam/core/motion/motion_config.h"

namespace semantic_vslam {

/// Log-odds that a cell belongs to something that moves, gathered over frames and carried along with the flow.
class MotionMemory {
 public:
  explicit MotionMemory(const MotionMemoryConfig& config);

  void setConfig(const MotionMemoryConfig& config) { config_ = config; }

  void reset(cv::Size grid_size);
  /// Moves the evidence from the previous frame to the present one along the flow and lets it fade with time.
  /// @param source  of traceBack()  @param dt_s  time between the frames
  void carry(const cv::Mat2f& source, double dt_s);
  /// The same where the camera's motion is known: a cell whose brightness the rigid flow explains as well takes the
  /// evidence from there, so that a walker's flow, smeared over a still wall, does not carry his evidence onto it.
  void carry(const cv::Mat2f& source, double dt_s, const RigidFlowResidual& residual, const cv::Mat1f& brightness_gain);
  /// Adds what this frame shows.
  /// @param brightness_gain  of compareBrightness()  @param vote  empty images: no earlier depth yet
  /// @param room  of RoomMemory, likewise
  void add(const GridFrame& current, const RigidFlowResidual& residual, const cv::Mat1f& brightness_gain,
           const DepthVote& vote, const DepthVote& room = {});
  const cv::Mat1f& logOdds() const { return log_odds_; }

 private:
  void fade(cv::Mat1f carried, double age_s);

  MotionMemoryConfig config_;
  cv::Mat1f log_odds_;
};

}  // namespace semantic_vslam
