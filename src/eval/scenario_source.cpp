// SPDX-FileCopyrightText: 2026 The semantic_vslam authors
// SPDX-License-Identifier: BSD-3-Clause
#include "eval/scenario_source.h"

#include <cstdio>

#include "core/common/arguments.h"

namespace semantic_vslam {

ScenarioSource::ScenarioSource(const Scenario& scenario, const CameraIntrinsics& intrinsics)
    : room_(scenario, intrinsics), camera_(std::make_shared<const CameraModel>(intrinsics)) {
  for (int i = 0; i < room_.frameCount(); ++i) {
    const double time_s = room_.frameTime(i);
    truth_.push_back({SyntheticRoom::stampAt(time_s), scenario.camera.at(time_s)});
  }
}

std::optional<RgbdFrame> ScenarioSource::next() {
  if (next_ >= truth_.size()) return std::nullopt;
  rendered_ = room_.render(room_.frameTime(static_cast<int>(next_)));
  mask_ = rendered_.person_mask | rendered_.moving_mask;
  rendered_.frame.index = next_++;
  return rendered_.frame;
}

CameraIntrinsics syntheticCamera(const std::string& size) {
  CameraIntrinsics k;
  char rest = 0;
  if (std::sscanf(size.c_str(), "%dx%d%c", &k.width, &k.height, &rest) != 2 || k.width < 64 || k.height < 48 ||
      k.width > 4096 || k.height > 4096) {
    throw UsageError("--size must be WIDTHxHEIGHT from 64x48 to 4096x4096, is '" + size + "'");
  }
  // Not the 525 px of an uncalibrated Kinect: camera_info is exact here, and readers warn of that value.
  k.fx = k.fy = 520.0 * k.width / 640.0;
  k.cx = 0.5 * k.width - 1.0;
  k.cy = 0.5 * k.height + 1.0;
  return k;
}

}  // namespace semantic_vslam
