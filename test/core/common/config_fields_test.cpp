// SPDX-FileCopyrightText: 2026 The semantic_vslam authors
// SPDX-License-Identifier: BSD-3-Clause
#include "semantic_vslam/core/common/config_fields.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cstdio>
#include <fstream>

#include "semantic_vslam/core/common/error.h"

namespace semantic_vslam {
namespace {

struct Inner {
  double radius_px = 3.0;
  template <class Visitor>
  void visit(Visitor& v) {
    v.field("radius_px", radius_px, 1.0, 10.0, "search radius, px");
  }
};

struct Outer {
  int count = 5;
  bool on = true;
  std::string kind = "a";
  std::string file;
  Inner inner;
  template <class Visitor>
  void visit(Visitor& v) {
    v.field("count", count, 1, 9, "how many");
    v.flag("on", on, "whether");
    v.choice("kind", kind, {"a", "b"}, "which");
    v.text("file", file, "where");
    v.group("inner", inner);
  }
};

std::string messageOf(const std::string& key, const std::string& value) {
  Outer config;
  try {
    setConfig(config, key, value);
  } catch (const ConfigError& error) {
    return error.what();
  }
  return "";
}

TEST(ConfigFields, KeysOfRenamedGroupsSayTheirNewName) {
  EXPECT_NE(messageOf("local_ba.min_shared", "1").find("'bundle_adjustment.min_shared'"), std::string::npos);
  EXPECT_NE(messageOf("mapping.fuse_radius_px", "1").find("'sparse_map.fuse_radius_px'"), std::string::npos);
}

TEST(ConfigFields, SetsNestedKeysByDottedName) {
  Outer config;
  setConfig(config, "inner.radius_px", "4.5");
  setConfig(config, "count", "7");
  setConfig(config, "on", "false");
  setConfig(config, "kind", "b");
  EXPECT_DOUBLE_EQ(config.inner.radius_px, 4.5);
  EXPECT_EQ(config.count, 7);
  EXPECT_FALSE(config.on);
  EXPECT_EQ(config.kind, "b");
}

TEST(ConfigFields, RefusesByNameBoundAndValue) {
  EXPECT_EQ(messageOf("inner.radius_px", "11"), "configuration key 'inner.radius_px' is 11, must be in [1, 10]");
  EXPECT_EQ(messageOf("kind", "c"), "configuration key 'kind' is 'c', must be one of a, b");
  EXPECT_EQ(messageOf("count", "2.5"), "configuration key 'count' is '2.5', must be a whole number");
  EXPECT_EQ(messageOf("inner.radius_px", "nan"),
            "configuration key 'inner.radius_px' is 'nan', must be a finite number");
}

TEST(ConfigFields, UnknownKeySuggestsTheOneOfTheSameName) {
  EXPECT_EQ(messageOf("radius_px", "2"), "unknown configuration key 'radius_px'; did you mean inner.radius_px?");
  EXPECT_NE(messageOf("nonsense", "2").find("unknown configuration key 'nonsense'"), std::string::npos);
}

TEST(ConfigFields, ASlipOfThePenSuggestsTheNearestKey) {
  EXPECT_EQ(messageOf("cuont", "2"), "unknown configuration key 'cuont'; --list-config prints all keys")
      << "short words are all alike";
  EXPECT_EQ(messageOf("inner.radius_pxl", "2"),
            "unknown configuration key 'inner.radius_pxl'; did you mean inner.radius_px?");
  EXPECT_EQ(messageOf("inner.raduis_px", "2"),
            "unknown configuration key 'inner.raduis_px'; did you mean inner.radius_px?");
}

TEST(ConfigFields, ATableHoldsALineForEachKey) {
  const std::string table = describe(listConfig(Outer()));
  EXPECT_EQ(std::count(table.begin(), table.end(), '\n'), 5);
  EXPECT_NE(table.find("kind                                          a              a|b  which\n"), std::string::npos);
  EXPECT_NE(table.find("file                                          \"\"             where\n"), std::string::npos);
}

TEST(ConfigFields, ARefusedValueChangesNothing) {
  Outer config;
  EXPECT_THROW(setConfig(config, "count", "100"), ConfigError);
  EXPECT_EQ(config.count, 5);
}

TEST(ConfigFields, ValidationFindsValuesSetInCode) {
  Outer config;
  EXPECT_NO_THROW(validateConfig(config));
  config.inner.radius_px = 0.0;
  EXPECT_THROW(validateConfig(config), ConfigError);
}

TEST(ConfigFields, ListHoldsEveryKeyWithValueAndBounds) {
  const auto entries = listConfig(Outer());
  ASSERT_EQ(entries.size(), 5U);
  EXPECT_EQ(entries[4].key, "inner.radius_px");
  EXPECT_EQ(entries[4].value, "3");
  EXPECT_EQ(entries[4].bounds, "[1, 10]");
}

class ConfigFile : public ::testing::Test {
 protected:
  void write(const std::string& text) { std::ofstream(path_) << text; }
  void TearDown() override { std::remove(path_.c_str()); }
  const std::string path_ = ::testing::TempDir() + "config_fields_test.yaml";
};

TEST_F(ConfigFile, NestedMapsBecomeDottedKeys) {
  write("count: 3\ninner:\n  radius_px: 2\n");
  Outer config;
  loadConfigFile(config, path_);
  EXPECT_EQ(config.count, 3);
  EXPECT_DOUBLE_EQ(config.inner.radius_px, 2.0);
}

TEST_F(ConfigFile, BadFilesAreNamed) {
  Outer config;
  EXPECT_THROW(loadConfigFile(config, "/no/such/file.yaml"), FileError);
  write("count: [1, 2]\n");
  EXPECT_THROW(loadConfigFile(config, path_), FileError);
  write("count: {{{\n");
  EXPECT_THROW(loadConfigFile(config, path_), FileError);
}

}  // namespace
}  // namespace semantic_vslam
