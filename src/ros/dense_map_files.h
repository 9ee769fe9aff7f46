// SPDX-FileCopyrightText: 2026 The semantic_vslam authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <optional>
#include <string>

#include "core/dense/dense_map_file.h"
#include "core/pipeline/dense_stage.h"
#include "ros/recovery.h"
#include "ros/stage_diagnostics.h"

namespace semantic_vslam {

/// What the mapping node keeps on disk: the dense map, for its services and for the node that takes its place when it
/// is killed. All that takes a stage is called by the thread that runs it.
class DenseMapFiles {
 public:
  /// @param output_directory  made if need be  @param loaded  folder with a saved map that tracking loads; empty: none
  /// @throws ConfigError if the folder cannot be written to
  DenseMapFiles(const NodeletHandles& node, const std::string& output_directory, const std::string& loaded);

  /// @return the map that was saved with the sparse one of this id, or was left by this node when it was killed
  std::optional<DenseMapContent> find(std::uint32_t map_id) const;
  /// map.dense, unless another map that is larger lies there, and the files of DenseMapper::saveForOthers().
  /// @return what was done  @throws FileError
  std::string save(DenseStage& stage) const;
  /// map.dense alone, which is loaded with the sparse map that was saved just now.
  void saveWithSparse(DenseStage& stage) const;
  void keepForRecovery(DenseStage& stage);

 private:
  std::size_t keyframesOfLargerMap(const DenseStage& stage) const;

  const std::string output_, loaded_;
  Recovery recovery_;
};

}  // namespace semantic_vslam
