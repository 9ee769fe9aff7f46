// SPDX-FileCopyrightText: 2026 The semantic_vslam authors
// SPDX-License-Identifier: BSD-3-Clause
//
// Judges the dense map against the truth: the exact geometry of a rendered room, or the map of the same room without
// people.
#include <algorithm>
#include <cmath>
#include <cstdarg>
#include <cstdio>
#include <filesystem>
#include <map>
#include <memory>
#include <opencv2/core.hpp>
#include <opencv2/imgcodecs.hpp>
#include <optional>
#include <set>
#include <string>
#include <vector>

#include "core/common/arguments.h"
#include "core/common/atomic_file.h"
#include "core/common/config_arguments.h"
#include "core/common/progress.h"
#include "core/dense/dense_mapper.h"
#include "core/dense/map_objects.h"
#include "core/io/image_file.h"
#include "core/io/json_writer.h"
#include "core/io/trajectory.h"
#include "core/pipeline/dense_stage.h"
#include "core/pipeline/sparse_slam.h"
#include "eval/cloud_view.h"
#include "eval/map_picture.h"
#include "eval/map_score.h"
#include "eval/open_recording.h"
#include "eval/scenario_source.h"
#include "ros/node_configs.h"
#include "semantic_vslam/core/common/error.h"
#include "semantic_vslam/core/common/stage_timing.h"
#include "semantic_vslam/core/pipeline/pipeline.h"

namespace semantic_vslam {
namespace {

namespace fs = std::filesystem;

constexpr char kUsage[] =
    "usage: measure_map --scenario NAME [--seed N] [--seconds S] [--fps N] [--size WxH] [options]\n"
    "       measure_map SEQUENCE_DIR --camera FILE --empty DIR [options]\n"
    "Maps a recording and judges the dense map: that of a rendered room against its exact geometry, that of a TUM\n"
    "folder against the map of the same room without people, made of --empty's frames at the same poses.\n"
    "  --empty DIR       a TUM folder with frames of the same stamps and nobody in them\n"
    "  --leave-out X0,Y0,Z0,X1,Y1,Z1   a box, m, in the frame of groundtruth.txt in which nothing counts: someone who\n"
    "                    sits in --empty, too\n"
    "  --true-labels     a rendered room's true labels in place of a network\n"
    "  --true-poses      of a rendered room: the dense stage alone, with true poses, labels and masks, twice a second\n"
    "  --run DIR         of a TUM folder: the dense stage alone, with what `run_offline --masks --out DIR` left there\n"
    "  --config FILE, --set KEY=VALUE   as run_offline's\n"
    "  --frames N        stop after N frames\n"
    "  --out DIR         write map.json and the pictures map.png, grid.png and objects.png there\n";

/// A rendered room's true labels, in place of a network.
class TrueLabels final : public Segmenter {
 public:
  explicit TrueLabels(const ScenarioSource& source) : source_(source), labels_(syntheticLabels()) {}
  const LabelSet& labels() const override { return labels_; }
  Segmentation segment(const cv::Mat3b& /*bgr*/) override { return {source_.rendered().labels.clone()}; }

 private:
  const ScenarioSource& source_;
  LabelSet labels_;
};

struct Options {
  std::string out;
  std::size_t frames = 0;
  bool true_labels = false, true_poses = false;
  std::optional<std::string> run;  // folder of an earlier run
  SystemConfig config;
};

Options readOptions(const Arguments& arguments) {
  Options options;
  if (const auto file = arguments.value("--config")) loadSharedConfigFile(options.config, *file);
  applySettings(arguments, options.config);
  options.out = arguments.value("--out").value_or("");
  options.frames = arguments.count("--frames", 1000000, 1);
  options.true_labels = arguments.has("--true-labels");
  options.true_poses = arguments.has("--true-poses");
  options.run = arguments.value("--run");
  if (!options.out.empty()) fs::create_directories(options.out);
  return options;
}

/// A finished dense map, with whatever made it.
struct Mapped {
  std::unique_ptr<Pipeline> pipeline;
  std::unique_ptr<DenseStage> stage;
  std::unique_ptr<StageTimes> times = std::make_unique<StageTimes>();

  const DenseMapper& map() const { return pipeline ? pipeline->dense() : stage->map(); }
  double insertionMs() const {
    for (const StageSummary& summary : (pipeline ? pipeline->times() : *times).summarize()) {
      if (summary.stage == "dense_mapping") return summary.cpu.median_ms;
    }
    return 0.0;
  }
};

/// Gives a keyframe to the dense stage alone, as if its pose were known at once.
void addAlone(const RgbdFrame& frame, const cv::Mat1b& labels, const cv::Mat1b& removed, const SE3& T_world_camera,
              Mapped& mapped, MapSnapshot& snapshot) {
  auto timer = mapped.times->scope("dense_mapping", frame.index);
  KeyframeInput input;
  input.keyframe.id = KeyframeId(frame.index);
  input.frame = frame;
  input.motion.dynamic = removed;
  input.labels = labels;
  snapshot.poses.push_back({KeyframeId(frame.index), frame.stamp, T_world_camera});
  mapped.stage->add(input);
  mapped.stage->take(snapshot);
}

Mapped mapWithPipeline(FrameSource& source, const Options& options, std::unique_ptr<Segmenter> labels, SeenRoom* seen) {
  Mapped mapped;
  mapped.pipeline = labels ? std::make_unique<Pipeline>(options.config, std::move(labels))
                           : std::make_unique<Pipeline>(options.config);
  const std::size_t count = std::min(options.frames, source.size());
  Progress progress(count, "frames");
  for (std::size_t i = 0; i < count; ++i) {
    const auto frame = source.next();
    if (!frame) break;
    if (seen != nullptr) seen->add(static_cast<ScenarioSource&>(source).rendered(), *source.camera());
    mapped.pipeline->step(*frame);
    progress.show(i + 1);
  }
  progress.end();
  mapped.pipeline->finish();
  return mapped;
}

Mapped mapWithTruth(ScenarioSource& source, const Options& options, SeenRoom& seen) {
  Mapped mapped;
  mapped.stage = std::make_unique<DenseStage>(options.config.dense, options.config.removal);
  mapped.stage->take(syntheticLabels());
  MapSnapshot snapshot;
  const auto step = static_cast<std::size_t>(std::lround(0.5 * source.room().scenario().fps));
  for (std::size_t i = 0; i < std::min(options.frames, source.size()); i += step) {
    const auto frame = source.next();
    if (!frame) break;
    source.skip(step - 1);
    seen.add(source.rendered(), *source.camera());
    addAlone(*frame, source.rendered().labels, source.groundTruthMask(), source.rendered().T_world_camera, mapped,
             snapshot);
  }
  mapped.stage->map().finish();
  return mapped;
}

/// What a run of run_offline removed and where it says the camera was.
Mapped mapAgain(TumSequence& sequence, const Options& options) {
  Mapped mapped;
  mapped.stage = std::make_unique<DenseStage>(options.config.dense, options.config.removal);
  MapSnapshot snapshot;
  const std::vector<TimedPose> trajectory = readTumTrajectory(*options.run + "/trajectory.txt");
  for (std::size_t i = 0; i < sequence.pairs().size(); ++i) {
    const Stamp stamp = sequence.pairs()[i].rgb_stamp;
    const std::string mask = *options.run + "/removed/" + formatStamp(stamp) + ".png";
    const TimedPose* pose = closestPose(trajectory, stamp, 1e-4);
    if (pose == nullptr || !fs::exists(mask)) continue;
    sequence.seek(i);
    const auto frame = sequence.next();
    if (!frame) break;
    addAlone(*frame, {}, readImageFile(mask, cv::IMREAD_GRAYSCALE), pose->T_world_camera, mapped, snapshot);
  }
  mapped.stage->map().finish();
  return mapped;
}

std::vector<LabelledPoint> moved(std::vector<LabelledPoint> cloud, const SE3& T) {
  for (LabelledPoint& point : cloud) {
    const Eigen::Vector3f p = (T * point.position()).cast<float>();
    point.xyz_m = {p.x(), p.y(), p.z()};
  }
  return cloud;
}

/// The frame with this colour stamp, if the sequence has it.
std::optional<RgbdFrame> frameAt(TumSequence& sequence, Stamp stamp) {
  const std::vector<TumPair>& pairs = sequence.pairs();  // in order of the stamp
  const auto pair = std::lower_bound(pairs.begin(), pairs.end(), stamp, [](const TumPair& candidate, Stamp wanted) {
    return candidate.rgb_stamp < wanted;
  });
  if (pair == pairs.end()) return std::nullopt;
  sequence.seek(static_cast<std::size_t>(pair - pairs.begin()));
  std::optional<RgbdFrame> frame = sequence.next();
  return frame && frame->stamp == stamp ? frame : std::nullopt;
}

/// The map of the empty room: another recording's frames at a map's poses, nothing removed.
DenseMapper mapOfEmptyRoom(const DenseMapper& map, TumSequence& empty, const DenseConfig& config) {
  DenseMapper result(config, {});
  for (const TimedPose& view : map.views()) {
    const auto frame = frameAt(empty, view.stamp);
    if (frame) result.add(KeyframeId(result.keyframes()), *frame, {}, {}, view.T_world_camera);
  }
  if (result.keyframes() == 0) throw FileError("--empty: no frame has the stamp of any keyframe");
  return result;
}

/// All that was ever measured in the empty room, noise and all.
std::vector<LabelledPoint> measuredInEmptyRoom(const DenseMapper& map, TumSequence& empty, KeyframeCloudConfig config) {
  constexpr double kCubeM = 0.02;
  config.max_incidence_deg = 89.0;  // edges, too
  std::vector<LabelledPoint> points;
  for (const TimedPose& view : map.views()) {
    const auto frame = frameAt(empty, view.stamp);
    if (!frame) continue;
    const KeyframeCloud cloud = makeKeyframeCloud({}, *frame, {}, {}, config);
    const std::vector<LabelledPoint> in_world = moved(cloud.points, view.T_world_camera);
    points.insert(points.end(), in_world.begin(), in_world.end());
    points = voxelFilter(points, kCubeM);
  }
  return points;
}

/// From a map's world into the room's, by all of its keyframes: rotations and places are averaged.
SE3 truthFromWorld(const DenseMapper& map, const std::vector<TimedPose>& truth) {
  Eigen::Matrix3d sum = Eigen::Matrix3d::Zero();
  std::vector<std::pair<SE3, SE3>> pairs;
  for (const KeyframePose& pose : map.poses()) {
    const TimedPose* true_pose = closestPose(truth, pose.stamp, 1e-3);
    if (true_pose == nullptr) continue;
    pairs.emplace_back(true_pose->T_world_camera, pose.T_world_camera);
    sum += true_pose->T_world_camera.linear() * pose.T_world_camera.linear().transpose();
  }
  if (pairs.empty()) throw Error("no keyframe was mapped");
  const Eigen::JacobiSVD<Eigen::Matrix3d> svd(sum, Eigen::ComputeFullU | Eigen::ComputeFullV);
  SE3 T = SE3::Identity();
  T.linear() = svd.matrixU() * svd.matrixV().transpose();
  for (const auto& [true_pose, pose] : pairs) {
    T.translation() += (true_pose.translation() - T.linear() * pose.translation()) / static_cast<double>(pairs.size());
  }
  return T;
}

void report(const std::string& text, JsonWriter& json, const Options& options) {
  std::fputs(text.c_str(), stdout);
  if (!options.out.empty()) writeTextAtomically(options.out + "/map.json", json.finish());
}

std::string line(const char* format, ...) __attribute__((format(printf, 1, 2)));
std::string line(const char* format, ...) {
  char buffer[300];
  va_list values;
  va_start(values, format);
  std::vsnprintf(buffer, sizeof(buffer), format, values);
  va_end(values);
  return std::string(buffer) + "\n";
}

std::string writeScores(const SurfaceScore& surface, const GridScore& grid, JsonWriter& json) {
  json.field("points", surface.points);
  json.field("points_within_2cm", surface.points_within_2cm);
  json.field("points_mean_error_m", surface.mean_error_m);
  json.field("surface_found", surface.surface_found);
  json.field("voxels", surface.voxels);
  json.field("voxels_beyond_5cm", surface.voxels_beyond_5cm);
  json.field("voxels_of_people", surface.voxels_of_people);
  json.field("labels_right", surface.labels_right);
  json.beginObject("grid");
  json.field("free", grid.free);
  json.field("free_on_obstacle", grid.free_on_obstacle);
  json.field("occupied", grid.occupied);
  json.field("occupied_on_free", grid.occupied_on_free);
  json.field("passable", grid.passable);
  json.field("passable_known", grid.passable_known);
  json.endObject();
  return line("points %zu: %.2f %% within 2 cm, mean error %.1f mm; %.2f %% of the seen surface found", surface.points,
              100.0 * surface.points_within_2cm, 1e3 * surface.mean_error_m, 100.0 * surface.surface_found) +
         line("voxels %zu: %.2f %% farther than 5 cm from anything (of people %.2f %%); labels right %.3f",
              surface.voxels, 100.0 * surface.voxels_beyond_5cm, 100.0 * surface.voxels_of_people,
              surface.labels_right) +
         line(
             "grid: %d cells free, %d of them on obstacles; %d occupied, %d of them where nothing is; %d of %d "
             "passable "
             "known",
             grid.free, grid.free_on_obstacle, grid.occupied, grid.occupied_on_free, grid.passable_known,
             grid.passable);
}

std::string writeObjects(const std::map<std::uint8_t, ObjectScore>& scores, const LabelSet& labels, JsonWriter& json) {
  std::string text;
  json.beginObject("objects");
  for (const auto& [label, score] : scores) {
    const std::string name = label < labels.classes.size() ? labels.classes[label].name : std::to_string(label);
    const double median_m = score.centroid_error_m.empty() ? 0.0 : quantile(score.centroid_error_m, 0.5);
    const double worst_m = score.centroid_error_m.empty() ? 0.0 : quantile(score.centroid_error_m, 1.0);
    json.beginObject(name);
    json.field("things", score.things);
    json.field("listed_once", score.listed_once);
    json.field("more_pieces", score.pieces);
    json.field("missing", score.missing);
    json.field("on_nothing", score.on_nothing);
    json.field("centroid_error_m", score.centroid_error_m);
    json.endObject();
    text += line(
        "%-9s %2d of %2d listed once, %d missing, %d more pieces, %d on nothing; centroid error %.2f m, worst %.2f",
        name.c_str(), score.listed_once, score.things, score.missing, score.pieces, score.on_nothing, median_m,
        worst_m);
  }
  json.endObject();
  return text;
}

int measureRoom(const Arguments& arguments, const Options& options) {
  Scenario scenario = makeScenario(*arguments.value("--scenario"), arguments.count("--seed", 1),
                                   arguments.has("--seconds") ? arguments.positiveNumber("--seconds", 1.0) : 0.0);
  scenario.fps = arguments.positiveNumber("--fps", scenario.fps);
  ScenarioSource source(scenario, syntheticCamera(arguments.value("--size").value_or("640x480")));
  SeenRoom seen{RoomTruth(source.room().standingAtTheEnd())};
  const Mapped mapped =
      options.true_poses ? mapWithTruth(source, options, seen)
                         : mapWithPipeline(source, options,
                                           options.true_labels ? std::make_unique<TrueLabels>(source) : nullptr, &seen);
  const DenseMapper& map = mapped.map();
  const SE3 T_truth_world = truthFromWorld(map, source.groundTruth());
  const OccupancyGridConfig& band = options.config.dense.grid;
  const OccupancyGrid grid = map.projectedMap(T_truth_world);
  const std::vector<LabelledPoint> cloud = moved(map.cloud(), T_truth_world);
  const std::vector<MapObject> objects = findObjects(
      cloud, MapObjectsConfig(), [&](const auto& p) { return map.evidenceAt(T_truth_world.inverse() * p); });
  const LabelSet labels = map.labels();

  JsonWriter json;
  json.field("scenario", scenario.name);
  json.field("seed", static_cast<std::uint64_t>(scenario.seed));
  json.field("keyframes", map.keyframes());
  json.field("insertion_ms", mapped.insertionMs());
  std::string text = line("%s, seed %d: %zu keyframes, %.1f ms CPU each (median)", scenario.name.c_str(),
                          static_cast<int>(scenario.seed), map.keyframes(), mapped.insertionMs());
  text += writeScores(scoreSurface(map, T_truth_world, seen),
                      scoreGrid(grid, band.min_height_m, band.max_height_m, seen.truth()), json);
  text += writeObjects(scoreObjects(objects, seen), labels, json);
  report(text, json, options);
  if (options.out.empty()) return 0;

  const std::vector<KeyframePose> poses = map.poses();
  const KeyframePose& view = poses[poses.size() / 2];
  std::vector<LabelledPoint> wrong;
  std::copy_if(cloud.begin(), cloud.end(), std::back_inserter(wrong),
               [&](const LabelledPoint& point) { return seen.truth().nearest(point.position()).distance_m > 0.05; });
  const cv::Mat3b true_view = source.room().render(secondsBetween(SyntheticRoom::stampAt(0.0), view.stamp)).frame.bgr;
  writeImageFile(options.out + "/map.png", drawBesideTruth(cloud, wrong, true_view, T_truth_world * view.T_world_camera,
                                                           *source.camera(), options.config.dense.cloud_resolution_m));
  writeImageFile(options.out + "/grid.png", drawGrid(grid, band.min_height_m, band.max_height_m, seen.truth()));
  writeImageFile(options.out + "/objects.png", drawObjects(objects, seen, labels));
  return 0;
}

/// Takes out what lies in the box of --leave-out.
void leaveOut(const Arguments& arguments, const SE3& T_truth_world, std::vector<LabelledPoint>& cloud) {
  const auto text = arguments.value("--leave-out");
  if (!text) return;
  Eigen::Vector3d low, high;
  if (std::sscanf(text->c_str(), "%lf,%lf,%lf,%lf,%lf,%lf", &low[0], &low[1], &low[2], &high[0], &high[1], &high[2]) !=
      6) {
    throw UsageError("--leave-out needs six numbers with commas between them, not '" + *text + "'");
  }
  const Eigen::AlignedBox3d box(low, high);
  cloud.erase(std::remove_if(cloud.begin(), cloud.end(),
                             [&](const LabelledPoint& p) { return box.contains(T_truth_world * p.position()); }),
              cloud.end());
}

/// What of the empty room the frames of the map saw past the people.
std::vector<LabelledPoint> seenPastPeople(const DenseMapper& map, TumSequence& sequence,
                                          const std::vector<LabelledPoint>& empty) {
  SeenPastPeople seen(empty);
  for (const TimedPose& view : map.views()) {
    const auto frame = frameAt(sequence, view.stamp);
    const cv::Mat1b people = frame ? sequence.groundTruthMask() : cv::Mat1b();
    if (!people.empty()) seen.add(*frame, people, view.T_world_camera);
  }
  return seen.seen();
}

int measureFolder(const Arguments& arguments, const Options& options) {
  const auto empty_path = arguments.value("--empty");
  if (!empty_path) throw UsageError("a TUM folder needs --empty DIR, the same frames with nobody in them");
  TumSequence sequence = openTumFolder(arguments);
  TumSequence empty(*empty_path, sequence.camera());
  const Mapped mapped =
      options.run ? mapAgain(sequence, options) : mapWithPipeline(sequence, options, nullptr, nullptr);
  const DenseMapper& map = mapped.map();
  const DenseMapper empty_map = mapOfEmptyRoom(map, empty, options.config.dense);
  std::vector<LabelledPoint> cloud = map.cloud(), empty_cloud = empty_map.cloud();
  const SE3 T_truth_world = truthFromWorld(map, sequence.groundTruth());
  leaveOut(arguments, T_truth_world, cloud);
  leaveOut(arguments, T_truth_world, empty_cloud);
  std::vector<LabelledPoint> raw = measuredInEmptyRoom(map, empty, options.config.dense.keyframe);
  const RoomComparison comparison = compareWithEmptyRoom(cloud, empty_cloud);
  const std::vector<LabelledPoint> seen = seenPastPeople(map, sequence, empty_cloud);
  const double found_of_seen = compareWithEmptyRoom(cloud, seen).found_again;
  const double of_people = compareWithEmptyRoom(cloud, raw).left_over;

  JsonWriter json;
  json.field("sequence", arguments.positional()[0]);
  json.field("keyframes", map.keyframes());
  json.field("insertion_ms", mapped.insertionMs());
  json.field("voxels_2cm", comparison.points);
  json.field("left_over", comparison.left_over);
  json.field("empty_voxels_2cm", comparison.empty_points);
  json.field("found_again", comparison.found_again);
  json.field("left_over_of_people", of_people);
  json.field("seen_past_people", seen.size());
  json.field("found_of_seen", found_of_seen);
  report(line("%zu keyframes, %.1f ms CPU each (median)", map.keyframes(), mapped.insertionMs()) +
             line("%zu voxels of 2 cm, %.2f %% of them farther than 5 cm from the empty room's map, %.2f %% from "
                  "anything measured in it; found again within 3 cm %.2f %% of its %zu, %.2f %% of what was seen past "
                  "the people",
                  comparison.points, 100.0 * comparison.left_over, 100.0 * of_people, 100.0 * comparison.found_again,
                  comparison.empty_points, 100.0 * found_of_seen),
         json, options);
  if (options.out.empty()) return 0;
  map.saveCloud(options.out + "/cloud.pcd");
  empty_map.saveCloud(options.out + "/empty_cloud.pcd");
  const std::vector<KeyframePose> poses = map.poses();
  const SE3& view = poses[poses.size() / 2].T_world_camera;
  const double size_m = options.config.dense.cloud_resolution_m;
  const cv::Mat3b empty_view =
      renderCloud(empty_cloud, view, *sequence.camera(), size_m, [](const LabelledPoint& point) { return point.bgr; });
  writeImageFile(options.out + "/map.png",
                 drawBesideTruth(cloud, comparison.left_over_points, empty_view, view, *sequence.camera(), size_m));
  return 0;
}

int run(const Arguments& arguments) {
  cv::setNumThreads(1);
  const Options options = readOptions(arguments);
  if (arguments.value("--scenario").has_value() != arguments.positional().empty()) {
    throw UsageError("give either a TUM folder or --scenario NAME");
  }
  return arguments.positional().empty() ? measureRoom(arguments, options) : measureFolder(arguments, options);
}

}  // namespace
}  // namespace semantic_vslam

int main(int argc, char** argv) {
  using namespace semantic_vslam;
  return runTool(argc, argv, kUsage, [&] {
    return run(Arguments(argc, argv,
                         {"--scenario", "--seed", "--seconds", "--fps", "--size", "--camera", "--empty", "--run",
                          "--leave-out", "--set", "--config", "--frames", "--out"},
                         {"--true-labels", "--true-poses"}, {0, 1}));
  });
}
