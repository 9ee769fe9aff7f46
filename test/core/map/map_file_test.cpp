// SPDX-FileCopyrightText: 2026 The semantic_vslam authors
// SPDX-License-Identifier: BSD-3-Clause
#include "core/map/map_file.h"

#include <gtest/gtest.h>
#include <sys/stat.h>

#include <algorithm>
#include <cstdio>
#include <fstream>
#include <functional>
#include <limits>

#include "core/support/synthetic_map.h"
#include "semantic_vslam/core/common/error.h"

namespace semantic_vslam {
namespace {

/// A map with everything in it that a file must keep: gaps in the ids, a loop edge, counts.
Map makeMap() {
  SyntheticWorld world(31);
  for (int i = 0; i < 300; ++i) {
    world.addPoint({world.rng().uniform(-1.5, 2.5), world.rng().uniform(-1, 1), world.rng().uniform(1.5, 3)});
  }
  SyntheticMap synthetic;
  for (int k = 0; k < 6; ++k) {
    SE3 T_world_camera = SE3::Identity();
    T_world_camera.translation().x() = 0.2 * k;
    addKeyframe(world, synthetic, T_world_camera.inverse(), T_world_camera.inverse(), {});
  }
  Map map = std::move(synthetic.map);
  map.removeKeyframe(KeyframeId(3));
  map.removeLandmark(LandmarkId(10));
  map.addLoopEdge(KeyframeId(0), KeyframeId(5));
  map.countVisible(LandmarkId(0));
  map.countFound(LandmarkId(0));
  return map;
}

std::string messageOf(const std::function<void()>& action) {
  try {
    action();
  } catch (const FileError& error) {
    return error.what();
  }
  return "no error";
}

void expectSameMap(const Map& a, const Map& b) {
  ASSERT_EQ(a.keyframes().size(), b.keyframes().size());
  ASSERT_EQ(a.landmarks().size(), b.landmarks().size());
  for (const auto& [id, keyframe] : a.keyframes()) {
    const Keyframe& other = *b.keyframe(id);
    EXPECT_EQ(keyframe.stamp, other.stamp);
    EXPECT_EQ(keyframe.T_camera_world.matrix(), other.T_camera_world.matrix());
    EXPECT_EQ(keyframe.parent, other.parent);
    EXPECT_EQ(keyframe.loop_edges, other.loop_edges);
    EXPECT_EQ(keyframe.landmarks, other.landmarks);
    EXPECT_EQ(keyframe.camera->fx(), other.camera->fx());
    EXPECT_EQ(a.covisible(id, 1), b.covisible(id, 1));
    ASSERT_EQ(keyframe.features->size(), other.features->size());
    EXPECT_EQ(cv::countNonZero(keyframe.features->descriptors != other.features->descriptors), 0);
    for (std::size_t i = 0; i < keyframe.features->size(); ++i) {
      EXPECT_EQ(keyframe.features->features[i].undistorted_px, other.features->features[i].undistorted_px);
      EXPECT_EQ(keyframe.features->features[i].depth_m, other.features->features[i].depth_m);
      EXPECT_EQ(keyframe.features->features[i].octave, other.features->features[i].octave);
    }
  }
  for (const auto& [id, landmark] : a.landmarks()) {
    const Landmark& other = *b.landmark(id);
    EXPECT_EQ(landmark.position_world, other.position_world);
    EXPECT_EQ(landmark.mean_view_direction, other.mean_view_direction);
    EXPECT_EQ(landmark.observations, other.observations);
    EXPECT_EQ(landmark.reference_keyframe, other.reference_keyframe);
    EXPECT_EQ(landmark.visible_count, other.visible_count);
    EXPECT_EQ(landmark.found_count, other.found_count);
    EXPECT_EQ(cv::countNonZero(landmark.descriptor != other.descriptor), 0);
  }
}

TEST(MapFile, LoadGivesBackWhatWasSavedAndSavesTheSameBytes) {
  const Map map = makeMap();
  const std::string bytes = serializeMap(map);
  Map loaded;
  parseMap(bytes, "memory", loaded);
  expectSameMap(map, loaded);
  EXPECT_EQ(serializeMap(loaded), bytes);
}

TEST(MapFile, IdsGoOnWhereTheSavedMapStopped) {
  Map map = makeMap(), loaded;
  parseMap(serializeMap(map), "memory", loaded);
  Keyframe keyframe;
  keyframe.camera = map.keyframes().begin()->second.camera;
  keyframe.features = std::make_shared<FrameFeatures>();
  EXPECT_EQ(loaded.addKeyframe(keyframe), KeyframeId(6));
  EXPECT_EQ(map.addKeyframe(keyframe), KeyframeId(6));
}

TEST(MapFile, LoadingBumpsTheVersionSoThatOldProblemsAreRefused) {
  Map map = makeMap();
  const std::uint64_t version = map.version();
  parseMap(serializeMap(map), "memory", map);
  EXPECT_GT(map.version(), version);
}

TEST(MapFile, AnEmptyMapIsAFileToo) {
  Map loaded = makeMap();
  parseMap(serializeMap(Map()), "memory", loaded);
  EXPECT_TRUE(loaded.keyframes().empty());
  EXPECT_TRUE(loaded.landmarks().empty());
}

TEST(MapFile, EveryBadFileIsOneClearErrorAndLeavesTheMapAlone) {
  const std::string good = serializeMap(makeMap());
  Map map = makeMap();
  const auto message = [&map](const std::string& content) {
    return messageOf([&] { parseMap(content, "x.map", map); });
  };
  EXPECT_EQ(message(""), "'x.map' is no map file of semantic_vslam");
  EXPECT_EQ(message("# timestamp tx ty tz"), "'x.map' is no map file of semantic_vslam");
  EXPECT_EQ(message(good.substr(0, 10)), "map file 'x.map' is truncated: save or copy it anew");
  for (const std::size_t size : {std::size_t{24}, good.size() / 2, good.size() - 1}) {
    EXPECT_EQ(message(good.substr(0, size)), "map file 'x.map' is truncated: save or copy it anew");
  }
  std::string other_version = good;
  other_version[8] = 9;
  EXPECT_EQ(message(other_version),
            "map file 'x.map' has format version 9, this program reads 2: save it anew with this program");
  std::string flipped = good;
  flipped[good.size() / 2] ^= 1;
  const std::string damaged = "map file 'x.map' is damaged: its checksum does not fit; save or copy it anew";
  EXPECT_EQ(message(flipped), damaged);
  EXPECT_EQ(message(good + "x"), damaged);
  EXPECT_EQ(map.keyframes().size(), 5U);
  EXPECT_EQ(serializeMap(map), good);
}

TEST(MapFile, ContentThatContradictsItselfIsRefusedEvenWithAFittingChecksum) {
  const Map good = makeMap();
  const auto messageFor = [&good](std::map<KeyframeId, Keyframe> keyframes) {
    Map broken, map;
    broken.restore(std::move(keyframes), {}, good.nextKeyframe(), good.nextLandmark());
    return messageOf([&] { parseMap(serializeMap(broken), "x.map", map); });
  };
  const std::string contradiction = "map file 'x.map' is damaged: its content contradicts itself; save it anew";
  std::map<KeyframeId, Keyframe> without_first = good.keyframes();
  without_first.erase(KeyframeId(0));  // keyframe 5 names it as a loop
  EXPECT_EQ(messageFor(without_first), contradiction);
  std::map<KeyframeId, Keyframe> circle = good.keyframes();
  circle.at(KeyframeId(0)).parent = KeyframeId(5);  // whose parents lead back to it
  EXPECT_EQ(messageFor(circle), contradiction);
}

TEST(MapFile, ValuesThatCannotBeAreRefusedEvenWithAFittingChecksum) {
  const Map good = makeMap();
  const auto messageFor = [&good](const std::function<void(Keyframe&, Landmark&)>& spoil,
                                  std::uint64_t next_keyframe = 0) {
    std::map<KeyframeId, Keyframe> keyframes = good.keyframes();
    std::unordered_map<LandmarkId, Landmark> landmarks = good.landmarks();
    spoil(keyframes.begin()->second, landmarks.begin()->second);
    Map broken, map;
    broken.restore(std::move(keyframes), std::move(landmarks), std::max(next_keyframe, good.nextKeyframe()),
                   good.nextLandmark());
    return messageOf([&] { parseMap(serializeMap(broken), "x.map", map); });
  };
  EXPECT_EQ(messageFor([](Keyframe&, Landmark&) {}), "no error");
  const std::string contradiction = "map file 'x.map' is damaged: its content contradicts itself; save it anew";
  EXPECT_EQ(messageFor([](Keyframe&, Landmark&) {}, ~std::uint64_t{0}), contradiction) << "no id is left";
  const double kNan = std::numeric_limits<double>::quiet_NaN();
  for (const double wrong : {kNan, 1e300, -1e300}) {
    EXPECT_EQ(messageFor([&](Keyframe& k, Landmark&) { k.T_camera_world.translation().y() = wrong; }), contradiction);
    EXPECT_EQ(messageFor([&](Keyframe& k, Landmark&) { k.T_camera_world.linear()(1, 1) = wrong; }), contradiction);
    EXPECT_EQ(messageFor([&](Keyframe&, Landmark& l) { l.position_world.x() = wrong; }), contradiction);
  }
  EXPECT_EQ(messageFor([&](Keyframe&, Landmark& l) { l.max_distance_m = kNan; }), contradiction);
  EXPECT_EQ(messageFor([&](Keyframe&, Landmark& l) { l.found_count = -1; }), contradiction);
}

TEST(MapFile, AFolderOrAPipeIsNoMapFile) {
  Map map;
  EXPECT_EQ(messageOf([&] { loadMap(testing::TempDir(), map); }),
            "map file '" + testing::TempDir() + "' is a folder; name a file");
  const std::string pipe = testing::TempDir() + "map_file_test.pipe";
  ASSERT_EQ(mkfifo(pipe.c_str(), 0600), 0);
  EXPECT_EQ(messageOf([&] { loadMap(pipe, map); }), "map file '" + pipe + "' is no regular file; name a file");
  std::remove(pipe.c_str());
}

TEST(MapFile, SavesAndLoadsByPathAndNamesWhatIsMissing) {
  const Map map = makeMap();
  const std::string path = testing::TempDir() + "map_file_test.map";
  saveMap(path, map);
  Map loaded;
  loadMap(path, loaded);
  expectSameMap(map, loaded);
  std::remove(path.c_str());
  EXPECT_EQ(messageOf([&] { loadMap(path, loaded); }),
            "map file '" + path + "' cannot be opened: No such file or directory");
  EXPECT_NE(messageOf([&] { saveMap("/nonexistent/folder/x.map", map); }), "no error");
}

TEST(MapFile, IndexOfALoadedMapFindsItsKeyframes) {
  const Map map = makeMap();
  PlaceIndex index;
  indexKeyframes(map, index);
  EXPECT_EQ(index.size(), map.keyframes().size());
  const auto matches = index.query(*map.keyframe(KeyframeId(4))->features, 1);
  ASSERT_EQ(matches.size(), 1U);
  EXPECT_EQ(matches[0].keyframe, KeyframeId(4));
}

}  // namespace
}  // namespace semantic_vslam
