// SPDX-FileCopyrightText: 2026 The semantic_vslam authors
// SPDX-License-Identifier: BSD-3-Clause
#include "core/motion/room_memory.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace semantic_vslam {
namespace {

constexpr float kNan = std::numeric_limits<float>::quiet_NaN();
// Frames wait this long for tracking's word on them: keyframe poses come after local adjustment, at worst.
constexpr double kWaitS = 2.0;
// Error of a tracked frame's pose against the keyframes, metres; the rest of the margin is min_depth_margin_m.
constexpr double kPoseErrorM = 0.02;
// References compared with each frame, besides the one that told most of the frame before.
constexpr std::size_t kLooks = 1;
// Each frame compares every third row, in turn: evidence is shared over six cells along surfaces, and gathers.
constexpr int kRowStep = 3;
// A reference is of use if it saw this many of the frame's sample points.
constexpr int kSamples = 4, kLeastSeen = 4;  // kSamples x kSamples of them
// A reference repeats another if it differs by less than about one of these.
constexpr double kNearM = 0.3, kNearRad = 0.35, kNearS = 60.0;
// Share of motion.room.settle_s after which it is looked again for what has settled.
constexpr double kSettleShare = 0.1;

// A surface is known once a keyframe of this long ago saw it too: people sway, and lean, by more than the margin within
// seconds; desks, walls and what is wrongly taken for people do not.
constexpr double kKnownS = 3.0;

// People who sit and stand about fill less of a view; whole groups of them move. More is a network that errs.
constexpr double kMostStillPeople = 0.25;

enum CellState : uchar { kMoving = 1, kPerson = 2 };

cv::Mat1b cellStates(const cv::Mat1b& moving, const cv::Mat1f& semantic) {
  cv::Mat1b state(moving.size());
  for (int y = 0; y < state.rows; ++y) {
    const uchar* moves = moving[y];
    const float* person = semantic.empty() ? nullptr : semantic[y];
    uchar* out = state[y];
    for (int x = 0; x < state.cols; ++x) {
      const bool labelled = person != nullptr && person[x] > 0.5F;  // false for NaN
      out[x] = static_cast<uchar>((labelled ? kPerson : 0) | (moves[x] >= 128 ? kMoving : 0));
    }
  }
  return state;
}

/// How clearly a surface lies in space that the reference saw free, 0 .. 1.
float entered(const PlaceLookup::Sighting& seen, const cv::Mat1f& depth_low_m) {
  if (seen.hole || seen.measured_m <= 0.0F) return 0.0F;
  const float gap_m = depth_low_m(seen.cell) - seen.depth_m;
  return std::min(1.0F, std::max(0.0F, (gap_m - seen.margin_m) / seen.margin_m));
}

double poseDistance(const PlacedFrame& a, const PlacedFrame& b) {
  const SE3 T = a.T_odometry_camera.inverse() * b.T_odometry_camera;
  const double angle_rad = Eigen::AngleAxisd(T.linear()).angle();
  return T.translation().norm() / kNearM + angle_rad / kNearRad + std::abs(secondsBetween(a.stamp, b.stamp)) / kNearS;
}

}  // namespace

void RoomMemory::clear() {
  breakOdometry();
  forgetRoom();
}

void RoomMemory::forgetRoom() {
  references_.clear();
  settling_.reset();
  last_settled_ = Stamp();
  T_world_odometry_.reset();
}

void RoomMemory::breakOdometry() {
  recent_.clear();
  T_world_odometry_.reset();
}

void RoomMemory::addFrame(const PlacedFrame& place, const cv::Mat1f& depth_low_m, const cv::Mat1b& moving,
                          const cv::Mat1f& semantic) {
  if (config_.max_references == 0) return;
  recent_.push_back({place, depth_low_m, cellStates(moving, semantic)});
  while (secondsBetween(recent_.front().place.stamp, place.stamp) > kWaitS) recent_.pop_front();
}

const RoomMemory::View* RoomMemory::recent(Stamp stamp) const {
  const auto at = std::lower_bound(recent_.begin(), recent_.end(), stamp,
                                   [](const View& view, Stamp wanted) { return view.place.stamp < wanted; });
  return at != recent_.end() && at->place.stamp == stamp ? &*at : nullptr;
}

void RoomMemory::takeFramePose(const TimedPose& pose) {
  const View* view = recent(pose.stamp);
  if (view == nullptr || (T_world_odometry_ && pose.stamp < posed_)) return;
  T_world_odometry_ = pose.T_world_camera * view->place.T_odometry_camera.inverse();
  posed_ = pose.stamp;
}

void RoomMemory::takeKeyframePoses(const std::vector<TimedPose>& poses) {
  if (config_.max_references == 0) return;
  std::vector<std::optional<SE3>> corrections(references_.size());  // T_after_before, in the world
  bool any = references_.empty();
  for (const TimedPose& pose : poses) {
    const auto at = std::lower_bound(references_.begin(), references_.end(), pose.stamp,
                                     [](const View& view, Stamp stamp) { return view.place.stamp < stamp; });
    if (at == references_.end() || at->place.stamp != pose.stamp) continue;
    corrections[static_cast<std::size_t>(at - references_.begin())] =
        pose.T_world_camera * at->place.T_odometry_camera.inverse();
    at->place.T_odometry_camera = pose.T_world_camera;
    any = true;
  }
  if (!any) forgetRoom();
  for (std::size_t i = 0; i < references_.size(); ++i) {
    if (corrections[i]) continue;
    // Its keyframe was culled: it goes with its neighbour in time.
    for (std::size_t away = 1; away < references_.size(); ++away) {
      const bool before = i >= away && corrections[i - away].has_value();
      const bool after = !before && i + away < references_.size() && corrections[i + away].has_value();
      if (!before && !after) continue;
      SE3& T = references_[i].place.T_odometry_camera;
      T = *corrections[before ? i - away : i + away] * T;
      T.linear() = Eigen::Quaterniond(T.linear()).normalized().toRotationMatrix();  // it may follow for hours
      break;
    }
  }
  for (const TimedPose& pose : poses) {
    if (!references_.empty() && pose.stamp <= references_.back().place.stamp) continue;
    if (const View* view = recent(pose.stamp)) addReference(*view, pose.T_world_camera);
    takeFramePose(pose);
  }
}

void RoomMemory::addReference(const View& view, const SE3& T_world_camera) {
  View reference = view;
  reference.place.depth_m = view.place.depth_m.clone();  // space that is taken later is forgotten
  reference.place.surface_m = reference.place.depth_m;
  reference.depth_low_m = view.depth_low_m.clone();
  reference.place.T_odometry_camera = T_world_camera;
  const int still_people = cv::countNonZero(view.state == static_cast<uchar>(kPerson));
  reference.believed = still_people <= kMostStillPeople * static_cast<double>(view.state.total());
  references_.push_back(std::move(reference));
  if (references_.size() > static_cast<std::size_t>(config_.max_references)) dropOne();
  startSettling();
}

void RoomMemory::dropOne() {
  // Of the two that are most alike the newer goes: the older knows more of what came since. The newest one stays.
  std::size_t drop = references_.size() / 2;
  double least = std::numeric_limits<double>::max();
  for (std::size_t i = 1; i + 1 < references_.size(); ++i) {
    for (std::size_t j = 0; j < i; ++j) {
      const double distance = poseDistance(references_[i].place, references_[j].place);
      if (distance >= least) continue;
      least = distance;
      drop = i;
    }
  }
  references_.erase(references_.begin() + static_cast<std::ptrdiff_t>(drop));
  settling_.reset();
}

std::vector<std::size_t> RoomMemory::overlapping(const PlacedFrame& now_in_map, const WorkGrid& grid) const {
  std::vector<Eigen::Vector3f> samples;
  for (int row = 0; row < kSamples; ++row) {
    for (int column = 0; column < kSamples; ++column) {
      const cv::Point cell((2 * column + 1) * grid.size().width / (2 * kSamples),
                           (2 * row + 1) * grid.size().height / (2 * kSamples));
      const float z = now_in_map.surface_m(cell);
      if (z <= 0.0F) continue;
      const cv::Vec2f ray = grid.rays()(cell);
      samples.emplace_back(ray[0] * z, ray[1] * z, z);
    }
  }
  std::vector<std::size_t> found;
  for (std::size_t i = 0; i < references_.size(); ++i) {
    const CellTransform T(references_[i].place.T_odometry_camera.inverse() * now_in_map.T_odometry_camera);
    int inside = 0;
    for (const Eigen::Vector3f& sample : samples) {
      const Eigen::Vector3f p = T.R * sample + T.t;
      if (p.z() > 0.1F && grid.contains(grid.project(p.x(), p.y(), p.z()))) ++inside;
    }
    if (inside >= kLeastSeen) found.push_back(i);
  }
  return found;
}

std::optional<RoomVote> RoomMemory::look(const PlacedFrame& now, const WorkGrid& grid, const RigidFlowConfig& rigid) {
  settle(grid, rigid);
  if (!T_world_odometry_ || references_.empty()) return std::nullopt;
  PlacedFrame here = now;
  here.T_odometry_camera = *T_world_odometry_ * now.T_odometry_camera;
  const std::vector<std::size_t> useful = overlapping(here, grid);
  if (useful.empty()) return std::nullopt;

  std::vector<std::size_t> chosen{*std::max_element(useful.begin(), useful.end(), [this](std::size_t a, std::size_t b) {
    return references_[a].entered < references_[b].entered;
  })};
  for (std::size_t i = 0; i < std::min(kLooks, useful.size()); ++i) {
    turn_ = (turn_ + 1) % useful.size();
    if (useful[turn_] != chosen.front()) chosen.push_back(useful[turn_]);
  }
  // Each reference has one voice: where they differ, one of them stands askew, or knows what has settled since.
  cv::Mat1f balance(grid.size(), 0.0F), known(grid.size(), 0.0F);
  first_row_ = (first_row_ + 1) % kRowStep;
  for (const std::size_t index : chosen) {
    View& reference = references_[index];
    PlaceLookup lookup(here, reference.place, grid, rigid, kPoseErrorM);
    const int unknown = reference.believed ? kMoving | kPerson : kMoving;
    const bool long_ago = secondsBetween(reference.place.stamp, now.stamp) >= kKnownS;
    std::size_t count = 0;
    for (int y = first_row_; y < grid.size().height; y += kRowStep) {
      float *sum = balance[y], *knows = known[y];
      lookup.row(y, [&](int x, const PlaceLookup::Sighting& seen) {
        if (seen.same()) {
          const uchar state = reference.state(seen.cell);
          if (state == 0) sum[x] -= 1.0F;
          if (long_ago && (state & unknown) == 0) knows[x] += 1.0F;
          return;
        }
        const float evidence = entered(seen, reference.depth_low_m);
        if (evidence <= 0.0F) return;
        ++count;
        sum[x] += evidence;
        knows[x] -= 1.0F;
      });
    }
    reference.entered = count;
  }
  RoomVote vote{{cv::max(balance, 0.0F), cv::max(-balance, 0.0F)}, known};
  vote.entered = cv::min(vote.entered, 1.0F);
  vote.stayed = cv::min(vote.stayed, 1.0F);
  return vote;
}

void RoomMemory::startSettling() {
  const View& newest = references_.back();
  const bool old_enough = secondsBetween(references_.front().place.stamp, newest.place.stamp) >= config_.settle_s;
  const bool due = secondsBetween(last_settled_, newest.place.stamp) >= kSettleShare * config_.settle_s;
  if (settling_ || !old_enough || !due || references_.size() < 2) return;
  last_settled_ = newest.place.stamp;
  settling_ = Settling{references_.size() - 1, references_.size() - 2, cv::Mat1f(newest.state.size(), kNan),
                       cv::Mat1b(newest.state.size(), static_cast<uchar>(1)), false};
  settling_->since_s.setTo(0.0F, newest.state == static_cast<uchar>(kMoving));
}

void RoomMemory::settle(const WorkGrid& grid, const RigidFlowConfig& rigid) {
  if (!settling_) return;
  Settling& job = *settling_;
  View &subject = references_[job.subject], &older = references_[job.next];
  const auto age_s = static_cast<float>(secondsBetween(older.place.stamp, subject.place.stamp));
  PlaceLookup lookup(subject.place, older.place, grid, rigid, kPoseErrorM);
  for (int y = 0; y < grid.size().height; ++y) {
    float* since = job.since_s[y];
    uchar* open = job.open[y];
    lookup.row(y, [&](int x, const PlaceLookup::Sighting& seen) {
      if (std::isnan(since[x])) return;
      const bool free = entered(seen, older.depth_low_m) > 0.0F;
      if (job.forgetting) {
        if (!free) return;
        const cv::Rect about = cv::Rect(seen.cell.x - 1, seen.cell.y - 1, 3, 3) & cv::Rect({0, 0}, grid.size());
        older.place.depth_m(about).setTo(0.0F);
        return;
      }
      if (free || (seen.same() && (older.state(seen.cell) & kPerson) != 0)) open[x] = 0;
      if (open[x] != 0 && seen.same()) since[x] = age_s;
    });
  }
  if (job.next > 0) {
    --job.next;
  } else if (job.forgetting) {
    settling_.reset();
  } else {
    finishSearch();
  }
}

void RoomMemory::finishSearch() {
  Settling& job = *settling_;
  const auto wanted_s = static_cast<float>(config_.settle_s);
  bool any = false;
  changeCells(job.since_s, [&](float since_s) {
    any = any || since_s >= wanted_s;
    return since_s >= wanted_s ? since_s : kNan;
  });
  if (!any) {
    settling_.reset();
    return;
  }
  references_[job.subject].state.setTo(static_cast<uchar>(0), job.since_s >= wanted_s);
  job.next = job.subject - 1;
  job.forgetting = true;
}

std::size_t RoomMemory::bytes() const {
  std::size_t sum = 0;
  const auto of = [](const View& view) {
    return 4 * (view.place.depth_m.total() + view.depth_low_m.total()) + view.state.total();
  };
  for (const View& view : recent_) sum += of(view);
  for (const View& view : references_) sum += of(view);
  return sum;
}

}  // namespace semantic_vslam
