// SPDX-FileCopyrightText: 2026 The semantic_vslam authors
// SPDX-License-Identifier: BSD-3-Clause
#include "core/pipeline/loop_closer.h"

#include <optional>
#include <string>

#include "core/loop/loop_corrector.h"
#include "core/loop/map_joiner.h"
#include "core/mapping/ba_selection.h"
#include "core/optimization/bundle_adjustment.h"
#include "semantic_vslam/core/common/log.h"

namespace semantic_vslam {
namespace {

ClosedLoop recordOf(const Map& map, const LoopClosure& closure) {
  return {map.keyframe(closure.current)->stamp, map.keyframe(closure.matched)->stamp, closure.T_current_matched};
}

}  // namespace

LoopCloser::LoopCloser(const SparseSlamConfig& config, SharedMap& map)
    : config_(config), shared_(map), detector_(config.loop_detection, config.tracking.frame) {}

bool LoopCloser::closeAt(KeyframeId keyframe) {
  std::optional<LoopClosure> closure;
  {
    std::lock_guard<std::mutex> lock(shared_.mutex);
    if (!shared_.map.keyframe(keyframe)) return false;
    closure = detector_.detect(shared_.map, shared_.places, keyframe);
    if (!closure) return false;
    detector_.reset();
    shared_.changeLocked([&] { return joinTrees(shared_.map, *closure); });
  }
  // The map that a correction was computed for may have changed meanwhile: by a bundle of the whole map, or a map
  // joined by tracking. Both are rare, so that the second or third attempt meets none.
  constexpr int kAttempts = 3;
  for (int attempt = 1; attempt <= kAttempts; ++attempt) {
    if (correct(*closure)) {
      logInfo("loop closed: this place was seen before");
      return true;
    }
    logWarning("the map changed while a loop in it was corrected, attempt " + std::to_string(attempt) + " of " +
               std::to_string(kAttempts));
  }
  return false;
}

bool LoopCloser::correct(const LoopClosure& closure) {
  PoseGraphProblem graph;
  {
    std::lock_guard<std::mutex> lock(shared_.mutex);
    if (!shared_.map.keyframe(closure.current) || !shared_.map.keyframe(closure.matched)) return false;
    graph = selectLoop(shared_.map, closure, config_.loop_correction);
  }
  const MapSolution solution = solve(graph, config_.loop_correction.graph, nullptr);
  std::lock_guard<std::mutex> lock(shared_.mutex);
  const bool applied = shared_.changeLocked([&] {
    return applyLoop(shared_.map, closure, solution, graph.map_version,
                     config_.tracking.frame.sensor.virtual_baseline_m, config_.loop_correction);
  });
  if (applied) closed_.push_back(recordOf(shared_.map, closure));
  return applied;
}

void LoopCloser::adjustAll(const std::atomic<bool>& abort) {
  BaProblem problem;
  {
    std::lock_guard<std::mutex> lock(shared_.mutex);
    problem = selectGlobal(shared_.map, config_.tracking.frame.sensor);
  }
  MapSolution solution = solve(problem, config_.local_ba, &abort);
  if (abort) return;  // the loop that aborted it starts another one
  std::lock_guard<std::mutex> lock(shared_.mutex);
  carryAlong(shared_.map, solution);
  // The new version refuses a local adjustment of the map as it was before.
  if (shared_.changeLocked([&] { return shared_.map.apply(solution, problem.map_version); })) shared_.map.bumpVersion();
}

std::vector<ClosedLoop> LoopCloser::closedLoops() const {
  std::lock_guard<std::mutex> lock(shared_.mutex);
  return closed_;
}

std::size_t LoopCloser::count() const {
  std::lock_guard<std::mutex> lock(shared_.mutex);
  return closed_.size();
}

void LoopCloser::resetLocked() {
  detector_.reset();
  closed_.clear();
}

}  // namespace semantic_vslam
