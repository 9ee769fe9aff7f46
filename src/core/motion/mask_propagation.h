// SPDX-FileCopyrightText: 2026 The semantic_vslam authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <deque>
#include <functional>
#include <opencv2/core.hpp>
#include <optional>

#include "core/motion/place_lookup.h"
#include "core/motion/work_grid.h"
#include "semantic_vslam/core/common/label_set.h"
#include "semantic_vslam/core/motion/motion_config.h"

namespace semantic_vslam {

/// Carries semantic masks, which come late, from their own image to the present one along the flows in between.
///
/// Not the mask is moved but, for each present cell, the position it came from: the mask is read once, at the end, and
/// does not blur however often it moved. A chain of positions breaks where background is uncovered (the surface lies
/// behind the one it would come from) and where the flow leaves the image.
/// Labels that come late are traced through all frames since their own at once.
class MaskPropagation {
 public:
  explicit MaskPropagation(const MaskPropagationConfig& config, const RemovalConfig& removal = {});

  void setConfig(const MaskPropagationConfig& config) { config_ = config; }
  void setConfig(const RemovalConfig& removal) { removal_ = removal; }

  void reset();
  /// Advances to a new frame.
  /// @param source  where each cell was in the frame before, of traceBack(); empty for the first frame
  void addFrame(Stamp stamp, cv::Size grid_size, const cv::Mat2f& source);
  /// @param moving  what flow and depth showed of the newest frame, grid size, not 0 = moving: Fi of eq. (5); empty:
  /// nothing was seen to move
  void setMoving(const cv::Mat1b& moving);
  /// @param place  of the newest frame, whose poses go together until forgetPlaces()
  void setPlace(const PlacedFrame& place);
  /// The camera's motion to the newest frame is unknown: no surface of it can be found in earlier ones.
  void forgetPlaces();
  /// Corrects what labels say of a placed frame. @param dynamic  0 .. 1, grid size
  using Weigh = std::function<cv::Mat1f(const cv::Mat1f& dynamic, const PlacedFrame& place)>;
  /// Takes the labels of an earlier frame. People are dynamic; movable things are where enough of them moved, eq. (5).
  /// @param weigh  asked if the frame's place is known; empty: the labels are believed as they come
  /// @return false if the frame is not kept any more (too late) or never was: the labels are ignored
  bool addLabels(Stamp stamp, const cv::Mat1b& labels, const LabelSet& label_set, const Weigh& weigh = {});

  bool hasMask() const { return !mask_.empty(); }
  /// Of the frame whose labels are carried; nothing if there are none.
  std::optional<Stamp> maskStamp() const { return hasMask() ? std::optional<Stamp>(mask_stamp_) : std::nullopt; }
  /// @return probability 0 .. 1 that a cell of the newest frame is dynamic by the carried mask, faded with its age; NaN
  ///         where the mask says nothing. Empty if there is none.
  cv::Mat1f dynamicNow() const;

 private:
  struct Entry {
    Stamp stamp;
    cv::Mat2f source;  // empty for the first
    cv::Mat1b moving;
    std::optional<PlacedFrame> place;
  };

  cv::Mat1f dynamicOf(const Entry& entry, const cv::Mat1b& labels, const LabelSet& label_set) const;

  MaskPropagationConfig config_;
  RemovalConfig removal_;
  std::deque<Entry> entries_;
  cv::Mat1f mask_;    // of the labels' own frame, 0 .. 1
  cv::Mat2f origin_;  // position in that frame of each present cell; NaN = lost
  Stamp mask_stamp_;
};

}  // namespace semantic_vslam
