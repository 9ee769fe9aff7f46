// SPDX-FileCopyrightText: 2026 The semantic_vslam authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "core/io/frame_source.h"
#include "semantic_vslam/core/tracking/tracking_state.h"

namespace semantic_vslam {

/// A stretch of a recording that the system does not get to see: frames [begin, end), by their index.
struct Cut {
  enum class Kind {
    kBlack,   ///< the lens is covered: black images without depth
    kSkipped  ///< the frames are missing: the camera is somewhere else at once
  };
  std::uint64_t begin = 0, end = 0;
  Kind kind = Kind::kBlack;
};

/// @return "black" or "skipped".
const char* cutName(Cut::Kind kind);

struct CutPlan {
  int cuts = 5;
  double lead_s = 4.0;           ///< uncut at the start: a map must be there
  double least_s = 1.0;          ///< length of a cut, uniform between
  double most_s = 3.0;           ///< these two
  double least_between_s = 1.5;  ///< uncut after each cut
};

/// Draws cuts of both kinds, in order of time and spread over the recording.
/// @param frames, fps  of the recording  @throws Error if it is too short for the plan
std::vector<Cut> drawCuts(std::size_t frames, double fps, const CutPlan& plan, std::uint64_t seed);

/// Another recording with cuts in it.
class CutSource final : public FrameSource {
 public:
  /// @param recording  must outlive this object  @param cuts  in order of time, not overlapping
  CutSource(FrameSource& recording, std::vector<Cut> cuts) : recording_(recording), cuts_(std::move(cuts)) {}

  std::optional<RgbdFrame> next() override;
  void skip(std::size_t count) override { recording_.skip(count); }
  std::size_t size() const override { return recording_.size(); }
  std::size_t skippedBroken() const override { return recording_.skippedBroken(); }
  std::shared_ptr<const CameraModel> camera() const override { return recording_.camera(); }
  const std::vector<TimedPose>& groundTruth() const override { return recording_.groundTruth(); }
  /// Empty while the images are black.
  cv::Mat1b groundTruthMask() const override { return black_ ? cv::Mat1b() : recording_.groundTruthMask(); }

 private:
  FrameSource& recording_;
  std::vector<Cut> cuts_;
  bool black_ = false;
};

/// What the system said of a frame when it saw it.
struct ToldPose {
  std::uint64_t frame = 0;  ///< index in the recording
  Stamp stamp;
  TrackingState state = TrackingState::kInitialising;
  SE3 T_world_camera = SE3::Identity();
};

/// What became of one cut.
struct Recovery {
  Cut cut;
  int frames_needed = -1;      ///< the first frame after the cut that is OK, from 1; -1 = none
  double worst_error_m = 0.0;  ///< of the frames told OK from the cut's begin to the next cut
};

/// Judges every cut by the ground truth: positions told OK are compared after a rigid alignment by the frames that do
/// not lie within a second after a cut, so that a wrong place found after one cannot hide in the alignment.
/// @param told  in order of time  @throws Error if nothing can be aligned
std::vector<Recovery> scoreRecovery(const std::vector<Cut>& cuts, const std::vector<ToldPose>& told,
                                    const std::vector<TimedPose>& truth);

}  // namespace semantic_vslam
