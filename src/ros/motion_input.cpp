// SPDX-FileCopyrightText: 2026 The semantic_vslam authors
// SPDX-License-Identifier: BSD-3-Clause
#include "ros/motion_input.h"

#include <semantic_vslam/MotionReport.h>
#include <sensor_msgs/Image.h>

#include <memory>
#include <mutex>
#include <optional>
#include <utility>

#include "core/common/stamped_store.h"
#include "ros/conversions.h"

namespace semantic_vslam {
namespace {

/// Mask and report of a frame come on topics of their own, in no fixed order.
struct Halves {
  std::mutex mutex;
  StampedStore<cv::Mat1b> masks{30};               // guarded by mutex
  StampedStore<MotionReportConstPtr> reports{30};  // guarded by mutex

  std::optional<MotionResult> whole(Stamp stamp) const {
    const std::optional<MotionReportConstPtr> report = reports.find(stamp);
    const std::optional<cv::Mat1b> mask = masks.find(stamp);
    if (!report || !mask) return std::nullopt;
    MotionResult motion = fromRos(*report);
    motion.dynamic = *mask;
    return motion;
  }
};

}  // namespace

void takeMotion(NodeInputs& inputs, std::function<void(Stamp, const MotionResult&)> sink) {
  const auto take = [halves = std::make_shared<Halves>(), sink = std::move(sink)](Stamp stamp, const auto& put) {
    std::optional<MotionResult> motion;
    {
      const std::lock_guard<std::mutex> lock(halves->mutex);
      put(*halves);
      motion = halves->whole(stamp);
    }
    if (motion) sink(stamp, *motion);
  };
  inputs.topic<MotionReport>("motion/report", 10, [take](const MotionReportConstPtr& report) {
    const Stamp stamp = fromRos(report->header.stamp);
    take(stamp, [&](Halves& halves) { halves.reports.put(stamp, report); });
  });
  inputs.topic<sensor_msgs::Image>("motion/mask", 10, [take](const sensor_msgs::ImageConstPtr& mask) {
    const Stamp stamp = fromRos(mask->header.stamp);
    take(stamp, [&](Halves& halves) { halves.masks.put(stamp, maskFromRos(mask)); });
  });
}

}  // namespace semantic_vslam
