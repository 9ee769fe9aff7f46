// SPDX-FileCopyrightText: 2026 The semantic_vslam authors
// SPDX-License-Identifier: BSD-3-Clause
#include "core/dense/octree_stream.h"

#include <algorithm>
#include <cstring>

namespace semantic_vslam {
namespace {

using Kind = OctreeNode::Kind;

constexpr int kTreeDepth = 16;                       // of every tree of OctoMap
constexpr int kRootLevel = kTreeDepth - kBlockBits;  // above the blocks
constexpr int kCentre = 1 << (kTreeDepth - 1);       // OctoMap's keys count voxels from -32768

/// x, y and z with their bits in turn: OctoMap's children in their order.
std::uint64_t mortonCode(const Eigen::Vector3i& index) {
  std::uint64_t code = 0;
  for (int bit = 0; bit < kTreeDepth; ++bit) {
    for (int axis = 0; axis < 3; ++axis) {
      code |= static_cast<std::uint64_t>(index[axis] >> bit & 1) << (3 * bit + axis);
    }
  }
  return code;
}

Eigen::Vector3i mortonIndex(std::uint64_t code) {
  Eigen::Vector3i index = Eigen::Vector3i::Zero();
  for (int bit = 0; bit < kTreeDepth; ++bit) {
    for (int axis = 0; axis < 3; ++axis) index[axis] |= static_cast<int>(code >> (3 * bit + axis) & 1) << bit;
  }
  return index;
}

/// What lies outside (983 m at 3 cm) cannot be expressed and stays out.
bool inTree(const Eigen::Vector3i& corner) { return corner.minCoeff() >= -kCentre && corner.maxCoeff() < kCentre; }

constexpr double kSurelyFree = -0.001;  // OctoMap takes log-odds of 0 for occupied

using Children = std::array<OctreeNode, 8>;

template <class ColourOf>
OctreeNode::Rgb meanColour(const OctreeNode* children, const ColourOf& colour_of) {
  std::array<int, 3> sum{};
  int count = 0;
  for (int i = 0; i < 8; ++i) {
    const OctreeNode::Rgb rgb = colour_of(children[i]);
    if (children[i].kind == Kind::kNone || rgb == OctreeNode::kNoColour) continue;
    for (int channel = 0; channel < 3; ++channel) sum[channel] += rgb[channel];
    ++count;
  }
  OctreeNode::Rgb mean = OctreeNode::kNoColour;
  for (int channel = 0; channel < 3 && count > 0; ++channel) {
    mean[channel] = static_cast<std::uint8_t>(sum[channel] / count);
  }
  return mean;
}

OctreeNode parentOf(const OctreeNode* children) {
  OctreeNode parent;
  bool same = true;
  for (int i = 0; i < 8; ++i) {
    const OctreeNode& child = children[i];
    same = same && child.kind == Kind::kLeaf && child.log_odds == children[0].log_odds;
    if (child.kind == Kind::kNone) continue;
    parent.log_odds = parent.kind == Kind::kNone ? child.log_odds : std::max(parent.log_odds, child.log_odds);
    parent.kind = Kind::kInner;
  }
  if (parent.kind == Kind::kNone) return parent;
  parent.rgb = parent.mean = meanColour(children, [](const OctreeNode& child) { return child.mean; });
  if (!same) return parent;
  parent.kind = Kind::kLeaf;
  parent.rgb = children[0].rgb;
  if (parent.rgb != OctreeNode::kNoColour) {
    parent.rgb = meanColour(children, [](const OctreeNode& child) { return child.rgb; });
  }
  return parent;
}

constexpr std::size_t kNodeBytes = sizeof(float) + sizeof(OctreeNode::Rgb) + 1;

void appendNode(const OctreeNode& node, const OctreeNode* children, std::string& out) {
  char bytes[kNodeBytes];
  std::memcpy(bytes, &node.log_odds, sizeof(float));
  std::memcpy(bytes + sizeof(float), node.rgb.data(), node.rgb.size());
  unsigned present = 0;
  for (unsigned i = 0; i < 8 && node.kind == Kind::kInner; ++i) {
    if (children[i].kind != Kind::kNone) present |= 1U << i;
  }
  bytes[kNodeBytes - 1] = static_cast<char>(present);
  out.append(bytes, kNodeBytes);
}

/// Two bits for each child: 01 free, 10 occupied, 11 has children of its own; the first child has the lowest.
void appendTwoBits(const OctreeNode* children, std::string& out) {
  unsigned bits = 0;
  for (unsigned i = 0; i < 8; ++i) {
    if (children[i].kind == Kind::kNone) continue;
    const unsigned leaf = children[i].log_odds >= 0.0F ? 2U : 1U;
    bits |= (children[i].kind == Kind::kInner ? 3U : leaf) << (2 * i);
  }
  out.push_back(static_cast<char>(bits & 255U));
  out.push_back(static_cast<char>(bits >> 8));
}

/// The nodes of a block, level by level; those of one parent lie together.
struct BlockTree {
  std::array<OctreeNode, 512> voxels;
  std::array<OctreeNode, 64> pairs;
  std::array<OctreeNode, 8> fours;
  OctreeNode root;

  void makeUp() {
    for (std::size_t i = 0; i < pairs.size(); ++i) pairs[i] = parentOf(&voxels[8 * i]);
    for (std::size_t i = 0; i < fours.size(); ++i) fours[i] = parentOf(&pairs[8 * i]);
    root = parentOf(fours.data());
  }
  /// @param level  3 for the root, 0 for voxels
  const OctreeNode* at(int level, std::size_t i) const {
    return level == 3 ? &root : level == 2 ? &fours[i] : level == 1 ? &pairs[i] : &voxels[i];
  }
  void appendFull(int level, std::size_t i, std::string& out) const {
    const OctreeNode& node = *at(level, i);
    if (node.kind == Kind::kNone) return;
    appendNode(node, level == 0 ? &node : at(level - 1, 8 * i), out);
    if (node.kind != Kind::kInner) return;
    for (std::size_t child = 8 * i; child < 8 * i + 8; ++child) appendFull(level - 1, child, out);
  }
  void appendBinary(int level, std::size_t i, std::string& out) const {
    if (at(level, i)->kind != Kind::kInner) return;
    appendTwoBits(at(level - 1, 8 * i), out);
    for (std::size_t child = 8 * i; level > 1 && child < 8 * i + 8; ++child) appendBinary(level - 1, child, out);
  }
};

/// Reads a block's leaves out of its data.
void visitLeaves(const char*& data, const Eigen::Vector3i& corner, int side,
                 const std::function<void(const OctreeStream::Leaf&)>& visit) {
  OctreeStream::Leaf leaf{corner, side, 0.0F, {}};
  std::memcpy(&leaf.log_odds, data, sizeof(float));
  std::memcpy(leaf.rgb.data(), data + sizeof(float), leaf.rgb.size());
  const auto present = static_cast<unsigned char>(data[kNodeBytes - 1]);
  data += kNodeBytes;
  if (present == 0) {
    visit(leaf);
    return;
  }
  for (int i = 0; i < 8; ++i) {
    if ((present >> i & 1) == 0) continue;
    visitLeaves(data, corner + side / 2 * Eigen::Vector3i(i & 1, i >> 1 & 1, i >> 2), side / 2, visit);
  }
}

}  // namespace

OctreeStream::Part OctreeStream::encode(const VoxelMap& map, VoxelKey block) {
  BlockTree full, binary;
  map.forEachKnownIn(block, [&](const Voxel& voxel) {
    const bool occupied = voxel.state == Occupancy::kOccupied;
    const Eigen::Vector3i in_block = voxel.index.unaryExpr([](int i) { return i & (kBlockSide - 1); });
    const std::uint64_t place = mortonCode(in_block);
    OctreeNode& node = full.voxels[place];
    node.kind = binary.voxels[place].kind = Kind::kLeaf;
    node.log_odds = static_cast<float>(occupied ? voxel.log_odds : std::min(voxel.log_odds, kSurelyFree));
    if (occupied) node.rgb = node.mean = {voxel.bgr[2], voxel.bgr[1], voxel.bgr[0]};
    binary.voxels[place].log_odds = occupied ? 1.0F : -1.0F;
  });
  full.makeUp();
  binary.makeUp();
  Part part;
  part.full = full.root;
  part.binary = binary.root;
  full.appendFull(kBlockBits, 0, part.full_data);
  binary.appendBinary(kBlockBits, 0, part.binary_data);
  part.full_data.shrink_to_fit();
  return part;
}

void OctreeStream::update(const VoxelMap& map) {
  const std::vector<VoxelBlock>& blocks = map.blocks();
  bool moved = blocks.size() != blocks_.size();
  blocks_.resize(blocks.size());
  parts_.resize(blocks.size());
  for (std::size_t i = 0; i < blocks.size(); ++i) {
    const bool same_key = blocks_[i].key == blocks[i].key;
    moved = moved || !same_key;
    if (same_key && blocks[i].changed <= revision_) continue;
    bytes_ -= blocks_[i].key == VoxelBlock::kNone ? 0 : parts_[i].bytes();
    const bool there = blocks[i].key != VoxelBlock::kNone && inTree(blockCorner(blocks[i].key));
    parts_[i] = there ? encode(map, blocks[i].key) : Part();
    blocks_[i] = blocks[i];
    bytes_ += blocks_[i].key == VoxelBlock::kNone ? 0 : parts_[i].bytes();
  }
  revision_ = map.revision();
  resolution_m_ = map.resolution();
  if (!moved) return;
  sorted_.clear();
  for (std::size_t i = 0; i < blocks_.size(); ++i) {
    if (blocks_[i].key == VoxelBlock::kNone || !inTree(blockCorner(blocks_[i].key))) continue;
    const Eigen::Vector3i from_corner = blockCorner(blocks_[i].key).array() + kCentre;
    sorted_.emplace_back(mortonCode(from_corner) >> (3 * kBlockBits), i);
  }
  std::sort(sorted_.begin(), sorted_.end());
}

OctreeStream::Levels OctreeStream::levels(bool binary) const {
  Levels levels(kRootLevel + 1);
  for (const auto& [morton, place] : sorted_) {
    const OctreeNode& node = binary ? parts_[place].binary : parts_[place].full;
    if (node.kind != Kind::kNone) levels[0].push_back({morton, place, place, node});
  }
  for (std::size_t level = 1; level < levels.size(); ++level) {
    const std::vector<Upper>& below = levels[level - 1];
    for (std::size_t first = 0, end = 0; first < below.size(); first = end) {
      Children children;
      const std::uint64_t morton = below[first].morton >> 3;
      for (; end < below.size() && below[end].morton >> 3 == morton; ++end) {
        children[below[end].morton & 7] = below[end].node;
      }
      levels[level].push_back({morton, first, end, parentOf(children.data())});
    }
  }
  return levels;
}

void OctreeStream::appendFull(const Levels& levels, std::size_t level, const Upper& node, std::string& out) const {
  if (level == 0) {
    out += parts_[node.first].full_data;
    return;
  }
  Children children;
  const std::vector<Upper>& below = levels[level - 1];
  for (std::size_t i = node.first; i < node.end; ++i) children[below[i].morton & 7] = below[i].node;
  appendNode(node.node, children.data(), out);
  if (node.node.kind != Kind::kInner) return;
  for (std::size_t i = node.first; i < node.end; ++i) appendFull(levels, level - 1, below[i], out);
}

void OctreeStream::appendBinary(const Levels& levels, std::size_t level, const Upper& node, std::string& out) const {
  if (node.node.kind != Kind::kInner) return;
  if (level == 0) {
    out += parts_[node.first].binary_data;
    return;
  }
  Children children;
  const std::vector<Upper>& below = levels[level - 1];
  for (std::size_t i = node.first; i < node.end; ++i) children[below[i].morton & 7] = below[i].node;
  appendTwoBits(children.data(), out);
  for (std::size_t i = node.first; i < node.end; ++i) appendBinary(levels, level - 1, below[i], out);
}

std::string OctreeStream::data(bool binary) const {
  const Levels tree = levels(binary);
  std::string out;
  if (tree.back().empty()) return out;
  std::size_t bytes = 0;
  for (const Part& part : parts_) bytes += (binary ? part.binary_data : part.full_data).size();
  out.reserve(bytes + bytes / 8);
  if (binary) {
    appendBinary(tree, kRootLevel, tree.back().front(), out);
  } else {
    appendFull(tree, kRootLevel, tree.back().front(), out);
  }
  return out;
}

void OctreeStream::forEachLeaf(const std::function<void(const Leaf&)>& visit) const {
  const Levels tree = levels(false);
  const std::function<void(std::size_t, const Upper&)> walk = [&](std::size_t level, const Upper& node) {
    const Eigen::Vector3i corner = mortonIndex(node.morton << (3 * (level + kBlockBits))).array() - kCentre;
    if (level == 0) {
      const char* data = parts_[node.first].full_data.data();
      visitLeaves(data, corner, kBlockSide, visit);
    } else if (node.node.kind == Kind::kLeaf) {
      visit({corner, kBlockSide << level, node.node.log_odds, node.node.rgb});
    } else {
      for (std::size_t i = node.first; i < node.end; ++i) walk(level - 1, tree[level - 1][i]);
    }
  };
  if (!tree.back().empty()) walk(kRootLevel, tree.back().front());
}

}  // namespace semantic_vslam
