// SPDX-FileCopyrightText: 2026 The semantic_vslam authors
// SPDX-License-Identifier: BSD-3-Clause
#include "core/optimization/pose_graph.h"

#include <ceres/ceres.h>

#include <algorithm>
#include <array>
#include <set>
#include <utility>

#include "core/optimization/abort_callback.h"
#include "core/optimization/relative_pose_cost.h"

namespace semantic_vslam {
namespace {

class CeresRelativePoseCost : public ceres::SizedCostFunction<6, 6, 6> {
 public:
  explicit CeresRelativePoseCost(const RelativePoseCost& cost) : cost_(cost) {}
  bool Evaluate(double const* const* parameters, double* residuals, double** jacobians) const override {
    cost_.evaluate(parameters[0], parameters[1], residuals, jacobians != nullptr ? jacobians[0] : nullptr,
                   jacobians != nullptr ? jacobians[1] : nullptr);
    return true;
  }

 private:
  RelativePoseCost cost_;
};

std::pair<KeyframeId, KeyframeId> ordered(KeyframeId a, KeyframeId b) {
  return a < b ? std::pair(a, b) : std::pair(b, a);
}

/// Pairs of keyframes that the map itself ties together, each once.
std::set<std::pair<KeyframeId, KeyframeId>> essentialPairs(const Map& map, int min_shared) {
  std::set<std::pair<KeyframeId, KeyframeId>> pairs;
  for (const auto& [id, keyframe] : map.keyframes()) {
    if (keyframe.parent.valid()) pairs.insert(ordered(id, keyframe.parent));
    for (const KeyframeId other : keyframe.loop_edges) pairs.insert(ordered(id, other));
    for (const auto& [other, shared] : map.covisible(id, min_shared)) {
      pairs.insert(ordered(id, other));
    }
  }
  return pairs;
}

int indexOf(const PoseGraphProblem& problem, KeyframeId id) {
  const auto it = std::lower_bound(problem.nodes.begin(), problem.nodes.end(), id,
                                   [](const PoseGraphNode& node, KeyframeId wanted) { return node.id < wanted; });
  return it != problem.nodes.end() && it->id == id ? static_cast<int>(it - problem.nodes.begin()) : -1;
}

}  // namespace

PoseGraphProblem selectEssentialGraph(const Map& map, const std::vector<RelativePose>& loops,
                                      const PoseGraphConfig& config) {
  PoseGraphProblem problem;
  problem.map_version = map.version();
  for (const auto& [id, keyframe] : map.keyframes()) {
    problem.nodes.push_back({id, keyframe.T_camera_world, problem.nodes.empty()});
  }
  auto pairs = essentialPairs(map, config.min_shared);
  // What the map says about a pair that a new loop ties is what the loop corrects.
  for (const auto& loop : loops) pairs.erase(ordered(loop.a, loop.b));
  for (const auto& [a, b] : pairs) {
    if (map.keyframe(a) == nullptr || map.keyframe(b) == nullptr) continue;
    problem.edges.push_back({a, b, map.keyframe(a)->T_camera_world * map.keyframe(b)->T_camera_world.inverse()});
  }
  problem.edges.insert(problem.edges.end(), loops.begin(), loops.end());
  return problem;
}

MapSolution solve(const PoseGraphProblem& problem, const PoseGraphConfig& config, const AbortFlag* abort) {
  std::vector<std::array<double, 6>> increments(problem.nodes.size(), std::array<double, 6>{});
  ceres::Problem ceres_problem;
  for (const auto& edge : problem.edges) {
    const int a = indexOf(problem, edge.a), b = indexOf(problem, edge.b);
    if (a < 0 || b < 0) continue;
    const RelativePoseCost cost{problem.nodes[a].T_camera_world, problem.nodes[b].T_camera_world, edge.T_a_b,
                                config.translation_sigma_m, config.rotation_sigma_rad};
    ceres_problem.AddResidualBlock(new CeresRelativePoseCost(cost), nullptr, increments[a].data(),
                                   increments[b].data());
    for (const int node : {a, b}) {
      if (problem.nodes[node].fixed) ceres_problem.SetParameterBlockConstant(increments[node].data());
    }
  }

  AbortCallback abort_callback(abort);
  ceres::Solver::Options options;
  options.max_num_iterations = config.iterations;
  options.num_threads = 1;
  options.linear_solver_type = ceres::SPARSE_NORMAL_CHOLESKY;
  options.logging_type = ceres::SILENT;
  options.callbacks.push_back(&abort_callback);
  ceres::Solver::Summary summary;
  ceres::Solve(options, &ceres_problem, &summary);

  MapSolution solution;
  for (std::size_t i = 0; i < problem.nodes.size(); ++i) {
    const auto& node = problem.nodes[i];
    if (!node.fixed) solution.T_camera_world[node.id] = PoseIncrement(increments[i].data()).apply(node.T_camera_world);
  }
  return solution;
}

void carryAlong(const Map& map, MapSolution& solution) {
  auto& poses = solution.T_camera_world;
  for (const auto& [id, keyframe] : map.keyframes()) {  // ascending, so a parent comes before its children
    const auto parent = poses.find(keyframe.parent);
    if (poses.count(id) > 0 || parent == poses.end()) continue;
    const SE3 T_camera_parent = keyframe.T_camera_world * map.keyframe(keyframe.parent)->T_camera_world.inverse();
    poses[id] = T_camera_parent * parent->second;
  }
  for (const auto& [id, landmark] : map.landmarks()) {
    const auto reference = poses.find(landmark.reference_keyframe);
    if (solution.position_world.count(id) > 0 || reference == poses.end()) continue;
    const SE3& T_reference_world = map.keyframe(landmark.reference_keyframe)->T_camera_world;
    solution.position_world[id] = reference->second.inverse() * (T_reference_world * landmark.position_world);
  }
}

}  // namespace semantic_vslam
