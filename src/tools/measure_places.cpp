// SPDX-FileCopyrightText: 2026 The semantic_vslam authors
// SPDX-License-Identifier: BSD-3-Clause
//
// Tells how well places are recognised by appearance alone: keyframes of a recording are looked up, each among those
// that are older, and what comes out best is compared with what the true poses and depths say.
#include <algorithm>
#include <cmath>
#include <cstdio>
#include <opencv2/core.hpp>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "core/common/arguments.h"
#include "core/common/progress.h"
#include "core/common/rng.h"
#include "core/features/orb_extractor.h"
#include "core/features/place_index.h"
#include "core/io/json_writer.h"
#include "core/io/stamp_association.h"
#include "core/loop/loop_detector.h"
#include "eval/open_recording.h"
#include "semantic_vslam/core/common/stage_timing.h"

namespace {

using namespace semantic_vslam;

constexpr const char* kUsage =
    "usage: measure_places (SEQUENCE_DIR --camera FILE | --scenario NAME) [options]\n"
    "Looks up each keyframe of a recording (every 0.1 m or 0.1 rad, by the true poses) among those at least --gap\n"
    "seconds older and prints one JSON object: precision and recall of the best match at several least scores, and\n"
    "the time a query takes, for the index as it is, with one tree and with four.\n"
    "A keyframe is a revisit if an older one shows half of what it shows; a match is right if it shows a fifth of it.\n"
    "  --scenario NAME      rendered on the way in place of a TUM folder; make_synthetic_bag --list names them\n"
    "  --seed N, --size WxH, --fps N   of the scenario (1, 640x480, 2)\n"
    "  --gap N              seconds (5)\n"
    "  --brute-force        also match every pair of keyframes: a second and more for each query\n"
    "  --full N             keyframes in the index when a query is timed (1000; noisy copies fill it up)\n";

constexpr double kKeyframeM = 0.1, kKeyframeRad = 0.1;
constexpr double kRevisit = 0.5, kRight = 0.2;
const std::vector<double> kLeastScores = {0.005, 0.01, LoopDetectorConfig().min_score, 0.05, 0.1};

struct View {
  Stamp stamp;
  SE3 T_world_camera;
  cv::Mat1f depth_m;
  FrameFeatures features;
};

std::vector<View> readKeyframes(FrameSource& recording) {
  const OrbExtractor orb{OrbConfig()};
  std::vector<View> views;
  Progress progress(recording.size(), "frames");
  while (const auto frame = recording.next()) {
    progress.show(frame->index + 1, std::to_string(views.size()) + " keyframes");
    const TimedPose* truth = closestPose(recording.groundTruth(), frame->stamp, kAssociationGapS);
    if (truth == nullptr) continue;
    const SE3& T_world_camera = truth->T_world_camera;
    if (!views.empty()) {
      const SE3 moved = views.back().T_world_camera.inverse() * T_world_camera;
      if (moved.translation().norm() < kKeyframeM && rotationAngle(moved) < kKeyframeRad) continue;
    }
    views.push_back({frame->stamp, T_world_camera, frame->depth_m, orb.extract(*frame, {})});
  }
  return views;
}

/// Share of the surface that `a` shows, on a grid, that `b` shows too: inside the picture and not behind something.
double overlap(const CameraModel& camera, const View& a, const View& b) {
  constexpr int kStride = 20;
  constexpr double kDepthTolerance = 0.05;  // of the depth
  const SE3 T_b_a = b.T_world_camera.inverse() * a.T_world_camera;
  int seen = 0, all = 0;
  for (int v = kStride / 2; v < camera.height(); v += kStride) {
    for (int u = kStride / 2; u < camera.width(); u += kStride) {
      const double depth_m = a.depth_m(v, u);
      if (depth_m <= 0.0) continue;
      ++all;
      const Eigen::Vector3d p = T_b_a * camera.unprojectUndistorted({u, v}, depth_m);
      if (p.z() <= 0.1) continue;
      const Eigen::Vector2d px = camera.projectUndistorted(p);
      if (!camera.contains(px)) continue;
      const double depth_b_m = b.depth_m(static_cast<int>(px.y()), static_cast<int>(px.x()));
      seen += depth_b_m > 0.0 && std::abs(depth_b_m - p.z()) <= kDepthTolerance * p.z() ? 1 : 0;
    }
  }
  return all > 0 ? static_cast<double>(seen) / all : 0.0;
}

/// What is known of one query.
struct Lookup {
  bool revisit = false;
  double overlap = 0.0;  ///< with the best match
  double score = 0.0;    ///< of the best match; 0 = there is none
};

/// One way of looking places up.
class Finder {
 public:
  virtual ~Finder() = default;
  virtual void add(std::size_t view, const FrameFeatures& features) = 0;
  /// @return the best match among what was added, and its score; nothing if there is none
  virtual std::optional<std::pair<std::size_t, double>> best(const FrameFeatures& features) const = 0;
};

class IndexFinder : public Finder {
 public:
  explicit IndexFinder(int trees) : index_(configOf(trees)) {}
  void add(std::size_t view, const FrameFeatures& features) override { index_.add(KeyframeId(view), features); }
  std::optional<std::pair<std::size_t, double>> best(const FrameFeatures& features) const override {
    const auto matches = index_.query(features, 1);
    if (matches.empty()) return std::nullopt;
    return std::make_pair(static_cast<std::size_t>(matches[0].keyframe.value()), matches[0].score);
  }

 private:
  static PlaceIndexConfig configOf(int trees) {
    PlaceIndexConfig config;
    config.trees = trees;
    return config;
  }
  PlaceIndex index_;
};

/// Every descriptor against every other: what an index can reach at best.
class BruteForceFinder : public Finder {
 public:
  void add(std::size_t view, const FrameFeatures& features) override { views_.emplace_back(view, &features); }
  std::optional<std::pair<std::size_t, double>> best(const FrameFeatures& features) const override {
    std::optional<std::pair<std::size_t, double>> best;
    for (const auto& [view, other] : views_) {
      const double score = share(features, *other);
      if (score > 0.0 && (!best || score > best->second)) best = {view, score};
    }
    return best;
  }

 private:
  static double share(const FrameFeatures& a, const FrameFeatures& b) {
    int matched = 0;
    for (int i = 0; i < a.descriptors.rows; ++i) {
      for (int j = 0; j < b.descriptors.rows; ++j) {
        if (descriptorDistance(a.descriptors.ptr(i), b.descriptors.ptr(j)) > PlaceIndexConfig().max_distance) continue;
        ++matched;
        break;
      }
    }
    return static_cast<double>(matched) / std::max<std::size_t>(1, a.size());
  }
  std::vector<std::pair<std::size_t, const FrameFeatures*>> views_;
};

/// Looks every view up among those at least gap_s older.
std::vector<Lookup> lookUpAll(const CameraModel& camera, const std::vector<View>& views, double gap_s, Finder& finder) {
  std::vector<Lookup> lookups;
  std::size_t added = 0;
  Progress progress(views.size(), "keyframes looked up");
  for (const View& view : views) {
    progress.show(lookups.size());
    for (; secondsBetween(views[added].stamp, view.stamp) >= gap_s; ++added) finder.add(added, views[added].features);
    Lookup lookup;
    for (std::size_t i = 0; i < added && !lookup.revisit; ++i) {
      lookup.revisit = overlap(camera, view, views[i]) >= kRevisit;
    }
    if (const auto best = finder.best(view.features)) {
      lookup.score = best->second;
      lookup.overlap = overlap(camera, view, views[best->first]);
    }
    lookups.push_back(lookup);
  }
  return lookups;
}

/// The same features as another camera would have them: one in three is another one, 15 of 256 bits are turned.
FrameFeatures noisyCopy(const FrameFeatures& features, Rng& rng) {
  FrameFeatures copy;
  copy.features = features.features;
  copy.descriptors = features.descriptors.clone();
  for (int i = 0; i < copy.descriptors.rows; ++i) {
    std::uint8_t* bytes = copy.descriptors.ptr(i);
    if (rng.below(3) == 0) {
      for (int b = 0; b < 32; ++b) bytes[b] = static_cast<std::uint8_t>(rng.below(256));
    }
    for (int n = 0; n < 15; ++n) bytes[rng.below(32)] ^= static_cast<std::uint8_t>(1U << rng.below(8));
  }
  return copy;
}

/// @return median CPU time of a query, ms, when the index holds `full` keyframes
double queryMs(const std::vector<View>& views, std::size_t full) {
  PlaceIndex index;
  Rng rng(1);
  for (std::size_t i = 0; i < full; ++i) {
    const FrameFeatures& features = views[i % views.size()].features;
    index.add(KeyframeId(i), i < views.size() ? features : noisyCopy(features, rng));
  }
  std::vector<double> ms;
  for (std::size_t i = 0; i < std::min<std::size_t>(views.size(), 50); ++i) {
    const double begin = threadCpuMs();
    index.query(views[i].features, 10);
    ms.push_back(threadCpuMs() - begin);
  }
  return quantile(ms, 0.5);
}

void writeCurve(JsonWriter& json, const std::string& name, const std::vector<Lookup>& lookups) {
  std::vector<double> precision, recall;
  for (const double least : kLeastScores) {
    int proposed = 0, right = 0, revisits = 0, recalled = 0;
    for (const Lookup& lookup : lookups) {
      const bool is_proposed = lookup.score >= least, is_right = is_proposed && lookup.overlap >= kRight;
      proposed += is_proposed ? 1 : 0;
      right += is_right ? 1 : 0;
      revisits += lookup.revisit ? 1 : 0;
      recalled += lookup.revisit && is_right ? 1 : 0;
    }
    precision.push_back(proposed > 0 ? static_cast<double>(right) / proposed : 1.0);
    recall.push_back(revisits > 0 ? static_cast<double>(recalled) / revisits : 0.0);
  }
  json.beginObject(name);
  json.field("precision", precision);
  json.field("recall", recall);
  json.endObject();
}

int run(const Arguments& arguments) {
  const auto recording = openRecording(arguments, 2.0);
  const double gap_s = arguments.positiveNumber("--gap", 5.0);
  const std::vector<View> views = readKeyframes(*recording);
  if (views.empty()) throw Error("the recording has no frame with a true pose");
  const CameraModel& camera = *recording->camera();
  IndexFinder used(PlaceIndexConfig().trees), one(1), four(4);
  JsonWriter json;
  json.field("keyframes", views.size());
  json.field("least_scores", kLeastScores);
  json.field("used_least_score", LoopDetectorConfig().min_score);
  const std::vector<Lookup> lookups = lookUpAll(camera, views, gap_s, used);
  json.field("revisits", static_cast<std::size_t>(std::count_if(lookups.begin(), lookups.end(),
                                                                [](const Lookup& lookup) { return lookup.revisit; })));
  writeCurve(json, "index", lookups);
  writeCurve(json, "one_tree", lookUpAll(camera, views, gap_s, one));
  writeCurve(json, "four_trees", lookUpAll(camera, views, gap_s, four));
  if (arguments.has("--brute-force")) {
    BruteForceFinder brute;
    writeCurve(json, "brute_force", lookUpAll(camera, views, gap_s, brute));
  }
  json.field("query_ms", queryMs(views, arguments.count("--full", 1000)));
  std::fputs(json.finish().c_str(), stdout);
  return 0;
}

}  // namespace

int main(int argc, char** argv) {
  return runTool(argc, argv, kUsage, [&] {
    cv::setNumThreads(1);
    return run(Arguments(argc, argv, {"--camera", "--scenario", "--seed", "--size", "--fps", "--gap", "--full"},
                         {"--brute-force"}, {0, 1}));
  });
}
