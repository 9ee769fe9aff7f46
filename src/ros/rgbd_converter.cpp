// SPDX-FileCopyrightText: 2026 The semantic_vslam authors
// SPDX-License-Identifier: BSD-3-Clause
#include "ros/rgbd_converter.h"

#include <sensor_msgs/image_encodings.h>
#include <algorithm>
#include <boost/weak_ptr.hpp>
#include <map>

#include <utility>

#include "ros/conversions.h"
#include "semantic_vslam/core/common/error.h"

namespace semantic_vslam {
namespace {

bool sameCamera(const sensor_msgs::CameraInfo& a, const sensor_msgs::CameraInfo& b) {
  return a.width == b.width && a.height == b.height && a.K == b.K && a.P == b.P && a.D == b.D &&
         a.distortion_model == b.distortion_model && a.binning_x == b.binning_x && a.binning_y == b.binning_y &&
         a.roi.x_offset == b.roi.x_offset && a.roi.y_offset == b.roi.y_offset && a.roi.width == b.roi.width &&
         a.roi.height == b.roi.height;
}

void requireSize(const char* what, const sensor_msgs::Image& image, const CameraModel& camera) {
  constexpr int kLeastSidePx = 32;  // a feature's patch has 31 px
  const auto size = [](auto width, auto height) { return std::to_string(width) + "x" + std::to_string(height); };
  if (std::min(camera.width(), camera.height()) < kLeastSidePx) {
    throw Error("the camera has " + size(camera.width(), camera.height()) + " px, each side needs " +
                std::to_string(kLeastSidePx) + "; give images and camera_info of a larger size");
  }
  if (image.width == static_cast<std::uint32_t>(camera.width()) &&
      image.height == static_cast<std::uint32_t>(camera.height())) {
    return;
  }
  throw Error(std::string(what) + " image is " + size(image.width, image.height) + " but the camera model says " +
              size(camera.width(), camera.height()) +
              "; give the camera_info that belongs to it, and depth registered to colour (align_depth:=true)");
}

}  // namespace

struct RgbdConverter::Conversion {
  explicit Conversion(const RgbdMessages& pair) : messages(pair), rgb(pair.rgb), depth(pair.depth) {}

  std::mutex mutex;
  RgbdMessages messages;                                 // guarded by mutex; let go once converted
  bool done = false;                                     // guarded by mutex
  std::optional<RgbdFrame> frame;                        // guarded by mutex
  boost::weak_ptr<const sensor_msgs::Image> rgb, depth;  // to know the pair by
};

RgbdConverter::RgbdConverter(const std::string& camera_file, bool rectified) : rectified_(rectified) {
  if (!camera_file.empty()) camera_ = std::make_shared<CameraModel>(loadCameraFile(camera_file));
}

std::shared_ptr<RgbdConverter> RgbdConverter::of(const std::string& topics, const std::string& camera_file,
                                                 bool rectified) {
  static std::mutex mutex;
  static std::map<std::string, std::weak_ptr<RgbdConverter>> converters;
  const std::lock_guard<std::mutex> lock(mutex);
  std::weak_ptr<RgbdConverter>& known = converters[topics + "\n" + camera_file + (rectified ? "\nP" : "\nK")];
  std::shared_ptr<RgbdConverter> converter = known.lock();
  if (!converter) known = converter = std::make_shared<RgbdConverter>(camera_file, rectified);
  return converter;
}

PendingFrame RgbdConverter::pending(const RgbdMessages& messages) {
  const auto decode = [self = shared_from_this(), index = messages.index, conversion = conversionOf(messages)] {
    const std::lock_guard<std::mutex> lock(conversion->mutex);
    if (!conversion->done) self->convert(*conversion);
    std::optional<RgbdFrame> frame = conversion->frame;
    if (frame) frame->index = index;
    return frame;
  };
  return {fromRos(messages.rgb->header.stamp), messages.recording, decode};
}

std::shared_ptr<RgbdConverter::Conversion> RgbdConverter::conversionOf(const RgbdMessages& messages) {
  const std::lock_guard<std::mutex> lock(mutex_);
  std::shared_ptr<Conversion> found;
  const auto useless = [&](const std::weak_ptr<Conversion>& known) {
    const std::shared_ptr<Conversion> conversion = known.lock();
    if (!conversion) return true;
    if (conversion->rgb.lock() == messages.rgb && conversion->depth.lock() == messages.depth) found = conversion;
    return false;
  };
  conversions_.erase(std::remove_if(conversions_.begin(), conversions_.end(), useless), conversions_.end());
  if (!found) conversions_.push_back(found = std::make_shared<Conversion>(messages));
  return found;
}

void RgbdConverter::convert(Conversion& conversion) {
  ++converted_;
  const RgbdMessages messages = std::exchange(conversion.messages, {});
  conversion.done = true;
  refusals_.guard("frame", [&] {
    const std::shared_ptr<const CameraModel> camera = cameraFor(messages.info);
    requireSize("colour", *messages.rgb, *camera);  // before anything is copied
    requireSize("depth", *messages.depth, *camera);
    conversion.frame = makeRgbdFrame(messages.index, fromRos(messages.rgb->header.stamp), colourFromRos(messages.rgb),
                                     depthFromRos(messages.depth), kMetresPerMillimetre, camera);
    conversion.frame->sensor_frame = messages.rgb->header.frame_id;
    doubt(messages, *conversion.frame);
  });
}

/// What a driver or bag that is set up wrongly gives: said, since nothing else would tell.
void RgbdConverter::doubt(const RgbdMessages& messages, const RgbdFrame& frame) {
  constexpr int kStepPx = 16, kLongWithout = 10;  // a passer-by or a hand covers the camera for some frames
  constexpr double kLeastShare = 0.01, kFarM = 10.0;
  int looked_at = 0, known = 0, far = 0;
  for (int y = kStepPx / 2; y < frame.depth_m.rows; y += kStepPx) {
    for (int x = kStepPx / 2; x < frame.depth_m.cols; x += kStepPx, ++looked_at) {
      if (frame.depth_m(y, x) > 0.0F) ++known;
      if (frame.depth_m(y, x) > kFarM) ++far;
    }
  }
  const bool metres = messages.depth->encoding == sensor_msgs::image_encodings::TYPE_32FC1;
  without_depth_ = known < kLeastShare * looked_at ? without_depth_ + 1 : 0;
  if (without_depth_ >= kLongWithout) {
    doubts_.doubt("depth",
                  std::string("for ") + std::to_string(kLongWithout) +
                      " images next to no pixel has a depth up to 20 m; is it " +
                      (metres ? "32FC1 in millimetres (it must be metres)" : "16UC1 in another unit than millimetres") +
                      ", or is the depth camera covered?");
  } else if (far > known / 2) {
    doubts_.doubt("depth", std::string("most of it lies beyond 10 m, where no depth camera sees; ") +
                               (metres ? "32FC1 must be in metres"
                                       : "16UC1 must be in millimetres (TUM's files count 1/5000 m)"));
  }
  if (messages.rgb->header.frame_id.empty()) {
    doubts_.doubt("colour", "its frame_id is empty, so that tf cannot tell where the camera is; set it in the driver");
  } else if (frameName(messages.rgb->header.frame_id) != frameName(messages.depth->header.frame_id)) {
    doubts_.doubt("depth", "its frame_id is '" + messages.depth->header.frame_id + "', that of colour '" +
                               messages.rgb->header.frame_id +
                               "': it must be registered to colour (align_depth:=true, or depth_registered)");
  }
}

std::shared_ptr<const CameraModel> RgbdConverter::cameraFor(const sensor_msgs::CameraInfoConstPtr& info) {
  const std::lock_guard<std::mutex> lock(mutex_);
  if (!info) return camera_;
  // Making a model costs milliseconds (its table of rays), so a new one is made only when the calibration changes.
  if (!camera_info_ || !sameCamera(*camera_info_, *info)) {
    camera_ = std::make_shared<CameraModel>(fromRos(*info, rectified_));
    camera_info_ = info;
  }
  return camera_;
}

}  // namespace semantic_vslam
