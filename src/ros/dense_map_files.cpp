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
  stage.save(output_ + kDenseFile);
  stage.map().saveForOthers(output_);
  return "map.dense, cloud.pcd, mesh.ply, map.ot, map.bt, grid.pgm and grid.yaml saved in " + output_;
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
