// SPDX-FileCopyrightText: 2026 The semantic_vslam authors
// SPDX-License-Identifier: BSD-3-Clause
#include "eval/fault_injection.h"

#include <algorithm>
#include <cmath>
#include <numeric>

#include "core/common/rng.h"
#include "core/geometry/rigid_alignment.h"
#include "eval/trajectory_error.h"
#include "semantic_vslam/core/common/error.h"

namespace semantic_vslam {
namespace {

constexpr double kSettledS = 1.0;

/// The same moment with the lens covered.
RgbdFrame blackened(RgbdFrame frame) {
  frame.bgr = cv::Mat3b(frame.bgr.size(), cv::Vec3b(0, 0, 0));
  frame.gray = cv::Mat1b(frame.gray.size(), std::uint8_t{0});
  frame.depth_m = cv::Mat1f(frame.depth_m.size(), 0.0F);
  return frame;
}

/// A pose that the system stands by, beside the true position.
struct Judged {
  std::uint64_t frame = 0;
  Stamp stamp;
  Eigen::Vector3d told_m, true_m;
};

std::vector<Judged> judgedFrames(const std::vector<ToldPose>& told, const std::vector<TimedPose>& truth) {
  std::vector<Judged> judged;
  std::vector<Stamp> told_stamps, true_stamps;
  for (const ToldPose& pose : told) told_stamps.push_back(pose.stamp);
  for (const TimedPose& pose : truth) true_stamps.push_back(pose.stamp);
  for (const auto& [i, j] : associateStamps(told_stamps, true_stamps, kAssociationGapS)) {
    if (told[i].state != TrackingState::kOk) continue;
    judged.push_back(
        {told[i].frame, told[i].stamp, told[i].T_world_camera.translation(), truth[j].T_world_camera.translation()});
  }
  return judged;
}

/// Stamp of the first frame told after each cut; cuts that nothing follows have none.
std::vector<std::optional<Stamp>> endsOf(const std::vector<Cut>& cuts, const std::vector<ToldPose>& told) {
  std::vector<std::optional<Stamp>> ends;
  for (const Cut& cut : cuts) {
    const auto after = std::find_if(told.begin(), told.end(), [&](const auto& pose) { return pose.frame >= cut.end; });
    ends.push_back(after == told.end() ? std::nullopt : std::optional(after->stamp));
  }
  return ends;
}

PointAlignment alignSettled(const std::vector<Judged>& judged, const std::vector<std::optional<Stamp>>& ends) {
  std::vector<Eigen::Vector3d> told_m, true_m;
  for (const Judged& frame : judged) {
    const bool unsettled = std::any_of(ends.begin(), ends.end(), [&](const std::optional<Stamp>& end) {
      return end && *end <= frame.stamp && secondsBetween(*end, frame.stamp) < kSettledS;
    });
    if (unsettled) continue;
    told_m.push_back(frame.told_m);
    true_m.push_back(frame.true_m);
  }
  if (told_m.size() < 3) throw Error("too few frames with pose and ground truth to judge what became of the cuts");
  return alignPoints(told_m, true_m);
}

}  // namespace

const char* cutName(Cut::Kind kind) { return kind == Cut::Kind::kBlack ? "black" : "skipped"; }

std::vector<Cut> drawCuts(std::size_t frames, double fps, const CutPlan& plan, std::uint64_t seed) {
  Rng rng(seed);
  std::vector<double> lengths_s;
  for (int i = 0; i < plan.cuts; ++i) lengths_s.push_back(rng.uniform(plan.least_s, plan.most_s));
  const double used_s =
      plan.lead_s + plan.cuts * plan.least_between_s + std::accumulate(lengths_s.begin(), lengths_s.end(), 0.0);
  const double spare_s = static_cast<double>(frames) / fps - used_s;
  if (spare_s < 0.0) {
    throw Error(std::to_string(frames) + " frames are too few for " + std::to_string(plan.cuts) + " cuts");
  }
  // The spare time falls between the cuts at random: sorted positions in it, each moved by what lies before.
  std::vector<double> positions_s;
  for (int i = 0; i < plan.cuts; ++i) positions_s.push_back(rng.uniform(0.0, spare_s));
  std::sort(positions_s.begin(), positions_s.end());
  std::vector<Cut> cuts;
  double before_s = plan.lead_s;
  for (int i = 0; i < plan.cuts; ++i) {
    const double begin_s = before_s + positions_s[i];
    cuts.push_back({static_cast<std::uint64_t>(std::lround(begin_s * fps)),
                    static_cast<std::uint64_t>(std::lround((begin_s + lengths_s[i]) * fps)),
                    rng.below(2) == 0 ? Cut::Kind::kBlack : Cut::Kind::kSkipped});
    before_s += lengths_s[i] + plan.least_between_s;
  }
  return cuts;
}

std::optional<RgbdFrame> CutSource::next() {
  while (auto frame = recording_.next()) {
    const auto cut = std::find_if(cuts_.begin(), cuts_.end(), [&](const Cut& candidate) {
      return candidate.begin <= frame->index && frame->index < candidate.end;
    });
    black_ = cut != cuts_.end() && cut->kind == Cut::Kind::kBlack;
    if (cut == cuts_.end()) return frame;
    if (black_) return blackened(std::move(*frame));
    recording_.skip(cut->end - frame->index - 1);
  }
  return std::nullopt;
}

std::vector<Recovery> scoreRecovery(const std::vector<Cut>& cuts, const std::vector<ToldPose>& told,
                                    const std::vector<TimedPose>& truth) {
  const std::vector<Judged> judged = judgedFrames(told, truth);
  const PointAlignment alignment = alignSettled(judged, endsOf(cuts, told));
  std::vector<Recovery> recoveries;
  for (std::size_t c = 0; c < cuts.size(); ++c) {
    const std::uint64_t until = c + 1 < cuts.size() ? cuts[c + 1].begin : std::uint64_t(-1);
    Recovery recovery{cuts[c]};
    int seen = 0;
    for (const ToldPose& pose : told) {
      if (pose.frame < cuts[c].end || pose.frame >= until || recovery.frames_needed > 0) continue;
      ++seen;
      if (pose.state == TrackingState::kOk) recovery.frames_needed = seen;
    }
    for (const Judged& frame : judged) {
      if (frame.frame < cuts[c].begin || frame.frame >= until) continue;
      recovery.worst_error_m = std::max(recovery.worst_error_m, (alignment.apply(frame.told_m) - frame.true_m).norm());
    }
    recoveries.push_back(recovery);
  }
  return recoveries;
}

}  // namespace semantic_vslam
