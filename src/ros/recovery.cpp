// SPDX-FileCopyrightText: 2026 The semantic_vslam authors
// SPDX-License-Identifier: BSD-3-Clause
#include "ros/recovery.h"

#include <ros/console.h>
#include <unistd.h>

#include <algorithm>
#include <cstdlib>
#include <exception>
#include <filesystem>
#include <fstream>

#include "semantic_vslam/core/common/error.h"

namespace semantic_vslam {
namespace {

namespace fs = std::filesystem;

const ros::WallDuration kShortest(1.0);
constexpr double kRestPerWork = 100.0;

fs::path home() {
  const char* home = std::getenv("HOME");
  return home != nullptr ? home : "/tmp";
}

fs::path rosHome() {
  const char* folder = std::getenv("ROS_HOME");
  return folder != nullptr ? fs::path(folder) : home() / ".ros";
}

}  // namespace

Recovery::Recovery(const ros::NodeHandle& private_nh, const std::string& file) {
  private_nh.getParam("restarted", restarted_);
  private_nh.deleteParam("restarted");  // it is of this start alone
  const fs::path folder = rosHome() / "semantic_vslam" / fs::path(private_nh.getNamespace()).relative_path();
  std::error_code error;
  fs::create_directories(folder, error);  // if not, keep() says so
  path_ = (folder / file).string();
  if (!restarted_) fs::remove(path_, error);  // of another run
}

std::optional<std::string> Recovery::left() const {
  std::error_code error;
  return restarted_ && fs::is_regular_file(path_, error) ? std::optional<std::string>(path_) : std::nullopt;
}

void Recovery::keep(std::size_t state, const std::function<void(const std::string&)>& write) {
  const std::lock_guard<std::mutex> lock(mutex_);
  const ros::SteadyTime begin = ros::SteadyTime::now();
  if (state == kept_ || begin < next_) return;
  try {
    write(path_);
    kept_ = state;
  } catch (const std::exception& error) {
    if (!warned_) ROS_WARN("what has been mapped would not survive the end of this process: %s", error.what());
    warned_ = true;
  }
  const ros::SteadyTime end = ros::SteadyTime::now();
  next_ = end + std::max(kShortest, (end - begin) * kRestPerWork);
}

void Recovery::forgetOwn() {
  {
    const std::lock_guard<std::mutex> lock(mutex_);
    if (kept_ == 0) return;
  }
  forget();
}

void Recovery::forget() {
  const std::lock_guard<std::mutex> lock(mutex_);
  std::error_code error;
  fs::remove(path_, error);
  kept_ = 0;
}

void Recovery::leaveWord(const std::string& word, bool left) const {
  std::error_code error;
  if (left) {
    std::ofstream(path_ + "." + word);
  } else {
    fs::remove(path_ + "." + word, error);
  }
}

bool Recovery::hasWord(const std::string& word) const {
  std::error_code error;
  return restarted_ && fs::exists(path_ + "." + word, error);
}

std::string expandHome(const std::string& path) {
  const bool at_home = path == "~" || path.rfind("~/", 0) == 0;
  return at_home ? (home() / path.substr(std::min<std::size_t>(2, path.size()))).string() : path;
}

std::string outputFolder(const std::string& folder) {
  const fs::path path = expandHome(folder);
  std::error_code error;
  fs::create_directories(path, error);
  if (!fs::is_directory(path) || access(path.c_str(), W_OK) != 0) {
    throw ConfigError("the output folder '" + path.string() + "' cannot be written to; name another one (output:=DIR)");
  }
  return path.string();
}

}  // namespace semantic_vslam
