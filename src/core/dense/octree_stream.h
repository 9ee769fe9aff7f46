// SPDX-FileCopyrightText: 2026 The semantic_vslam authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <array>
#include <cstdint>
#include <functional>
#include <string>
#include <utility>
#include <vector>

#include "core/dense/voxel_map.h"

/// The voxel map in the streams of OctoMap, made of parts that are kept for each block until it changes.
namespace semantic_vslam {

/// A node of a ColorOcTree, as its library makes it up from its children: highest log-odds, mean colour of those that
/// have one; eight leaves of the same log-odds are one leaf.
struct OctreeNode {
  enum class Kind : std::uint8_t { kNone, kLeaf, kInner };
  using Rgb = std::array<std::uint8_t, 3>;
  static constexpr Rgb kNoColour = {255, 255, 255};

  float log_odds = 0.0F;
  Kind kind = Kind::kNone;
  Rgb rgb = kNoColour;
  Rgb mean = kNoColour;  ///< before the leaves below were joined: this is what its parent's colour is made of
};

/// A block of voxels is a subtree of three levels, whose data are kept; the levels above are made up each time. Knows
/// no thread.
class OctreeStream {
 public:
  OctreeStream() = default;
  explicit OctreeStream(const VoxelMap& map) { update(map); }
  /// Takes in what has changed since the last call; always of the same map.
  void update(const VoxelMap& map);

  /// The data of a ColorOcTree with log-odds and colours (OctoMap's writeData); empty for an empty map.
  std::string full() const { return data(false); }
  /// Two bits a node, free and occupied only (OctoMap's writeBinaryData); empty for an empty map.
  std::string binary() const { return data(true); }

  /// A node without children: a cube of one state.
  struct Leaf {
    Eigen::Vector3i corner;  ///< index of its lowest voxel
    int side = 1;            ///< in voxels: a power of two
    float log_odds = 0.0F;
    OctreeNode::Rgb rgb{};

    bool occupied() const { return log_odds >= 0.0F; }
    Eigen::Vector3d centre() const { return corner.cast<double>().array() + side / 2.0; }  ///< in voxels
  };
  /// Calls back for every leaf of the full tree, in the order of the stream.
  void forEachLeaf(const std::function<void(const Leaf&)>& visit) const;

  double resolution() const { return resolution_m_; }  ///< metres
  std::size_t memoryBytes() const { return bytes_; }

 private:
  /// A block's subtree.
  struct Part {
    OctreeNode full, binary;  ///< its root in both trees
    std::string full_data;    ///< of the root and all below it
    std::string binary_data;  ///< of the root's children and all below; empty where the root is a leaf
    std::size_t bytes() const { return sizeof(Part) + full_data.capacity() + binary_data.capacity(); }
  };
  /// A node at or above the blocks.
  struct Upper {
    std::uint64_t morton = 0;  ///< of its place among the nodes of its level
    std::size_t first = 0;     ///< of its children in the level below; of a block its place in the map
    std::size_t end = 0;       ///< of its children
    OctreeNode node;
  };
  using Levels = std::vector<std::vector<Upper>>;  ///< from the blocks up to the root

  static Part encode(const VoxelMap& map, VoxelKey block);
  Levels levels(bool binary) const;
  std::string data(bool binary) const;
  void appendFull(const Levels& levels, std::size_t level, const Upper& node, std::string& out) const;
  void appendBinary(const Levels& levels, std::size_t level, const Upper& node, std::string& out) const;

  double resolution_m_ = 0.0;
  std::uint32_t revision_ = 0;
  std::vector<VoxelBlock> blocks_;                             ///< as they were at the last update
  std::vector<Part> parts_;                                    ///< of blocks_
  std::vector<std::pair<std::uint64_t, std::size_t>> sorted_;  ///< Morton code and place of each
  std::size_t bytes_ = 0;
};

}  // namespace semantic_vslam
