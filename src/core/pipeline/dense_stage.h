// SPDX-FileCopyrightText: 2026 The semantic_vslam authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Geometry>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <memory>
#include <optional>
#include <string>

#include "core/pipeline/keyframe_inputs.h"
#include "core/pipeline/removal.h"
#include "semantic_vslam/core/dense/dense_config.h"
#include "semantic_vslam/core/pipeline/messages.h"

namespace semantic_vslam {

class DenseMapper;
struct DenseMapContent;

/// Stage 4: the labelled map without people, which follows the keyframes' poses. Knows no thread.
class DenseStage {
 public:
  /// What was saved of a map, by its MapSnapshot::map_id, or nothing. Asked whenever another map begins.
  using Saved = std::function<std::optional<DenseMapContent>(std::uint32_t map_id)>;

  /// @throws ConfigError
  DenseStage(const DenseConfig& config, const RemovalConfig& removal, Saved saved = {});
  ~DenseStage();
  DenseStage(DenseStage&&) noexcept;

  /// Adds a keyframe as soon as its place in the world is known; one of a map that was left is passed over. A frame
  /// between keyframes is passed over, too, where the keyframe it lies beside has no known place.
  /// @return what is removed from it, see removedPixels()
  cv::Mat1b add(const KeyframeInput& input);
  /// Takes the poses as they stand. Those of another map begin an empty one.
  void take(const MapSnapshot& map);
  /// Other classes than before begin an empty map.
  void take(const LabelSet& label_set);
  /// Notices and poses may come in no order: what still comes of a map that was left is not the newest.
  bool isOfNewestMap(std::uint32_t map_id);
  void clear();
  /// See DenseMapper.
  void clearBox(const Eigen::AlignedBox3d& box_m);
  /// Writes all that the map is made from, whole or not at all; `saved` is to find it again.
  /// @throws Error if it is empty: the file stays as it is  @throws FileError
  void save(const std::string& path) const;
  /// Whether a saved map of this id is an earlier state of the present one.
  bool isOfMap(std::uint32_t map_id) const;

  DenseMapper& map();
  const DenseMapper& map() const;
  const LabelSet& labels() const;
  /// Keyframes whose place in the world is not known yet.
  std::size_t waiting() const;
  /// Keyframes that the sparse map dropped before they were mapped.
  std::size_t culled() const;
  /// Grows whenever the map that is served may have changed.
  std::size_t changes() const;

 private:
  struct Inside;
  std::unique_ptr<Inside> inside_;
};

}  // namespace semantic_vslam
