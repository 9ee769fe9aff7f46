// SPDX-FileCopyrightText: 2026 The semantic_vslam authors
// SPDX-License-Identifier: BSD-3-Clause
#include "core/dense/surface_mesh.h"

#include <map>
#include <optional>

#include "core/common/atomic_file.h"
#include "core/dense/cloud_file.h"
#include "core/dense/voxel_key.h"

namespace semantic_vslam {
namespace {

Eigen::Vector3i cornerOf(int i) { return {i & 1, i >> 1 & 1, i >> 2}; }

/// The surface's vertex in the cube whose lowest corner is the centre of voxel `index`.
/// @return nothing where a corner knows no distance, or the surface does not pass
std::optional<Eigen::Vector3d> vertexIn(const VoxelMap& map, const Eigen::Vector3i& index) {
  std::array<float, 8> distance_m{};
  for (int i = 0; i < 8; ++i) {
    const std::optional<float> known = map.distance(index + cornerOf(i));
    if (!known) return std::nullopt;
    distance_m[i] = *known;
  }
  Eigen::Vector3d sum = Eigen::Vector3d::Zero();
  int crossings = 0;
  for (int i = 0; i < 8; ++i) {
    for (int axis = 0; axis < 3; ++axis) {
      const int j = i | 1 << axis;
      if (j == i || (distance_m[i] < 0.0F) == (distance_m[j] < 0.0F)) continue;
      const double share = static_cast<double>(distance_m[i] / (distance_m[i] - distance_m[j]));
      sum += cornerOf(i).cast<double>() + share * Eigen::Vector3d::Unit(axis);
      ++crossings;
    }
  }
  if (crossings == 0) return std::nullopt;
  return map.centre(index) + sum / crossings * map.resolution();
}

}  // namespace

SurfaceMesh makeSurfaceMesh(const VoxelMap& map) {
  SurfaceMesh mesh;
  std::map<VoxelKey, std::uint32_t> vertex_of;  // by cube; in a fixed order
  map.forEachKnown([&](const Voxel& voxel) {
    if (voxel.state != Occupancy::kOccupied) return;
    for (int i = 0; i < 8; ++i) {
      const Eigen::Vector3i cube = voxel.index - cornerOf(i);
      if (!inVoxelRange(cube) || vertex_of.count(voxelKey(cube)) > 0) continue;
      const std::optional<Eigen::Vector3d> vertex = vertexIn(map, cube);
      if (!vertex) continue;
      vertex_of[voxelKey(cube)] = static_cast<std::uint32_t>(mesh.vertices.size());
      const Eigen::Vector3f p = vertex->cast<float>();
      mesh.vertices.push_back({cv::Vec3f(p.x(), p.y(), p.z()), voxel.bgr, voxel.label});
    }
  });
  // Four cubes share each edge between two voxels' centres: where the surface crosses it, their vertices make a quad.
  for (const auto& [key, own] : vertex_of) {
    const Eigen::Vector3i cube = voxelIndex(key);
    for (int axis = 0; axis < 3; ++axis) {
      const Eigen::Vector3i along = Eigen::Vector3i::Unit(axis), b = Eigen::Vector3i::Unit((axis + 1) % 3),
                            c = Eigen::Vector3i::Unit((axis + 2) % 3);
      const float low_m = *map.distance(cube), high_m = *map.distance(cube + along);
      if ((low_m < 0.0F) == (high_m < 0.0F)) continue;
      const std::array<Eigen::Vector3i, 3> beside{cube - b, cube - b - c, cube - c};
      std::array<std::uint32_t, 3> other{};
      bool whole = true;
      for (int i = 0; i < 3 && whole; ++i) {
        const auto found = inVoxelRange(beside[i]) ? vertex_of.find(voxelKey(beside[i])) : vertex_of.end();
        whole = found != vertex_of.end();
        if (whole) other[i] = found->second;
      }
      if (!whole) continue;
      if (low_m < 0.0F) {  // free space lies above
        mesh.triangles.push_back({own, other[0], other[1]});
        mesh.triangles.push_back({own, other[1], other[2]});
      } else {
        mesh.triangles.push_back({own, other[1], other[0]});
        mesh.triangles.push_back({own, other[2], other[1]});
      }
    }
  }
  return mesh;
}

void writePly(const SurfaceMesh& mesh, const LabelSet& labels, const std::string& path) {
  std::string out = "ply\nformat binary_little_endian 1.0\n" + labelComments(labels, "comment") + "element vertex " +
                    std::to_string(mesh.vertices.size()) +
                    "\nproperty float x\nproperty float y\nproperty float z\nproperty uchar red\n"
                    "property uchar green\nproperty uchar blue\nproperty uchar label\nelement face " +
                    std::to_string(mesh.triangles.size()) + "\nproperty list uchar uint vertex_indices\nend_header\n";
  for (const LabelledPoint& vertex : mesh.vertices) {
    for (int axis = 0; axis < 3; ++axis) appendFloat(out, vertex.xyz_m[axis]);
    for (int channel = 2; channel >= 0; --channel) out.push_back(static_cast<char>(vertex.bgr[channel]));
    out.push_back(static_cast<char>(vertex.label));
  }
  for (const auto& triangle : mesh.triangles) {
    out.push_back(3);
    for (const std::uint32_t vertex : triangle) appendLittleEndian(out, vertex);
  }
  writeTextAtomically(path, out);
}

}  // namespace semantic_vslam
