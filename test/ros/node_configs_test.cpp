// SPDX-FileCopyrightText: 2026 The semantic_vslam authors
// SPDX-License-Identifier: BSD-3-Clause
#include "ros/node_configs.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <map>
#include <regex>
#include <string>

#include "semantic_vslam/core/common/error.h"

namespace semantic_vslam {
namespace {

namespace fs = std::filesystem;

class NodeConfigs : public ::testing::Test {
 protected:
  std::string write(const std::string& text) {
    std::ofstream(path_) << text;
    return path_;
  }
  std::string refusal(const std::string& text) {
    try {
      readConfigFileFor(listConfig(MotionNodeConfig()), write(text));
    } catch (const ConfigError& error) {
      return error.what();
    }
    return "";
  }
  void TearDown() override { fs::remove(path_); }
  const std::string path_ = ::testing::TempDir() + "node_configs_test.yaml";
};

TEST_F(NodeConfigs, OneFileHoldsKeysOfAllNodesAndEachTakesItsOwn) {
  const std::string path = write(
      "input: {max_interval_s: 0.03}\nframes: {map_frame: world, tf_wait_s: 0.2}\npeople.keep_s: 3\nlabels_wait_s: 4\n"
      "budget_ms: {motion: 20, mapping: 5000}\nobjects.min_points: 7\nsegmentation.threads: 2\nmotion.model: none\n");
  MotionNodeConfig motion;
  TrackingNodeConfig tracking;
  SegmentationNodeConfig segmentation;
  MappingNodeConfig mapping;
  SystemConfig offline;
  loadSharedConfigFile(motion, path);
  loadSharedConfigFile(tracking, path);
  loadSharedConfigFile(segmentation, path);
  loadSharedConfigFile(mapping, path);
  loadSharedConfigFile(offline, path);
  for (const double s : {motion.input.max_interval_s, tracking.input.max_interval_s,
                         segmentation.images.input.max_interval_s, mapping.images.input.max_interval_s}) {
    EXPECT_DOUBLE_EQ(s, 0.03);
  }
  EXPECT_EQ(tracking.frames.map_frame, "world");
  EXPECT_EQ(mapping.frames.map_frame, "world");
  EXPECT_DOUBLE_EQ(tracking.frames.tf_wait_s, 0.2);
  EXPECT_DOUBLE_EQ(tracking.people.keep_s, 3.0);
  EXPECT_DOUBLE_EQ(mapping.inputs.labels_wait_s, 4.0);
  EXPECT_DOUBLE_EQ(motion.budget_ms, 20.0);
  EXPECT_DOUBLE_EQ(mapping.budget_ms, 5000.0);
  EXPECT_DOUBLE_EQ(tracking.budget_ms, TrackingNodeConfig().budget_ms);
  EXPECT_EQ(mapping.objects.min_points, 7);
  EXPECT_EQ(segmentation.segmentation.threads, 2);
  EXPECT_EQ(offline.segmentation.threads, 2);
  EXPECT_EQ(motion.motion.model, "none");
  EXPECT_EQ(offline.motion.model, "none");
}

TEST_F(NodeConfigs, AKeyThatNobodyHasIsNamedWithTheFileAndTheOneThatWasMeant) {
  const std::string slip = refusal("input: {max_intervall_s: 0.03}\n");
  EXPECT_NE(slip.find(path_), std::string::npos) << slip;
  EXPECT_NE(slip.find("'input.max_intervall_s'; did you mean input.max_interval_s?"), std::string::npos) << slip;
  const std::string group = refusal("frame: {tf_wait_s: 0.2}\n");
  EXPECT_NE(group.find("did you mean frames.tf_wait_s?"), std::string::npos) << group;
  EXPECT_NE(refusal("quite: {another: thing}\n").find("--list-config"), std::string::npos);
}

TEST_F(NodeConfigs, AValueOutOfRangeIsRefusedByTheNodesThatDoNotTakeIt) {
  const std::string message = refusal("people: {radius_m: 7}\n");
  EXPECT_NE(message.find("'people.radius_m' is 7, must be in [0.1, 1]"), std::string::npos) << message;
}

TEST_F(NodeConfigs, AKeyMeansTheSameInEveryNode) {
  std::map<std::string, ConfigEntry> first;
  for (const ConfigEntry& entry : listConfig(AnyConfig())) {
    const auto [known, is_new] = first.emplace(entry.key, entry);
    EXPECT_EQ(known->second.value, entry.value) << entry.key;
    EXPECT_EQ(known->second.bounds, entry.bounds) << entry.key;
    EXPECT_EQ(known->second.documentation, entry.documentation) << entry.key;
  }
}

TEST_F(NodeConfigs, EveryKeyOfOfflineRunsIsANodesToo) {
  const auto entries = listConfig(AnyConfig());
  const std::size_t offline = listConfig(SystemConfig()).size();
  for (std::size_t i = 0; i < offline; ++i) {
    const std::string& key = entries[i].key;
    if (key == "label_delay_s") continue;  // for measurements
    EXPECT_TRUE(std::any_of(entries.begin() + static_cast<std::ptrdiff_t>(offline), entries.end(),
                            [&](const ConfigEntry& entry) { return entry.key == key; }))
        << key;
  }
}

TEST_F(NodeConfigs, FilesToBeginWithHoldTheDefaults) {
  const std::map<std::string, std::string> defaults = [] {
    std::map<std::string, std::string> values;
    for (const ConfigEntry& entry : listConfig(AnyConfig())) values.emplace(entry.key, entry.value);
    return values;
  }();
  int files = 0;
  for (const auto& file : fs::directory_iterator("cfg/params")) {
    ASSERT_EQ(file.path().extension(), ".yaml");
    ++files;
    EXPECT_TRUE(readConfigFile(file.path()).empty()) << "as it is it changes nothing";
    std::ifstream in(file.path());
    const std::string text((std::istreambuf_iterator<char>(in)), std::istreambuf_iterator<char>());
    const std::string uncommented = std::regex_replace(text, std::regex("(^|\n)#([a-z_.]+: )"), "$1$2");
    const auto entries = readConfigFile(write(uncommented));
    EXPECT_GT(entries.size(), 40U);
    const std::regex key_line("(^|\n)#[^ \n]");
    EXPECT_EQ(static_cast<std::ptrdiff_t>(entries.size()),
              std::distance(std::sregex_iterator(text.begin(), text.end(), key_line), std::sregex_iterator()))
        << "each line that is no comment is a key";
    AnyConfig config;
    for (const auto& [key, value] : entries) setConfig(config, key, value);
    for (const ConfigEntry& entry : listConfig(config)) EXPECT_EQ(entry.value, defaults.at(entry.key)) << entry.key;
  }
  EXPECT_GT(files, 0);
}

}  // namespace
}  // namespace semantic_vslam
