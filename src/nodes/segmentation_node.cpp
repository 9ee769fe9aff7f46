// SPDX-FileCopyrightText: 2026 The semantic_vslam authors
// SPDX-License-Identifier: BSD-3-Clause
#include "ros/node_configs.h"
#include "ros/nodelet_main.h"

int main(int argc, char** argv) {
  using namespace semantic_vslam;
  return runNodelet(argc, argv, "slam_segmentation", "semantic_vslam/Segmentation",
                    listConfig(SegmentationNodeConfig()));
}
