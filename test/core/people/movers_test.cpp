// SPDX-FileCopyrightText: 2026 The semantic_vslam authors
// SPDX-License-Identifier: BSD-3-Clause
#include <gtest/gtest.h>

#include <algorithm>
#include <map>
#include <vector>

#include "core/people/mover_detection.h"
#include "core/people/mover_tracker.h"
#include "core/support/fixtures.h"
#include "eval/scenario_source.h"
#include "eval/synthetic_room.h"

namespace semantic_vslam {
namespace {

double median(std::vector<double> values) {
  std::nth_element(values.begin(), values.begin() + values.size() / 2, values.end());
  return values[values.size() / 2];
}

/// One stay of a person in the picture, whole and not hidden.
struct Visit {
  int person = 0, frames = 0;
  double last_s = 0.0;
  std::map<std::uint32_t, int> frames_of_id;

  int longest() const {
    int most = 0;
    for (const auto& [id, count] : frames_of_id) most = std::max(most, count);
    return most;
  }
};

/// What following the people of a rendered scenario gave against the truth, with true masks.
struct Followed {
  std::vector<double> position_m, velocity_mps;  // errors
  std::vector<Visit> visits;
};

Followed follow(const std::string& name, std::uint64_t seed, double seconds) {
  Scenario scenario = makeScenario(name, seed, seconds);
  scenario.fps = 15.0;
  const SyntheticRoom room(scenario, syntheticCamera("320x240"));
  std::vector<synthetic::PersonMotion> truth;
  for (const auto& person : scenario.people) truth.emplace_back(person, scenario.duration_s);
  const PeopleConfig config;
  MoverTracker tracker(config);
  Followed result;
  const auto visitOf = [&](int person, double time_s) -> Visit& {
    for (Visit& visit : result.visits) {
      if (visit.person == person && time_s - visit.last_s < config.keep_s) return visit;
    }
    result.visits.push_back({person, 0, time_s, {}});
    return result.visits.back();
  };
  for (int i = 0; i < room.frameCount(); ++i) {
    const double time_s = room.frameTime(i);
    const SyntheticFrame rendered = room.render(time_s);
    const DynamicPoints dynamic =
        dynamicPoints(rendered.frame, rendered.person_mask, rendered.person_mask, rendered.T_world_camera, config);
    const std::vector<MoverView> views = findMovers(dynamic, rendered.T_world_camera.translation().head<2>(),
                                                    tracker.expected(rendered.frame.stamp), config);
    const std::vector<TrackedMover> movers = tracker.update(views, rendered.frame.stamp);
    for (std::size_t p = 0; p < truth.size(); ++p) {
      const Eigen::Vector2d at = truth[p].at(time_s).position_m;
      const bool whole = std::any_of(views.begin(), views.end(), [&](const MoverView& view) {
        return (view.position - at).norm() < 0.5 && view.sigma_m < 0.1;
      });
      if (!whole) continue;
      Visit& visit = visitOf(static_cast<int>(p), time_s);
      visit.last_s = time_s;
      ++visit.frames;
      for (const TrackedMover& mover : movers) {
        if ((mover.position - at).norm() > 0.5) continue;
        ++visit.frames_of_id[mover.id];
        result.position_m.push_back((mover.position - at).norm());
        const Eigen::Vector2d moved = truth[p].at(time_s + 0.05).position_m - truth[p].at(time_s - 0.05).position_m;
        result.velocity_mps.push_back((mover.velocity - moved / 0.1).norm());
        EXPECT_TRUE(mover.person);
      }
    }
  }
  return result;
}

TEST(Movers, PeopleAreFollowedWhereTheyWalk) {
  for (const auto& [name, seed] : {std::pair("walking", 1), {"walking", 2}, {"along_axis", 1}, {"planar_wall", 2}}) {
    SCOPED_TRACE(std::string(name) + " " + std::to_string(seed));
    const Followed followed = follow(name, seed, 6.0);
    ASSERT_GT(followed.position_m.size(), 20U);
    EXPECT_LT(median(followed.position_m), 0.15);
    EXPECT_LT(median(followed.velocity_mps), 0.2);
    for (const Visit& visit : followed.visits) {
      const int until_confirmed = 4;  // 0.2 s
      if (visit.frames > 15) {
        EXPECT_GE(visit.longest(), 0.9 * (visit.frames - until_confirmed)) << "person " << visit.person;
      }
    }
  }
}

/// A flat body of some width at a place, seen by a camera at the origin that looks along x.
std::vector<MoverView> bodiesAt(const std::vector<Eigen::Vector2d>& places,
                                const std::vector<Eigen::Vector2d>& expected = {}) {
  DynamicPoints points;
  for (const auto& place : places) {
    for (double y = -0.2; y <= 0.2; y += 0.02) {
      for (double z = 0.1; z <= 1.7; z += 0.02) {
        points.points.emplace_back(place.x(), place.y() + y, z);
        points.area_m2.push_back(0.0004F);
        points.person.push_back(1);
        points.at_edge.push_back(0);
      }
    }
  }
  return findMovers(points, {0, 0}, expected, {});
}

TEST(Movers, TwoShoulderToShoulderAreTwo) {
  const std::vector<MoverView> views = bodiesAt({{2.0, -0.3}, {2.0, 0.3}});
  ASSERT_EQ(views.size(), 2U);
  for (const MoverView& view : views) {
    EXPECT_NEAR(std::abs(view.position.y()), 0.3, 0.1);
    EXPECT_NEAR(view.position.x(), 2.0 + PeopleConfig().half_depth_m, 0.03);
    EXPECT_NEAR(view.top_m, 1.7, 0.1);
  }
}

TEST(Movers, TwoWhoComeTogetherStayTwoWhereBothAreKnown) {
  EXPECT_EQ(bodiesAt({{2.0, -0.2}, {2.0, 0.2}}).size(), 1U);
  const double x = 2.0 + PeopleConfig().half_depth_m;
  EXPECT_EQ(bodiesAt({{2.0, -0.2}, {2.0, 0.2}}, {{x, -0.22}, {x, 0.22}}).size(), 2U);
}

TEST(Movers, WhoIsHiddenForAMomentKeepsTheId) {
  MoverTracker tracker({});
  std::vector<TrackedMover> movers;
  for (int i = 0; i < 60; ++i) {
    const bool hidden = i >= 30 && i < 45;  // half a second, 0.5 m
    const std::vector<MoverView> views = hidden ? std::vector<MoverView>() : bodiesAt({{2.0, -1.0 + i / 30.0}});
    movers = tracker.update(views, Stamp::fromSeconds(100.0 + i / 30.0));
    EXPECT_EQ(movers.empty(), hidden || i < 6) << i;
    if (!movers.empty()) {
      EXPECT_EQ(movers[0].id, 1U);
    }
  }
  ASSERT_EQ(movers.size(), 1U);
  EXPECT_NEAR(movers[0].velocity.y(), 1.0, 0.1);
}

TEST(Movers, AFlickerIsNobody) {
  MoverTracker tracker({});
  for (int i = 0; i < 60; ++i) {
    const std::vector<MoverView> views = i % 12 == 0 ? bodiesAt({{2.0, 0.0}}) : std::vector<MoverView>();
    EXPECT_TRUE(tracker.update(views, Stamp::fromSeconds(100.0 + i / 30.0)).empty());
  }
}

TEST(Movers, TimeThatGoesBackForgetsAll) {
  MoverTracker tracker({});
  for (int i = 0; i < 15; ++i) tracker.update(bodiesAt({{2.0, 0.0}}), Stamp::fromSeconds(100.0 + i / 30.0));
  EXPECT_TRUE(tracker.update(bodiesAt({{2.0, 0.0}}), Stamp::fromSeconds(50.0)).empty());
}

}  // namespace
}  // namespace semantic_vslam
