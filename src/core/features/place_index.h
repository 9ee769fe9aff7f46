// SPDX-FileCopyrightText: 2026 The semantic_vslam authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <array>
#include <cstdint>
#include <unordered_map>
#include <vector>

#include "core/features/frame_features.h"
#include "semantic_vslam/core/common/ids.h"
#include "semantic_vslam/core/features/features_config.h"

namespace semantic_vslam {

/// A keyframe that looks like the query.
struct PlaceMatch {
  KeyframeId keyframe;
  int votes = 0;       ///< features of the query that match one of the keyframe
  double score = 0.0;  ///< votes / features of the query
};

/// Finds keyframes by appearance alone. No vocabulary: keyframes' ORB descriptors hang in binary trees that split on
/// single bits and grow with the map (Schlegel and Grisetti, "HBST: A Hamming Distance embedding Binary Search Tree for
/// Feature-based Visual Place Recognition", RA-L 2018), so nothing is trained, loaded or tuned to a kind of scene. Each
/// query descriptor goes down to one leaf a tree and votes for every keyframe that has a close descriptor there.
///
/// Chosen by measured precision and recall on revisits: doc/place_recognition.md.
class PlaceIndex {
 public:
  /// @throws ConfigError
  explicit PlaceIndex(const PlaceIndexConfig& config = {});

  /// Enters a keyframe; one that is already there is entered anew. Features that may move (weight below 0.5) are left
  /// out.
  void add(KeyframeId id, const FrameFeatures& features);
  void remove(KeyframeId id);
  void clear();
  std::size_t size() const { return slot_of_.size(); }

  /// @return at most max_results keyframes, most votes first (older first among equals), each with at least one vote.
  std::vector<PlaceMatch> query(const FrameFeatures& features, int max_results) const;

 private:
  using Bits = std::array<std::uint64_t, 4>;
  struct Entry {
    Bits bits;
    std::uint32_t slot = 0;
  };
  struct Node {
    int bit = -1;  ///< that decides between the children; -1 = leaf
    std::array<int, 2> child{};
    std::vector<Entry> entries;  ///< of a leaf
  };
  struct Tree {
    std::vector<Node> nodes{1};
  };

  static bool bitOf(const Bits& bits, int bit) { return ((bits[bit / 64] >> (bit % 64)) & 1U) != 0; }
  static int leafOf(const Tree& tree, const Bits& bits);
  bool live(const Entry& entry) const { return slots_[entry.slot].valid(); }
  void insert(Tree& tree, int tree_index, const Entry& entry);
  void split(Tree& tree, int tree_index, int leaf);
  int chooseBit(const std::vector<Entry>& entries, int tree_index) const;
  void sweep();

  PlaceIndexConfig config_;
  std::vector<Tree> trees_;
  std::vector<KeyframeId> slots_;  ///< invalid: removed, its entries wait to be swept
  std::unordered_map<KeyframeId, std::uint32_t> slot_of_;
};

}  // namespace semantic_vslam
