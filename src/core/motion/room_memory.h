// SPDX-FileCopyrightText: 2026 The semantic_vslam authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <deque>
#include <opencv2/core.hpp>
#include <optional>
#include <vector>

#include "core/motion/depth_vote.h"
#include "core/motion/place_lookup.h"
#include "core/motion/work_grid.h"
#include "semantic_vslam/core/geometry/timed_pose.h"
#include "semantic_vslam/core/motion/motion_config.h"

namespace semantic_vslam {

/// What keyframes say of a frame. `stayed` counts where nothing moved and no label said a person; `known` is 1 where a
/// keyframe of some seconds ago saw the same surface at rest and called it no person, and -1 where one saw none there.
/// Labels that call much of a keyframe that stands still a person are not believed: there it is 1, too.
struct RoomVote : DepthVote {
  cv::Mat1f known;
};

/// The map's memory of free space: the depth images of keyframes, at the poses that tracking gives them.
///
/// What stands where a keyframe saw free space or a farther surface came later, however long ago that keyframe is and
/// however still the thing stands now. A thing that keyframes have seen at one place for `settle_s` belongs to the room
/// from then on, and the older keyframes forget the space it takes; a person by a label never does.
///
/// Poses come late, as labels do: frames are kept for a moment by their stamp, until tracking says which of them are
/// keyframes and where they stood. Not thread-safe.
class RoomMemory {
 public:
  explicit RoomMemory(const RoomMemoryConfig& config) : config_(config) {}

  void setConfig(const RoomMemoryConfig& config) { config_ = config; }

  void clear();
  /// The chain of motions between frames is broken: until the next pose arrives it is not known where frames stand.
  void breakOdometry();

  /// @param place  of the newest frame, by odometry  @param moving  MotionResult's, without labels
  /// @param semantic  of MaskPropagation::dynamicNow(); may be empty
  void addFrame(const PlacedFrame& place, const cv::Mat1f& depth_low_m, const cv::Mat1b& moving,
                const cv::Mat1f& semantic);
  /// Where tracking found a frame: ties the odometry to the map. One that is not kept any more is ignored.
  void takeFramePose(const TimedPose& pose);
  /// All keyframes of the map at their present poses. Those whose frames are kept become references; references follow
  /// the map's corrections, also where their keyframe has been culled since. With none of them in the list the map is
  /// another one: all is forgotten.
  void takeKeyframePoses(const std::vector<TimedPose>& poses);

  /// Compares a frame with some of the references that saw its place, others each time.
  /// @param now  by odometry
  /// @return nothing if it is not known where the frame stands, or no reference saw the place; only every third
  ///         row, in turn, is looked at, the others are 0
  std::optional<RoomVote> look(const PlacedFrame& now, const WorkGrid& grid, const RigidFlowConfig& rigid);

  std::size_t references() const { return references_.size(); }
  std::size_t bytes() const;

 private:
  /// A frame as it was seen. In `recent_` its place is by odometry, in `references_` in the map.
  struct View {
    PlacedFrame place;
    cv::Mat1f depth_low_m;
    cv::Mat1b state;          // bits of CellState
    bool believed = true;     // its labels
    std::size_t entered = 0;  // cells of the last frame that saw it which stand in space it saw free
  };
  /// What has come to rest is looked for in the newest reference, by one older reference a frame, newest first; then
  /// these forget the space it takes.
  struct Settling {
    std::size_t subject = 0;  // index in references_, as are the others; the list does not change meanwhile
    std::size_t next = 0;     // this one and those before it are still to be asked
    cv::Mat1f since_s;        // how long before the subject each cell's surface was there already; NaN = no candidate
    cv::Mat1b open;           // 0: an older reference saw the space free, what lies before it does not count
    bool forgetting = false;
  };

  void forgetRoom();
  const View* recent(Stamp stamp) const;
  void addReference(const View& view, const SE3& T_world_camera);
  void dropOne();
  void startSettling();
  void settle(const WorkGrid& grid, const RigidFlowConfig& rigid);
  void finishSearch();
  /// Indices of references that saw part of what the frame sees.
  std::vector<std::size_t> overlapping(const PlacedFrame& now_in_map, const WorkGrid& grid) const;

  RoomMemoryConfig config_;
  std::deque<View> recent_;       // oldest first
  std::vector<View> references_;  // oldest first
  std::optional<SE3> T_world_odometry_;
  Stamp posed_;  // frame that tied both together
  std::optional<Settling> settling_;
  Stamp last_settled_;
  std::size_t turn_ = 0;
  int first_row_ = 0;
};

}  // namespace semantic_vslam
