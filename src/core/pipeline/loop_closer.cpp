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

LoopCloser::LoopCloser(const SparseSlamConfig& config, SparseState& state)
    : config_(config), state_(state), detector_(config.loop_detection, config.tracking.frame) {}

bool LoopCloser::closeAt(KeyframeId keyframe, const Alone& alone) {
  std::optional<LoopClosure> closure;
  alone([&] {
    if (state_.map.keyframe(keyframe)) closure = detector_.detect(state_.map, state_.places, keyframe);
    if (!closure) return;
    detector_.reset();
    state_.change([&] { return joinTrees(state_.map, *closure); });
  });
  if (!closure) return false;
  // The map that a correction was computed for may have changed meanwhile: by a bundle of the whole map, or a map
  // joined by tracking. Both are rare, so that the second or third attempt meets none.
  constexpr int kAttempts = 3;
  for (int attempt = 1; attempt <= kAttempts; ++attempt) {
    if (correct(*closure, alone)) {
      logInfo("loop closed: this place was seen before");
      return true;
    }
    logWarning("the map changed while a loop in it was corrected, attempt " + std::to_string(attempt) + " of " +
               std::to_string(kAttempts));
  }
  return false;
}

bool LoopCloser::correct(const LoopClosure& closure, const Alone& alone) {
  std::optional<PoseGraphProblem> graph;
  alone([&] {
    if (state_.map.keyframe(closure.current) && state_.map.keyframe(closure.matched)) {
      graph = selectLoop(state_.map, closure, config_.loop_correction);
    }
  });
  if (!graph) return false;
  const MapSolution solution = solve(*graph, config_.loop_correction.graph, nullptr);
  bool applied = false;
  alone([&] {
    applied = state_.change([&] {
      return applyLoop(state_.map, closure, solution, graph->map_version,
                       config_.tracking.frame.sensor.virtual_baseline_m, config_.loop_correction);
    });
    if (applied) closed_.push_back(recordOf(state_.map, closure));
  });
  return applied;
}

void LoopCloser::adjustAll(const Alone& alone, const AbortFlag& abort) {
  BaProblem problem;
  alone([&] { problem = selectGlobal(state_.map, config_.tracking.frame.sensor); });
  MapSolution solution = solve(problem, config_.bundle_adjustment, &abort);
  if (abort) return;  // the loop that aborted it starts another one
  alone([&] {
    carryAlong(state_.map, solution);
    // The new version refuses a local adjustment of the map as it was before.
    if (state_.change([&] { return state_.map.apply(solution, problem.map_version); })) state_.map.bumpVersion();
  });
}

void LoopCloser::reset() {
  detector_.reset();
  closed_.clear();
}

}  // namespace semantic_vslam
