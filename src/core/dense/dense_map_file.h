// SPDX-FileCopyrightText: 2026 The semantic_vslam authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "core/dense/free_space.h"
#include "core/dense/keyframe_cloud.h"
#include "semantic_vslam/core/common/label_set.h"
#include "semantic_vslam/core/geometry/se3.h"

namespace semantic_vslam {

/// A frame between keyframes that the dense map looked at, kept with the keyframe it lies beside.
struct DenseLook {
  std::uint64_t order = 0;  ///< of DenseKeyframe
  KeyframeCloud cloud;      ///< thinned to what the voxels need
  FreeSpaceView view;
  SE3 T_keyframe_camera = SE3::Identity();
};

/// A keyframe of the dense map as it is kept: its surface and free space in its own camera frame, and where it lies.
struct DenseKeyframe {
  std::uint64_t order = 0;  ///< in which keyframes and looks came, over all of the map
  KeyframeCloud cloud;
  FreeSpaceView view;
  SE3 T_world_camera = SE3::Identity();  ///< newest known
  std::vector<DenseLook> looks;          ///< the newest few beside it, in their order
  bool thinned = false;                  ///< the cloud, to what the voxels need
  bool culled = false;                   ///< the sparse map dropped it
};

/// All that the dense map is made from, so that it can follow later loops, too. Voxels, grid and clouds follow from it.
struct DenseMapContent {
  std::uint32_t map_id = 0;  ///< of the sparse map that the keyframes belong to, see MapSnapshot
  LabelSet labels;
  std::vector<DenseKeyframe> keyframes;  ///< in the order of their ids
};

/// The content of a file, and back. The same content gives the same bytes.
std::string serializeDenseMap(const DenseMapContent& content);
/// @param name  of the file, for the message  @throws FileError, one line, if it is no such file, of another format
///              version, truncated or damaged
DenseMapContent parseDenseMap(const std::string& bytes, const std::string& name);
/// @throws FileError
DenseMapContent readDenseMap(const std::string& path);

}  // namespace semantic_vslam
