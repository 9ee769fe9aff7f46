// SPDX-FileCopyrightText: 2026 The semantic_vslam authors
// SPDX-License-Identifier: BSD-3-Clause
#include "core/pipeline/dense_stage.h"

#include <algorithm>
#include <optional>
#include <set>
#include <utility>
#include <vector>

#include "core/common/atomic_file.h"
#include "core/dense/dense_mapper.h"
#include "core/dense/waiting_keyframes.h"
#include "semantic_vslam/core/common/config_fields.h"
#include "semantic_vslam/core/common/error.h"
#include "semantic_vslam/core/common/log.h"

namespace semantic_vslam {

namespace {

/// The first number that a state of the sparse map does not know yet.
KeyframeId nextKeyframe(const MapSnapshot& map) {
  std::uint64_t next = map.poses.empty() ? 0 : map.poses.back().keyframe.value() + 1;
  if (!map.unplaced.empty()) next = std::max(next, map.unplaced.back().value() + 1);
  return KeyframeId(next);
}

}  // namespace

struct DenseStage::Inside {
  Inside(const DenseConfig& dense_config, const RemovalConfig& removal_config, Saved saved_maps)
      : config(dense_config), removal(removal_config), saved(std::move(saved_maps)) {
    validateConfig(removal);
    mapper.emplace(config, label_set);
  }

  void start(std::uint32_t id) {
    map_id = id;
    origin = 0;
    poses.clear();
    waiting.clear();
    changes += mapper->rebuilds() + 1;  // the new mapper counts from 0
    mapper.emplace(config, label_set);
  }
  /// Takes keyframes of a map that was saved, but for those that are newer than the sparse map: it will give their
  /// numbers to others.
  void restore(std::vector<DenseKeyframe> keyframes, const MapSnapshot& map) {
    const KeyframeId next = nextKeyframe(map);
    const auto newer = std::find_if(keyframes.begin(), keyframes.end(),
                                    [&](const DenseKeyframe& held) { return !(held.cloud.keyframe < next); });
    keyframes.erase(newer, keyframes.end());
    mapper->restore(std::move(keyframes));
  }
  /// Begins another map than before, with what was saved of it.
  void begin(const MapSnapshot& map) {
    // The sparse map came back under another number, since its process did: it is the one that is held here.
    if (map.origin != 0 && map_id && (map.origin == *map_id || map.origin == origin) && mapper->keyframes() > 0) {
      map_id = map.map_id;
      origin = map.origin;
      restore(mapper->content(map.map_id).keyframes, map);
      waiting.clear();
      ++changes;
      return;
    }
    start(map.map_id);
    origin = map.origin;
    for (const std::uint32_t id : {map.map_id, map.origin}) {
      std::optional<DenseMapContent> content = saved && id != 0 ? saved(id) : std::nullopt;
      if (!content) continue;
      if (label_set.size() <= 1) label_set = content->labels;
      if (content->labels.classes != label_set.classes) {
        logWarning("the saved dense map has other classes than the network: it is not taken");
        continue;
      }
      mapper.emplace(config, label_set);
      restore(std::move(content->keyframes), map);
      logInfo("the dense map of " + std::to_string(mapper->keyframes()) + " saved keyframes is back");
      return;
    }
  }
  void look(const KeyframeInput& input, const cv::Mat1b& removed) {
    const auto beside = std::find_if(poses.begin(), poses.end(),
                                     [&](const KeyframePose& pose) { return pose.keyframe == input.keyframe.id; });
    if (input.keyframe.map_id != map_id || beside == poses.end()) return;
    mapper->look(beside->keyframe, input.frame, input.labels, removed,
                 beside->T_world_camera * *input.T_keyframe_camera);
    ++changes;
  }
  void place() {
    const std::size_t before = waiting.size();
    waiting.place(poses, *mapper);
    if (waiting.size() != before) ++changes;
  }

  const DenseConfig config;
  const RemovalConfig removal;
  const Saved saved;
  LabelSet label_set;
  std::optional<DenseMapper> mapper;
  WaitingKeyframes waiting;
  std::vector<KeyframePose> poses;  ///< newest known
  std::optional<std::uint32_t> map_id, newest_map_id;
  std::uint32_t origin = 0;  ///< of MapSnapshot
  std::set<std::uint32_t> left_maps;
  std::size_t changes = 0, culled = 0;
};

DenseStage::DenseStage(const DenseConfig& config, const RemovalConfig& removal, Saved saved)
    : inside_(std::make_unique<Inside>(config, removal, std::move(saved))) {}
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
  if (input.T_keyframe_camera) {
    inside_->look(input, removed);
    return removed;
  }
  if (input.keyframe.map_id != inside_->map_id) inside_->start(input.keyframe.map_id);
  inside_->waiting.add({input.keyframe.id, input.frame, input.labels, removed});
  inside_->place();
  return removed;
}

void DenseStage::take(const MapSnapshot& map) {
  if (!isOfNewestMap(map.map_id)) return;
  if (map.map_id != inside_->map_id) inside_->begin(map);
  inside_->poses = map.poses;
  inside_->place();
  inside_->mapper->updatePoses(inside_->poses);
  // What the sparse map has dropped nobody will place any more; of what is newer than this state of it nobody knows.
  const KeyframeId next = nextKeyframe(map);
  const std::size_t waited = inside_->waiting.size();
  inside_->waiting.keepOnly(
      [&](KeyframeId id) { return !(id < next) || std::binary_search(map.unplaced.begin(), map.unplaced.end(), id); });
  inside_->culled += waited - inside_->waiting.size();
}

void DenseStage::take(const LabelSet& label_set) {
  // The same classes come again when their publisher is connected anew. Nobody labels any more: what has labels stays.
  const bool nobody_labels = label_set.size() <= 1 && inside_->mapper->keyframes() > 0;
  if (label_set.classes == inside_->label_set.classes || nobody_labels) return;
  inside_->label_set = label_set;
  if (inside_->mapper->keyframes() > 0) logWarning("the classes changed: the dense map starts anew");
  clear();
}

void DenseStage::clear() {
  const std::vector<KeyframePose> poses = inside_->poses;
  inside_->start(inside_->map_id.value_or(0));
  inside_->poses = poses;
}

void DenseStage::clearBox(const Eigen::AlignedBox3d& box_m) { inside_->mapper->clearBox(box_m); }

void DenseStage::save(const std::string& path) const {
  if (inside_->mapper->keyframes() == 0) throw Error("the dense map is empty; '" + path + "' is not touched");
  writeTextAtomically(path, serializeDenseMap(inside_->mapper->content(inside_->map_id.value_or(0))));
}

bool DenseStage::isOfMap(std::uint32_t map_id) const {
  return map_id == inside_->map_id || (inside_->origin != 0 && map_id == inside_->origin);
}

DenseMapper& DenseStage::map() { return *inside_->mapper; }
const DenseMapper& DenseStage::map() const { return *inside_->mapper; }
const LabelSet& DenseStage::labels() const { return inside_->label_set; }
std::size_t DenseStage::waiting() const { return inside_->waiting.size(); }
std::size_t DenseStage::culled() const { return inside_->culled; }
std::size_t DenseStage::changes() const { return inside_->changes + inside_->mapper->rebuilds(); }

}  // namespace semantic_vslam
