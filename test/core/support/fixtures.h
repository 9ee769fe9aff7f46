// SPDX-FileCopyrightText: 2026 The semantic_vslam authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <gtest/gtest.h>

#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <functional>
#include <memory>
#include <sstream>
#include <string>

#include "semantic_vslam/core/camera/rgbd_frame.h"
#include "semantic_vslam/core/common/error.h"
#include "semantic_vslam/core/common/label_set.h"

namespace semantic_vslam {

inline std::string tinyModel(const std::string& name) { return "test/data/models/" + name; }

/// Data beside the repository; empty where it is absent.
inline std::string sharedPath(const std::string& relative) {
  const char* root = std::getenv("SEMANTIC_VSLAM_SHARED");
  const std::filesystem::path path = std::filesystem::path(root != nullptr ? root : "../shared") / relative;
  if (std::filesystem::exists(path)) return path.string();
  return "";
}

inline std::string readText(const std::string& path) {
  std::ifstream in(path);
  std::ostringstream text;
  text << in.rdbuf();
  return text.str();
}

inline std::string writeText(const std::string& name, const std::string& text) {
  const std::string path = testing::TempDir() + name;
  std::ofstream(path) << text;
  return path;
}

inline std::string replaced(std::string text, const std::string& from, const std::string& to) {
  const std::size_t at = text.find(from);
  EXPECT_NE(at, std::string::npos) << from;
  return text.replace(at, from.size(), to);
}

/// The message of the ModelError that an action throws; one line, or the test fails.
inline std::string modelError(const std::function<void()>& action) {
  try {
    action();
  } catch (const ModelError& error) {
    const std::string message = error.what();
    EXPECT_EQ(message.find('\n'), std::string::npos) << message;
    return message;
  }
  ADD_FAILURE() << "no ModelError";
  return "";
}

/// background, person, chair (movable), table (static)
inline LabelSet officeLabels() {
  LabelSet set;
  set.classes.push_back({"person", Mobility::kPerson, cv::Vec3b(60, 20, 220)});
  set.classes.push_back({"chair", Mobility::kMovable, cv::Vec3b(0, 160, 255)});
  set.classes.push_back({"table", Mobility::kStatic, cv::Vec3b(50, 100, 150)});
  return set;
}

/// A gray frame of a pinhole camera without distortion; 100 px focal length, centre of the image on the axis.
inline RgbdFrame frameOf(const cv::Mat1f& depth_m) {
  CameraIntrinsics k;
  k.width = depth_m.cols;
  k.height = depth_m.rows;
  k.fx = k.fy = 100.0;
  k.cx = (depth_m.cols - 1) / 2.0;
  k.cy = (depth_m.rows - 1) / 2.0;
  return makeRgbdFrame(0, Stamp{}, cv::Mat3b(depth_m.size(), cv::Vec3b(128, 128, 128)), depth_m, 0.001,
                       std::make_shared<CameraModel>(k));
}

}  // namespace semantic_vslam
