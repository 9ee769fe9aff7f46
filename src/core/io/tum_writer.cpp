// SPDX-FileCopyrightText: 2026 The semantic_vslam authors
// SPDX-License-Identifier: BSD-3-Clause
#include "core/io/tum_writer.h"

#include <unistd.h>

#include <cassert>
#include <cmath>
#include <cstdio>
#include <filesystem>
#include <opencv2/imgcodecs.hpp>
#include <system_error>

#include "core/common/atomic_file.h"
#include "semantic_vslam/core/common/error.h"

namespace semantic_vslam {
namespace {

namespace fs = std::filesystem;

constexpr double kUnitsPerM = 5000.0;

void makeFolder(const fs::path& path) {
  std::error_code error;
  fs::create_directories(path, error);
  if (error) throw FileError("folder '" + path.string() + "' cannot be made: " + error.message());
}

/// The whole folder is temporary, so its images need no detour of their own.
void writeImage(const fs::path& path, const cv::Mat& image) {
  // Fast compression: level 1 costs a third of the default's time for a tenth more bytes.
  const std::vector<int> parameters = {cv::IMWRITE_PNG_COMPRESSION, 1, cv::IMWRITE_JPEG_QUALITY, 95};
  bool written = false;
  try {
    written = cv::imwrite(path.string(), image, parameters);
  } catch (const cv::Exception& error) {
    throw FileError("cannot write image '" + path.string() + "': " + error.err);
  }
  if (!written) throw FileError("cannot write image '" + path.string() + "': folder not writable or disk full");
}

cv::Mat1w depthUnits(const cv::Mat1f& depth_m) {
  cv::Mat1w units(depth_m.size());
  for (int v = 0; v < units.rows; ++v) {
    for (int u = 0; u < units.cols; ++u) {
      const double value = std::round(depth_m(v, u) * kUnitsPerM);
      units(v, u) = value > 0.0 && value <= 65535.0 ? static_cast<std::uint16_t>(value) : 0;
    }
  }
  return units;
}

std::string cameraText(const CameraIntrinsics& k) {
  char text[512];
  std::snprintf(text, sizeof text,
                "width: %d\nheight: %d\nfx: %.9g\nfy: %.9g\ncx: %.9g\ncy: %.9g\n"
                "distortion: [%.9g, %.9g, %.9g, %.9g, %.9g]\n",
                k.width, k.height, k.fx, k.fy, k.cx, k.cy, k.distortion[0], k.distortion[1], k.distortion[2],
                k.distortion[3], k.distortion[4]);
  return text;
}

}  // namespace

TumWriter::TumWriter(const std::string& folder, const CameraIntrinsics& camera, ColorFormat format)
    : camera_(camera), format_(format) {
  fs::path path = fs::absolute(folder).lexically_normal();
  if (!path.has_filename()) path = path.parent_path();  // a slash at the end
  folder_ = path.string();
  if (fs::exists(path)) throw FileError("'" + folder_ + "' exists already; remove it or choose another name");
  temporary_ =
      (path.parent_path() / (".writing-" + std::to_string(getpid()) + "-" + path.filename().string())).string();
  for (const char* part : {"rgb", "depth"}) makeFolder(fs::path(temporary_) / part);
}

TumWriter::~TumWriter() {
  std::error_code ignored;
  if (!finished_) fs::remove_all(temporary_, ignored);
}

void TumWriter::write(const TumFrame& frame) {
  assert(stamps_.empty() || stamps_.back() < frame.stamp);
  const std::string name = formatStamp(frame.stamp);
  const fs::path root(temporary_);
  const char* extension = format_ == ColorFormat::kPng ? ".png" : ".jpg";
  writeImage(root / "rgb" / (name + extension), frame.bgr);
  writeImage(root / "depth" / (name + ".png"), depthUnits(frame.depth_m));
  for (const auto& [part, image] :
       {std::pair<const char*, const cv::Mat1b&>("mask", frame.mask), {"labels", frame.labels}}) {
    if (image.empty()) continue;
    if (!fs::exists(root / part)) makeFolder(root / part);
    writeImage(root / part / (name + ".png"), image);
  }
  stamps_.push_back(frame.stamp);
  if (frame.T_world_camera) poses_.push_back({frame.stamp, *frame.T_world_camera});
}

void TumWriter::finish() {
  const std::string extension = format_ == ColorFormat::kPng ? ".png" : ".jpg";
  std::string rgb = "# color images\n# timestamp filename\n", depth = "# depth maps\n# timestamp filename\n", both;
  for (const Stamp stamp : stamps_) {
    const std::string name = formatStamp(stamp);
    const std::string rgb_row = name + " rgb/" + name + extension, depth_row = name + " depth/" + name + ".png";
    rgb += rgb_row + "\n";
    depth += depth_row + "\n";
    both += rgb_row + " " + depth_row + "\n";
  }
  const auto at = [&](const char* file) { return (fs::path(temporary_) / file).string(); };
  writeTextAtomically(at("rgb.txt"), rgb);
  writeTextAtomically(at("depth.txt"), depth);
  writeTextAtomically(at("associations.txt"), both);
  writeTextAtomically(at("camera.yaml"), cameraText(camera_));
  if (!poses_.empty()) writeTumTrajectory(at("groundtruth.txt"), poses_);
  std::error_code error;
  fs::rename(temporary_, folder_, error);
  if (error) throw FileError("'" + temporary_ + "' cannot be renamed to '" + folder_ + "': " + error.message());
  finished_ = true;
}

}  // namespace semantic_vslam
