// SPDX-FileCopyrightText: 2026 The semantic_vslam authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <ros/node_handle.h>
#include <ros/time.h>

#include <functional>
#include <mutex>
#include <optional>
#include <string>

namespace semantic_vslam {

/// What a node leaves for the one that takes its place when it is killed: a file that is written again and again, in
/// ROS_HOME, below the node's name. scripts/respawn and load_nodelet tell the next one by the parameter ~restarted.
class Recovery {
 public:
  /// @param file  its name
  Recovery(const ros::NodeHandle& private_nh, const std::string& file);

  /// @return the file that a killed node left; nothing if this is no new start of one
  std::optional<std::string> left() const;
  /// Has the file written, unless `state` is what it was last time or writing it so soon would take more than a
  /// hundredth of the time. What write() throws is said once.
  void keep(std::size_t state, const std::function<void(const std::string& path)>& write);
  /// Nothing is left: what was mapped so far is not wanted any more. Waits for a keep() under way.
  void forget();
  /// The same, but for what a killed node left: it may not have been taken up yet.
  void forgetOwn();
  /// A word for the node that takes the place of this one when it is killed, or that it is not left any more.
  void leaveWord(const std::string& word, bool left) const;
  /// @return whether the killed node left it
  bool hasWord(const std::string& word) const;

 private:
  std::mutex mutex_;
  std::string path_;
  bool restarted_ = false, warned_ = false;
  std::size_t kept_ = 0;
  ros::SteadyTime next_;
};

/// @return the path, with the home folder for a leading ~
std::string expandHome(const std::string& path);

/// @return a folder, made if need be; a leading ~ is the home folder  @throws ConfigError if it cannot be written to
std::string outputFolder(const std::string& folder);

}  // namespace semantic_vslam
