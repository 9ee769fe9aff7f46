// SPDX-FileCopyrightText: 2026 The semantic_vslam authors
// SPDX-License-Identifier: BSD-3-Clause
#include "ros/dense_map_files.h"

#include <ros/console.h>
#include <unistd.h>

#include "core/dense/dense_mapper.h"
#include "semantic_vslam/core/common/error.h"

namespace semantic_vslam {

constexpr const char* kDenseFile = "/map.dense";

DenseMapFiles::DenseMapFiles(const NodeletHandles& node, const std::string& output_directory, const std::string& loaded)
    : output_(outputFolder(output_directory)),
      loaded_(loaded.empty() ? "" : expandHome(loaded) + kDenseFile),
      recovery_(node.private_nh, "map.dense") {}

std::optional<DenseMapContent> DenseMapFiles::find(std::uint32_t map_id) const {
  for (const std::string& path : {recovery_.left().value_or(""), loaded_, output_ + kDenseFile}) {
    if (path.empty() || access(path.c_str(), F_OK) != 0) continue;
    try {
      DenseMapContent content = readDenseMap(path);
      if (content.map_id == map_id) return content;
    } catch (const FileError& error) {
      ROS_ERROR("%s; going on without it", error.what());
    }
  }
  return std::nullopt;
}

std::string DenseMapFiles::save(DenseStage& stage) const {
  stage.map().finish();
  const std::size_t kept = stage.map().keyframes() > 0 ? keyframesOfLargerMap(stage) : 0;
  if (kept == 0) stage.save(output_ + kDenseFile);
  stage.map().saveForOthers(output_);
  const std::string for_others = "cloud.pcd, mesh.ply, map.ot, map.bt, grid.pgm and grid.yaml saved in " + output_;
  if (kept == 0) return "map.dense, " + for_others;
  return for_others + ", but not map.dense: the one there is another map, of " + std::to_string(kept) +
         " keyframes, and this one has " + std::to_string(stage.map().keyframes());
}

/// @return keyframes of map.dense, if it is another map than this one, and larger; else 0
std::size_t DenseMapFiles::keyframesOfLargerMap(const DenseStage& stage) const {
  const std::string path = output_ + kDenseFile;
  if (access(path.c_str(), F_OK) != 0) return 0;
  try {
    const DenseMapContent there = readDenseMap(path);
    return !stage.isOfMap(there.map_id) && there.keyframes.size() > stage.map().keyframes() ? there.keyframes.size()
                                                                                            : 0;
  } catch (const FileError&) {
    return 0;  // no map: nothing is lost
  }
}

void DenseMapFiles::saveWithSparse(DenseStage& stage) const {
  if (stage.map().keyframes() > 0) stage.save(output_ + kDenseFile);
}

void DenseMapFiles::keepForRecovery(DenseStage& stage) {
  if (stage.map().keyframes() == 0) return recovery_.forgetOwn();
  // A keyframe that comes while an old one is forgotten is a change, too.
  const std::size_t state = stage.changes() + stage.map().keyframes() + stage.map().forgotten();
  recovery_.keep(state, [&](const std::string& path) { stage.save(path); });
}

}  // namespace semantic_vslam
