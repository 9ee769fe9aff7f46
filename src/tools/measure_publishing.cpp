// SPDX-FileCopyrightText: 2026 The semantic_vslam authors
// SPDX-License-Identifier: BSD-3-Clause
//
// What it costs to publish the dense map, against its size.
#include <algorithm>
#include <cmath>
#include <cstdio>
#include <functional>
#include <opencv2/core.hpp>
#include <string>
#include <utility>
#include <vector>

#include "core/common/arguments.h"
#include "core/common/config_arguments.h"
#include "core/dense/dense_mapper.h"
#include "core/dense/keyframe_cloud.h"
#include "core/io/json_writer.h"
#include "core/runtime/step_clock.h"
#include "eval/scenario_source.h"
#include "ros/map_messages.h"
#include "semantic_vslam/core/pipeline/config.h"

namespace semantic_vslam {
namespace {

constexpr char kUsage[] =
    "usage: measure_publishing [--rooms N] [--seed N] [--set KEY=VALUE]\n"
    "Maps a rendered room (scenario static, true poses and labels) and copies of it side by side, and prints, for 1, "
    "2,\n"
    "4 .. N rooms, one JSON object with CPU ms of each of the dense map's messages: the first time, and after a part "
    "of\n"
    "a view was seen again with a box of 0.2 m before the wall (median of five); and of that keyframe's insertion.\n"
    "  --rooms N   the most (8)\n"
    "  --seed N    of the room (1)\n";

struct View {
  RgbdFrame frame;
  cv::Mat1b labels;
  SE3 T_world_camera;
};

/// Two frames a second, in the room and once round.
std::vector<View> renderViews(std::size_t seed) {
  ScenarioSource source(makeScenario("static", seed, 0.0), syntheticCamera("640x480"));
  const auto step = static_cast<std::size_t>(0.5 * source.room().scenario().fps);
  std::vector<View> views;
  while (const auto frame = source.next()) {
    views.push_back({*frame, source.rendered().labels.clone(), source.rendered().T_world_camera});
    source.skip(step - 1);
  }
  return views;
}

SE3 inRoom(const View& view, std::size_t room, const Eigen::Vector3d& size_m) {
  constexpr double kApartM = 0.5;
  return Eigen::Translation3d(static_cast<double>(room) * (size_m.x() + kApartM), 0.0, 0.0) * view.T_world_camera;
}

/// A part of a view in the middle of the picture, and a box that stands there; the rest says nothing.
struct Part {
  RgbdFrame frame;
  cv::Mat1b excluded;
};
Part partOf(const View& view, double share) {
  Part part{view.frame, cv::Mat1b(view.frame.depth_m.size(), std::uint8_t{255})};
  const double side = std::sqrt(share);
  const int width = static_cast<int>(side * part.excluded.cols), height = static_cast<int>(side * part.excluded.rows);
  const cv::Rect seen((part.excluded.cols - width) / 2, (part.excluded.rows - height) / 2, width, height);
  part.excluded(seen) = 0;
  cv::Mat1f depth_m = cv::Mat1f::zeros(part.excluded.size());
  part.frame.depth_m(seen).copyTo(depth_m(seen));
  cv::Mat1f box = depth_m(cv::Rect(seen.x + width / 3, seen.y + height / 3, width / 3, height / 3));
  for (float& z_m : box) z_m = std::max(0.0F, z_m - 0.2F);
  part.frame.depth_m = depth_m;
  return part;
}

using Messages = MapMessages::State;
const std::vector<std::pair<std::string, std::function<void(Messages&)>>>& topics() {
  static const std::vector<std::pair<std::string, std::function<void(Messages&)>>> all = {
      {"semantic_cloud", [](Messages& map) { map.cloud(); }},
      {"octomap_binary", [](Messages& map) { map.binaryOctomap(); }},
      {"octomap_full", [](Messages& map) { map.fullOctomap(); }},
      {"octomap_point_cloud_centers", [](Messages& map) { map.centres(); }},
      {"occupied_cells_vis_array", [](Messages& map) { map.cells(true); }},
      {"free_cells_vis_array", [](Messages& map) { map.cells(false); }},
      {"projected_map", [](Messages& map) { map.grid(); }},
      {"objects", [](Messages& map) { map.objects(); }},
      {"object_markers", [](Messages& map) { map.objectMarkers(); }},
  };
  return all;
}

/// CPU ms of each message as if it alone were watched.
std::vector<double> publish(MapMessages& messages, const DenseMapper& map, bool first) {
  std::vector<double> ms;
  for (const auto& [name, make] : topics()) {
    if (first) map.forgetParts();
    Messages state = messages.of(map, map.labels(), std_msgs::Header());
    const StepClock clock;
    make(state);
    ms.push_back(clock.elapsed().cpu_ms);
  }
  return ms;
}

/// Measures a map as it is and after changes. @param next_id  of a keyframe
void measure(DenseMapper& mapper, const std::vector<View>& views, std::size_t rooms, const Eigen::Vector3d& size_m,
             std::uint64_t& next_id, JsonWriter& json) {
  constexpr int kChanges = 5;
  // About 1 % of the blocks: what looks through a block counts, so that they grow more slowly than the part.
  const double share_of_view = 0.02 * std::pow(static_cast<double>(rooms), 1.3);
  MapMessages messages{MapObjectsConfig()};
  const std::vector<double> first = publish(messages, mapper, true);
  publish(messages, mapper, false);
  std::vector<std::vector<double>> after(topics().size());
  std::vector<double> insertion, changed;
  for (int change = 0; change < kChanges; ++change) {
    const View& view = views[(change + 1) * views.size() / (kChanges + 1)];
    const Part part = partOf(view, std::min(1.0, share_of_view));
    const std::uint32_t revision = mapper.voxelMap().revision();
    const StepClock clock;
    mapper.add(KeyframeId(next_id++), part.frame, view.labels, part.excluded, inRoom(view, change % rooms, size_m));
    insertion.push_back(clock.elapsed().cpu_ms);
    const std::vector<VoxelBlock>& blocks = mapper.voxelMap().blocks();
    const auto news = std::count_if(blocks.begin(), blocks.end(), [&](const auto& b) { return b.changed > revision; });
    changed.push_back(static_cast<double>(news) / static_cast<double>(blocks.size()));
    const std::vector<double> ms = publish(messages, mapper, false);
    for (std::size_t i = 0; i < ms.size(); ++i) after[i].push_back(ms[i]);
  }
  const OccupancyGrid grid = mapper.projectedMap(SE3::Identity());
  json.beginObject(std::to_string(rooms));
  json.field("floor_m2", static_cast<double>(rooms) * size_m.x() * size_m.y());
  json.field("keyframes", mapper.keyframes());
  json.field("voxels", mapper.voxels());
  json.field("points", mapper.cloud().size());
  json.field("memory_mb", 1e-6 * static_cast<double>(mapper.memoryBytes()));
  json.field("voxels_mb", 1e-6 * static_cast<double>(mapper.voxelMap().memoryBytes()));
  json.field("blocks", mapper.voxelMap().blocks().size());
  json.field("blocks_changed", quantile(changed, 0.5));
  json.field("insertion_ms", quantile(insertion, 0.5));
  for (const bool again : {false, true}) {
    json.beginObject(again ? "after_change_ms" : "first_ms");
    for (std::size_t i = 0; i < first.size(); ++i) {
      json.field(topics()[i].first, again ? quantile(after[i], 0.5) : first[i]);
    }
    json.endObject();
  }
  json.endObject();
}

int run(const Arguments& arguments) {
  cv::setNumThreads(1);
  SystemConfig config;
  config.dense.memory_mb = 8192;
  applySettings(arguments, config);
  const std::size_t most = arguments.count("--rooms", 8, 1), seed = arguments.count("--seed", 1);
  const std::vector<View> views = renderViews(seed);
  const Eigen::Vector3d size_m = makeScenario("static", seed, 0.0).rooms.front().size_m;
  DenseMapper mapper(config.dense, syntheticLabels());
  JsonWriter json;
  std::uint64_t next_id = 0;
  std::size_t rooms = 0;
  for (std::size_t wanted = 1; wanted <= most; wanted *= 2) {
    for (; rooms < wanted; ++rooms) {
      for (const View& view : views) {
        mapper.add(KeyframeId(next_id++), view.frame, view.labels, {}, inRoom(view, rooms, size_m));
      }
    }
    measure(mapper, views, rooms, size_m, next_id, json);
    std::fprintf(stderr, "%zu rooms measured\n", rooms);
  }
  std::fputs(json.finish().c_str(), stdout);
  return 0;
}

}  // namespace
}  // namespace semantic_vslam

int main(int argc, char** argv) {
  using namespace semantic_vslam;
  return runTool(argc, argv, kUsage, [&] {
    return run(Arguments(argc, argv, {"--rooms", "--seed", "--set"}, {}, {0, 0}));
  });
}
