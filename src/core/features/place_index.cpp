// SPDX-FileCopyrightText: 2026 The semantic_vslam authors
// SPDX-License-Identifier: BSD-3-Clause
#include "core/features/place_index.h"

#include <algorithm>
#include <cstdlib>
#include <cstring>

#include "semantic_vslam/core/common/config_fields.h"

namespace semantic_vslam {
namespace {

constexpr int kDescriptorBits = 256;
// A bit splits a leaf only if the smaller side gets this share (HBST: balanced splits keep the tree shallow).
constexpr double kMinSplitShare = 0.2;

/// Indices of the static features, at most `most` of them, evenly drawn.
std::vector<int> drawFeatures(const FrameFeatures& features, int most) {
  std::vector<int> usable;
  for (int i = 0; i < static_cast<int>(features.size()); ++i) {
    if (features.features[i].surelyStatic()) usable.push_back(i);
  }
  const auto count = static_cast<std::int64_t>(usable.size());
  if (count <= most) return usable;
  std::vector<int> drawn;
  for (std::int64_t i = 0; i < most; ++i) drawn.push_back(usable[i * count / most]);
  return drawn;
}

int distance(const std::array<std::uint64_t, 4>& a, const std::array<std::uint64_t, 4>& b) {
  int sum = 0;
  for (int i = 0; i < 4; ++i) sum += __builtin_popcountll(a[i] ^ b[i]);
  return sum;
}

std::array<std::uint64_t, 4> bitsOf(const FrameFeatures& features, int index) {
  std::array<std::uint64_t, 4> bits;
  std::memcpy(bits.data(), features.descriptors.ptr(index), sizeof(bits));
  return bits;
}

}  // namespace

PlaceIndex::PlaceIndex(const PlaceIndexConfig& config) : config_(config) {
  validateConfig(config_);
  clear();
}

void PlaceIndex::clear() {
  trees_.assign(config_.trees, Tree());
  slots_.clear();
  slot_of_.clear();
}

void PlaceIndex::add(KeyframeId id, const FrameFeatures& features) {
  remove(id);
  const auto slot = static_cast<std::uint32_t>(slots_.size());
  slots_.push_back(id);
  slot_of_[id] = slot;
  for (const int i : drawFeatures(features, config_.max_features)) {
    const Entry entry{bitsOf(features, i), slot};
    for (int t = 0; t < config_.trees; ++t) insert(trees_[t], t, entry);
  }
}

void PlaceIndex::remove(KeyframeId id) {
  const auto found = slot_of_.find(id);
  if (found == slot_of_.end()) return;
  slots_[found->second] = KeyframeId();
  slot_of_.erase(found);
  // Sweeping when half of the keyframes are gone bounds the memory at twice what is needed, at constant cost each.
  if (slots_.size() > 2 * slot_of_.size() + 16) sweep();
}

std::vector<PlaceMatch> PlaceIndex::query(const FrameFeatures& features, int max_results) const {
  std::vector<int> votes(slots_.size(), 0), last_voter(slots_.size(), -1);
  const std::vector<int> queries = drawFeatures(features, static_cast<int>(features.size()));
  for (const int i : queries) {
    const Bits bits = bitsOf(features, i);
    for (const Tree& tree : trees_) {
      for (const Entry& entry : tree.nodes[leafOf(tree, bits)].entries) {
        if (last_voter[entry.slot] == i || distance(entry.bits, bits) > config_.max_distance) continue;
        last_voter[entry.slot] = i;
        ++votes[entry.slot];
      }
    }
  }
  std::vector<PlaceMatch> matches;
  for (std::size_t slot = 0; slot < slots_.size(); ++slot) {
    if (votes[slot] == 0 || !slots_[slot].valid()) continue;
    matches.push_back({slots_[slot], votes[slot], votes[slot] / static_cast<double>(queries.size())});
  }
  std::sort(matches.begin(), matches.end(), [](const PlaceMatch& a, const PlaceMatch& b) {
    return a.votes != b.votes ? a.votes > b.votes : a.keyframe < b.keyframe;
  });
  if (static_cast<int>(matches.size()) > max_results) matches.resize(max_results);
  return matches;
}

int PlaceIndex::leafOf(const Tree& tree, const Bits& bits) {
  int node = 0;
  while (tree.nodes[node].bit >= 0) node = tree.nodes[node].child[bitOf(bits, tree.nodes[node].bit) ? 1 : 0];
  return node;
}

void PlaceIndex::insert(Tree& tree, int tree_index, const Entry& entry) {
  const int leaf = leafOf(tree, entry.bits);
  auto& entries = tree.nodes[leaf].entries;
  entries.push_back(entry);
  // A leaf that no bit splits is tried again each time it has grown by another leaf_size.
  if (entries.size() > 1 && (entries.size() - 1) % config_.leaf_size == 0) split(tree, tree_index, leaf);
}

void PlaceIndex::split(Tree& tree, int tree_index, int leaf) {
  auto entries = std::move(tree.nodes[leaf].entries);
  entries.erase(std::remove_if(entries.begin(), entries.end(), [this](const Entry& e) { return !live(e); }),
                entries.end());
  const int bit = static_cast<int>(entries.size()) > config_.leaf_size ? chooseBit(entries, tree_index) : -1;
  if (bit < 0) {
    tree.nodes[leaf].entries = std::move(entries);
    return;
  }
  tree.nodes[leaf].entries = {};
  tree.nodes[leaf].bit = bit;
  for (const int side : {0, 1}) {
    Node child;
    std::copy_if(entries.begin(), entries.end(), std::back_inserter(child.entries),
                 [&](const Entry& e) { return bitOf(e.bits, bit) == (side == 1); });
    tree.nodes[leaf].child[side] = static_cast<int>(tree.nodes.size());
    tree.nodes.push_back(std::move(child));
  }
}

/// The tree's own bit that comes nearest to halving the entries; -1 if none comes near.
int PlaceIndex::chooseBit(const std::vector<Entry>& entries, int tree_index) const {
  const auto size = static_cast<int>(entries.size());
  int best = -1, best_smaller_side = static_cast<int>(kMinSplitShare * size);
  for (int bit = tree_index; bit < kDescriptorBits; bit += config_.trees) {
    const auto ones = static_cast<int>(
        std::count_if(entries.begin(), entries.end(), [bit](const Entry& e) { return bitOf(e.bits, bit); }));
    const int smaller_side = std::min(ones, size - ones);
    if (smaller_side > best_smaller_side) {
      best_smaller_side = smaller_side;
      best = bit;
    }
  }
  return best;
}

/// Drops the entries of removed keyframes and numbers the others anew.
void PlaceIndex::sweep() {
  std::vector<std::uint32_t> new_slot(slots_.size(), 0);
  std::vector<KeyframeId> kept;
  for (std::size_t slot = 0; slot < slots_.size(); ++slot) {
    if (!slots_[slot].valid()) continue;
    new_slot[slot] = static_cast<std::uint32_t>(kept.size());
    kept.push_back(slots_[slot]);
  }
  for (Tree& tree : trees_) {
    for (Node& node : tree.nodes) {
      auto& entries = node.entries;
      entries.erase(std::remove_if(entries.begin(), entries.end(), [this](const Entry& e) { return !live(e); }),
                    entries.end());
      entries.shrink_to_fit();
      for (Entry& entry : entries) entry.slot = new_slot[entry.slot];
    }
  }
  slots_ = std::move(kept);
  for (std::size_t slot = 0; slot < slots_.size(); ++slot) slot_of_[slots_[slot]] = static_cast<std::uint32_t>(slot);
}

}  // namespace semantic_vslam
