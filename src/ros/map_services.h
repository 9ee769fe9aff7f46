// SPDX-FileCopyrightText: 2026 The semantic_vslam authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string>

#include "core/runtime/dense_runner.h"
#include "ros/node_inputs.h"

namespace semantic_vslam {

/// Offers the services of octomap_server and map_server below the node's name: octomap_binary, octomap_full
/// (octomap_msgs/GetOctomap), clear_bbx (octomap_msgs/BoundingBoxQuery), reset (std_srvs/Empty), static_map
/// (nav_msgs/GetMap; fails while there is no grid).
void offerMapServices(NodeInputs& inputs, DenseRunner& runner, const std::string& map_frame);

}  // namespace semantic_vslam
