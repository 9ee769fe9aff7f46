// SPDX-FileCopyrightText: 2026 The semantic_vslam authors
// SPDX-License-Identifier: BSD-3-Clause
// Runs a few frames of a wall that nobody passes through the library: it links, and public headers are enough to use
// it.
#include <cstdio>
#include <memory>
#include <opencv2/core.hpp>

#include "semantic_vslam/core/camera/rgbd_frame.h"
#include "semantic_vslam/core/common/config_fields.h"
#include "semantic_vslam/core/common/error.h"
#include "semantic_vslam/core/pipeline/config.h"
#include "semantic_vslam/core/pipeline/pipeline.h"

using namespace semantic_vslam;

namespace {

/// A wall with a pattern of random squares, 2 m before the camera.
RgbdFrame wallAt(std::uint64_t index, const std::shared_ptr<const CameraModel>& camera) {
  constexpr int kSquarePx = 8;
  cv::Mat3b bgr(camera->height(), camera->width());
  cv::RNG random(1);
  for (int y = 0; y < bgr.rows; y += kSquarePx) {
    for (int x = 0; x < bgr.cols; x += kSquarePx) {
      const int grey = random.uniform(0, 256);
      bgr(cv::Rect(x, y, kSquarePx, kSquarePx)).setTo(cv::Scalar(grey, grey, grey));
    }
  }
  const cv::Mat1f depth_m(bgr.size(), 2.0F);
  constexpr double kDepthUnitM = 0.001;  // of 16-bit images only
  return makeRgbdFrame(index, Stamp::fromSeconds(1.0 + index / 30.0), bgr, depth_m, kDepthUnitM, camera);
}

}  // namespace

int main() {
  try {
    SystemConfig config;
    setConfig(config, "tracking.orb.features", "500");
    Pipeline slam(config);
    const auto camera = std::make_shared<const CameraModel>(CameraIntrinsics());
    StepResult last;
    for (std::uint64_t i = 0; i < 5; ++i) last = slam.step(wallAt(i, camera));
    slam.finish();
    const double moved_m = last.T_world_camera().translation().norm();
    std::printf("%s, moved by %.4f m; %zu poses, %zu points\n", stateName(last.tracking.state), moved_m,
                slam.trajectory().size(), slam.cloud().size());
    return last.posed() && moved_m < 0.01 && !slam.trajectory().empty() ? 0 : 1;
  } catch (const Error& error) {
    std::fprintf(stderr, "%s\n", error.what());
    return 1;
  }
}
