// SPDX-FileCopyrightText: 2026 The semantic_vslam authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string>
#include <vector>

#include "semantic_vslam/core/common/config_fields.h"

namespace semantic_vslam {

/// Runs one nodelet as a process of its own, or tells of it (--help, --list-config), for which no ROS master is needed.
/// @param node_name  unless __name:= says otherwise  @param nodelet  class, as in nodelet_plugins.xml
/// @param keys  its parameters with their defaults
/// @return exit status: 1 if the nodelet did not start, of which it has said why; 2 for a wrong option
int runNodelet(int argc, char** argv, const std::string& node_name, const std::string& nodelet,
               const std::vector<ConfigEntry>& keys);

}  // namespace semantic_vslam
