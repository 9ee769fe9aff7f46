// SPDX-FileCopyrightText: 2026 The semantic_vslam authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <deque>
#include <memory>
#include <opencv2/core.hpp>

#include "core/motion/camera_motion.h"
#include "core/motion/dense_flow.h"
#include "core/motion/depth_vote.h"
#include "core/motion/label_memory.h"
#include "core/motion/mask_propagation.h"
#include "core/motion/motion_memory.h"
#include "core/motion/room_memory.h"
#include "semantic_vslam/core/camera/rgbd_frame.h"
#include "semantic_vslam/core/common/label_set.h"
#include "semantic_vslam/core/motion/motion_config.h"
#include "semantic_vslam/core/motion/motion_result.h"

namespace semantic_vslam {

/// Finds what moves by itself in a stream of RGB-D frames. Stands alone: the camera's own motion between two frames
/// comes from points that were static in the first of them. Not thread-safe.
class MotionDetector {
 public:
  /// A longer gap than this between two frames shares too little of the image for the flow: a new start.
  static constexpr double kLongestGapS = 0.5;

  /// @throws ConfigError if a value is out of range.
  explicit MotionDetector(const MotionConfig& config, const RemovalConfig& removal = {});

  /// Takes other thresholds between two frames. What is known of the scene stays, unless the model or the grid differ.
  /// @throws ConfigError if a value is out of range; the old ones then stay.
  void setConfig(const MotionConfig& config);
  void setConfig(const RemovalConfig& removal) { propagation_.setConfig(removal); }

  /// The first frame, and one whose stamp does not follow the last or whose camera differs, starts anew: all static.
  MotionResult detect(const RgbdFrame& frame);
  /// Labels of an earlier frame; they count from the next frame on. Those of a frame that is unknown or too old are
  /// ignored.
  /// @param labels  height x width, indices into label_set
  /// @return true if they were taken
  bool addLabels(Stamp stamp, const cv::Mat1b& labels, const LabelSet& label_set);
  /// Where tracking found an earlier frame in the map (state OK); counts from the next frame on, as labels do.
  void takeFramePose(const TimedPose& pose) { room_.takeFramePose(pose); }
  /// All keyframes of the map at their present poses: whenever there is a new one, or the map was corrected. What their
  /// depth images saw free is remembered (RoomMemory).
  void takeKeyframePoses(const std::vector<TimedPose>& poses) { room_.takeKeyframePoses(poses); }
  void reset();

 private:
  /// What one frame's flow and depth show, on the grid.
  struct Estimate {
    MotionModel model = MotionModel::kNone;
    cv::Mat1b moving;    // 255 = moving; of the rigid model once its surfaces have been put together
    cv::Mat1f log_odds;  // above 0 = moving; of the rigid model only
    cv::Mat1f residual_px;
    CameraMotion camera;
    int inliers = 0;
  };

  void start(const RgbdFrame& frame);
  /// All but the map's memory.
  void forgetFrames();
  /// Probability that a cell stood still in the previous frame, carried to the present one. @param source  of
  /// traceBack()  @param semantic  of MaskPropagation::dynamicNow()
  cv::Mat1f staticWeight(const cv::Mat2f& source, const cv::Mat1f& semantic) const;
  Estimate explainByHomography(const GridFrame& current, const cv::Mat2f& flow_cells, const cv::Mat1f& static_weight);
  /// Whether the step from the previous frame is a long one.
  bool isSlow(const GridFrame& current) const;
  DenseFlow& flowFor(const GridFrame& current);
  DepthVote askReferences(const GridFrame& current);
  Estimate explainByRigidFlow(const GridFrame& current, const cv::Mat2f& flow_cells, const cv::Mat2f& source,
                              const cv::Mat1f& static_weight);
  /// Labels are evidence: where keyframes have known a surface at rest for seconds they give way.
  /// @param semantic  of MaskPropagation::dynamicNow()
  void giveWay(const cv::Mat2f& source, cv::Mat1f& semantic);
  void learnKnown(const RoomVote& vote);
  PlacedFrame placed(const GridFrame& current) const;
  void keepReference(const GridFrame& current);
  MotionResult compose(const GridFrame& current, const Estimate& estimate, const cv::Mat2f& flow_cells,
                       const cv::Mat1f& semantic, cv::Size full_size);

  MotionConfig config_;
  DenseFlow quick_flow_, slow_flow_;
  MotionMemory memory_;
  MaskPropagation propagation_;
  LabelMemory label_memory_;
  RoomMemory room_;
  std::unique_ptr<WorkGrid> grid_;
  std::shared_ptr<const CameraModel> camera_;
  GridFrame previous_;
  cv::Mat1f known_;                 // 0 .. 1: long known at rest, grid size; empty while there are no labels
  cv::Mat1f dynamic_probability_;   // of the previous frame, grid size
  SE3 velocity_ = SE3::Identity();  // T_previous_current of the last frame
  double velocity_dt_s_ = 0.0;
  SE3 T_odometry_camera_ = SE3::Identity();  // of the last frame; chained motions, drifts
  std::deque<DepthReference> references_;    // oldest first
  std::size_t turn_ = 0;                     // of the references
  int first_row_ = 0;                        // that the next one is compared in
};

}  // namespace semantic_vslam
