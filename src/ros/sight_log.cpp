// SPDX-FileCopyrightText: 2026 The semantic_vslam authors
// SPDX-License-Identifier: BSD-3-Clause
#include "ros/sight_log.h"

#include <cstdio>
#include <utility>

namespace semantic_vslam {
namespace {

// A camera at the edge of what the map shows is lost and found many times a second: a loss that follows so soon is said
// only when it lasts.
constexpr double kFlickerS = 5.0, kLastsS = 1.0;
// A room has hundreds; less is a covered lens, the dark, a bare wall.
constexpr int kLittleToSee = 100;

std::string seconds(double value) {
  char text[32];
  std::snprintf(text, sizeof(text), "%.1f s", value);
  return text;
}

}  // namespace

std::optional<SightLog::Line> SightLog::next(Stamp stamp, const TrackingOutput& output) {
  const bool other_map = map_id_ != output.map->map_id;
  if (since_ && stamp < *since_) since_.reset();  // the clock was set back
  if (other_map) {
    map_id_ = output.map->map_id;
    ok_in_map_ = false;
    if (!output.new_world) since_.reset();
  }
  switch (output.tracking.state) {
    case TrackingState::kInitialising: since_.reset(); return std::nullopt;
    case TrackingState::kOk: return found(stamp, output);
    case TrackingState::kRecentlyLost:
    case TrackingState::kLost: return lost(stamp, output);
  }
  return std::nullopt;
}

std::optional<SightLog::Line> SightLog::lost(Stamp stamp, const TrackingOutput& output) {
  if (!since_) {
    since_ = stamp;
    said_ = map_begun_ = false;
  }
  map_begun_ = map_begun_ || output.is_keyframe;
  if (said_ || output.tracking.state != TrackingState::kLost) return std::nullopt;
  const double for_s = secondsBetween(*since_, stamp);
  if (last_line_ && *last_line_ <= stamp && secondsBetween(*last_line_, stamp) < kFlickerS && for_s < kLastsS) {
    return std::nullopt;
  }
  said_ = true;
  last_line_ = stamp;
  const std::string features = std::to_string(output.tracking.features) + " features";
  if (!ok_in_map_) {
    return Line{LogLevel::kInfo, "the camera is looked for in the map of " + std::to_string(output.map->keyframes()) +
                                     " keyframes: " + features};
  }
  const bool little = output.tracking.features < kLittleToSee;
  return Line{LogLevel::kWarning,
              "tracking lost its place " + seconds(for_s) + " ago: " + features + ", " +
                  (little ? "too few to know a place by (a covered lens, the dark, a bare wall, people in front?)"
                          : "which fit no place of the map; it is found again where the camera has been before")};
}

std::optional<SightLog::Line> SightLog::found(Stamp stamp, const TrackingOutput& output) {
  const bool begins = !std::exchange(ok_in_map_, true), relocalised = output.tracking.relocalised;
  if (!begins && !since_) return std::nullopt;
  const std::string after = since_ ? " after " + seconds(secondsBetween(*since_, stamp)) : "";
  since_.reset();
  if (!begins && !said_) return std::nullopt;
  last_line_ = stamp;
  if (output.new_world) {
    return Line{LogLevel::kInfo, "tracking goes on" + after + " in a new map: the one before was too small to keep"};
  }
  if (begins && !relocalised) return Line{LogLevel::kInfo, "tracking begins in a new map"};
  return Line{LogLevel::kInfo, "tracking has found its place in the map of " + std::to_string(output.map->keyframes()) +
                                   " keyframes" + after +
                                   (relocalised  ? " by relocalisation"
                                    : map_begun_ ? ": the map that it began meanwhile is joined"
                                                 : " where it was lost")};
}

}  // namespace semantic_vslam
