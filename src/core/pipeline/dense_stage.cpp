// SPDX-FileCopyrightText: 2026 The semantic_vslam authors
// SPDX-License-Identifier: BSD-3-Clause
#include "core/pipeline/dense_stage.h"

#include <algorithm>
#include <optional>
#include <set>
#include <vector>

#include "core/dense/dense_mapper.h"
#include "core/dense/waiting_keyframes.h"
#include "semantic_vslam/core/common/config_fields.h"
#include "semantic_vslam/core/common/log.h"

namespace semantic_vslam {

struct DenseStage::Inside {
  Inside(const DenseConfig& dense_config, const RemovalConfig& removal_config)
      : config(dense_config), removal(removal_config) {
    validateConfig(removal);
    mapper.emplace(config, label_set);
  }

  void start(std::uint32_t id) {
    map_id = id;
    poses.clear();
    waiting.clear();
    changes += mapper->rebuilds() + 1;  // the new mapper counts from 0
    mapper.emplace(config, label_set);
  }
  void place() {
    const std::size_t before = waiting.size();
    waiting.place(poses, *mapper);
    if (waiting.size() != before) ++changes;
  }

  const DenseConfig config;
  const RemovalConfig removal;
  LabelSet label_set;
  std::optional<DenseMapper> mapper;
  WaitingKeyframes waiting;
  std::vector<KeyframePose> poses;  ///< newest known
  std::optional<std::uint32_t> map_id, newest_map_id;
  std::set<std::uint32_t> left_maps;
  std::size_t changes = 0, culled = 0;
};

DenseStage::DenseStage(const DenseConfig& config, const RemovalConfig& removal)
    : inside_(std::make_unique<Inside>(config, removal)) {}
DenseStage::~DenseStage() = default;
DenseStage::DenseStage(DenseStage&&) noexcept = default;

bool DenseStage::isOfNewestMap(std::uint32_t map_id) {
  if (inside_->left_maps.count(map_id) > 0) return false;
  if (inside_->newest_map_id && *inside_->newest_map_id != map_id) inside_->left_maps.insert(*inside_->newest_map_id);
  inside_->newest_map_id = map_id;
  return true;
}

cv::Mat1b DenseStage::add(const KeyframeInput& input) {
  const cv::Mat1b removed = removedPixels(input.motion, input.labels, inside_->label_set, inside_->removal);
  if (!isOfNewestMap(input.keyframe.map_id)) return removed;
  if (input.keyframe.map_id != inside_->map_id) inside_->start(input.keyframe.map_id);
  inside_->waiting.add({input.keyframe.id, input.frame, input.labels, removed});
  inside_->place();
  return removed;
}

void DenseStage::take(const MapSnapshot& map) {
  if (!isOfNewestMap(map.map_id)) return;
  if (map.map_id != inside_->map_id) inside_->start(map.map_id);
  inside_->poses = map.poses;
  inside_->place();
  inside_->mapper->updatePoses(inside_->poses);
  // What the sparse map has dropped nobody will place any more; of what is newer than this state of it nobody knows.
  std::uint64_t next = map.poses.empty() ? 0 : map.poses.back().keyframe.value() + 1;
  if (!map.unplaced.empty()) next = std::max(next, map.unplaced.back().value() + 1);
  const std::size_t waited = inside_->waiting.size();
  inside_->waiting.keepOnly([&](KeyframeId id) {
    return id.value() >= next || std::binary_search(map.unplaced.begin(), map.unplaced.end(), id);
  });
  inside_->culled += waited - inside_->waiting.size();
}

void DenseStage::take(const LabelSet& label_set) {
  // The same classes come again when their publisher is connected anew.
  if (label_set.classes == inside_->label_set.classes) return;
  inside_->label_set = label_set;
  if (inside_->mapper->keyframes() > 0) logWarning("the classes changed: the dense map starts anew");
  clear();
}

void DenseStage::clear() {
  const std::vector<KeyframePose> poses = inside_->poses;
  inside_->start(inside_->map_id.value_or(0));
  inside_->poses = poses;
}

DenseMapper& DenseStage::map() { return *inside_->mapper; }
const DenseMapper& DenseStage::map() const { return *inside_->mapper; }
const LabelSet& DenseStage::labels() const { return inside_->label_set; }
std::size_t DenseStage::waiting() const { return inside_->waiting.size(); }
std::size_t DenseStage::culled() const { return inside_->culled; }
std::size_t DenseStage::changes() const { return inside_->changes + inside_->mapper->rebuilds(); }

}  // namespace semantic_vslam
