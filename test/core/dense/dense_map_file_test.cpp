// SPDX-FileCopyrightText: 2026 The semantic_vslam authors
// SPDX-License-Identifier: BSD-3-Clause
#include "core/dense/dense_map_file.h"

#include <gtest/gtest.h>

#include <fstream>

#include "core/dense/dense_mapper.h"
#include "core/support/fixtures.h"
#include "semantic_vslam/core/common/error.h"

namespace semantic_vslam {
namespace {

/// A wall, seen by a few keyframes that move sideways.
DenseMapper wallMap() {
  DenseMapper mapper(DenseConfig(), officeLabels());
  for (int i = 0; i < 4; ++i) {
    RgbdFrame frame = frameOf(cv::Mat1f(96, 128, 2.0F));
    frame.stamp = Stamp::fromSeconds(10.0 + i);
    const cv::Mat1b labels(frame.gray.size(), static_cast<std::uint8_t>(i % 2 == 0 ? 2 : 0));
    SE3 T = SE3::Identity();
    T.translation().x() = 0.1 * i;
    EXPECT_TRUE(mapper.add(KeyframeId(3 + i), frame, labels, {}, T));
    EXPECT_TRUE(mapper.look(KeyframeId(3 + i), frame, labels, {}, T));
  }
  return mapper;
}

std::string messageOf(const std::function<void()>& run) {
  try {
    run();
  } catch (const FileError& error) {
    return error.what();
  }
  return "no error";
}

TEST(DenseMapFile, AMapComesBackAsItWas) {
  const DenseMapper before = wallMap();
  const std::string bytes = serializeDenseMap(before.content(7));
  DenseMapContent content = parseDenseMap(bytes, "map.dense");
  EXPECT_EQ(content.map_id, 7U);
  EXPECT_EQ(content.labels.classes, officeLabels().classes);
  EXPECT_EQ(serializeDenseMap(content), bytes);

  DenseMapper after(DenseConfig(), content.labels);
  after.restore(std::move(content.keyframes));
  ASSERT_GT(before.voxels(), 100U);
  EXPECT_EQ(after.voxels(), before.voxels());
  EXPECT_EQ(after.keyframes(), before.keyframes());
  EXPECT_EQ(after.memoryBytes(), before.memoryBytes());
  const std::vector<LabelledPoint> a = before.cloud(), b = after.cloud();
  ASSERT_EQ(a.size(), b.size());
  for (std::size_t i = 0; i < a.size(); ++i) {
    EXPECT_EQ(a[i].xyz_m, b[i].xyz_m);
    EXPECT_EQ(a[i].bgr, b[i].bgr);
    EXPECT_EQ(a[i].label, b[i].label);
  }
  EXPECT_EQ(before.fullOctree().data, after.fullOctree().data);
  EXPECT_EQ(before.projectedMap(SE3::Identity()).cells, after.projectedMap(SE3::Identity()).cells);
}

TEST(DenseMapFile, ALaterLoopMovesWhatCameBack) {
  DenseMapper mapper(DenseConfig(), officeLabels());
  mapper.restore(wallMap().content(1).keyframes);
  SE3 T = SE3::Identity();
  T.translation().z() = 1.0;
  std::vector<KeyframePose> poses;
  for (int i = 0; i < 4; ++i) {
    T.translation().x() = 0.1 * i;
    poses.push_back({KeyframeId(3 + i), Stamp::fromSeconds(10.0 + i), T});
  }
  mapper.updatePoses(poses);
  mapper.finish();
  for (const LabelledPoint& point : mapper.cloud()) EXPECT_NEAR(point.xyz_m[2], 3.0F, 0.05F);
}

TEST(DenseMapFile, WhatIsNoMapIsRefusedInOneLine) {
  const std::string good = serializeDenseMap(wallMap().content(7));
  EXPECT_EQ(messageOf([&] { parseDenseMap("hello", "x"); }), "'x' is no dense map file of semantic_vslam");
  EXPECT_EQ(messageOf([&] { parseDenseMap(good.substr(0, good.size() - 9), "x"); }),
            "dense map file 'x' is truncated: save or copy it anew");
  std::string bad = good;
  bad[good.size() / 2] ^= 1;
  EXPECT_EQ(messageOf([&] { parseDenseMap(bad, "x"); }),
            "dense map file 'x' is damaged: its checksum does not fit; save or copy it anew");
  bad = good;
  bad[8] = 9;
  EXPECT_NE(messageOf([&] { parseDenseMap(bad, "x"); }).find("has format version 9"), std::string::npos);
  EXPECT_NE(messageOf([&] { readDenseMap("/nowhere/map.dense"); }).find("'/nowhere/map.dense'"), std::string::npos);
}

TEST(DenseMapFile, ContentThatCannotBeIsRefusedThoughItsChecksumFits) {
  const auto refused = [](const std::function<void(DenseMapContent&)>& spoil) {
    DenseMapContent content = wallMap().content(7);
    spoil(content);
    const std::string bytes = serializeDenseMap(content);
    return messageOf([&] { parseDenseMap(bytes, "x"); }) ==
           "dense map file 'x' is damaged: its content contradicts itself; save it anew";
  };
  EXPECT_FALSE(refused([](DenseMapContent&) {}));
  EXPECT_TRUE(refused([](DenseMapContent& c) { c.keyframes[0].T_world_camera.translation().x() = NAN; }));
  EXPECT_TRUE(refused([](DenseMapContent& c) { c.keyframes[0].T_world_camera.linear() *= 2.0; }));
  EXPECT_TRUE(refused([](DenseMapContent& c) { c.keyframes[0].cloud.points[5].label = 200; }));
  EXPECT_TRUE(refused([](DenseMapContent& c) { c.keyframes[0].cloud.points[5].xyz_m[1] = INFINITY; }));
  EXPECT_TRUE(refused([](DenseMapContent& c) { std::swap(c.keyframes[0], c.keyframes[1]); }));
  EXPECT_TRUE(refused([](DenseMapContent& c) { c.keyframes[0].view.fx_cells = 0.0; }));
  EXPECT_TRUE(refused([](DenseMapContent& c) { c.labels.classes.clear(); }));
}

}  // namespace
}  // namespace semantic_vslam
