// SPDX-FileCopyrightText: 2026 The semantic_vslam authors
// SPDX-License-Identifier: BSD-3-Clause
#include "core/common/arguments.h"

#include <gtest/gtest.h>

namespace semantic_vslam {
namespace {

Arguments parse(std::vector<const char*> words, Arguments::Positionals positionals = {1, 1}) {
  words.insert(words.begin(), "tool");
  return Arguments(static_cast<int>(words.size()), words.data(), {"--out", "--set", "--delta"}, {"--json"},
                   positionals);
}

int run(std::vector<const char*> words, const std::function<int()>& body) {
  words.insert(words.begin(), "/usr/bin/tool");
  return runTool(static_cast<int>(words.size()), words.data(), "the usage\n", body);
}

TEST(Arguments, OptionsMayStandAnywhereAndRepeat) {
  const Arguments arguments = parse({"--set", "a=1", "file", "--json", "--set=b=2", "--out", "x"});
  EXPECT_EQ(arguments.positional(), std::vector<std::string>{"file"});
  EXPECT_TRUE(arguments.has("--json"));
  EXPECT_EQ(arguments.values("--set"), (std::vector<std::string>{"a=1", "b=2"}));
  EXPECT_EQ(arguments.value("--out"), "x");
  EXPECT_FALSE(arguments.value("--delta").has_value());
}

TEST(Arguments, NumbersAreCheckedAndHaveDefaults) {
  EXPECT_DOUBLE_EQ(parse({"f"}).positiveNumber("--delta", 1.5), 1.5);
  EXPECT_DOUBLE_EQ(parse({"f", "--delta", "0.02"}).positiveNumber("--delta", 1.5), 0.02);
  EXPECT_EQ(parse({"f", "--delta", "12"}).count("--delta", 0), 12U);
  for (const char* wrong : {"", "0", "-1", "nan", "inf", "1s"}) {
    EXPECT_THROW(parse({"f", "--delta", wrong}).positiveNumber("--delta", 1.0), UsageError) << wrong;
  }
  for (const char* wrong : {"", "-1", "1.5", "99999999999"}) {
    EXPECT_THROW(parse({"f", "--delta", wrong}).count("--delta", 1), UsageError) << wrong;
  }
}

TEST(Arguments, CountHasALeastValue) {
  EXPECT_EQ(parse({"f", "--delta", "1"}).count("--delta", 5, 1), 1U);
  EXPECT_EQ(parse({"f"}).count("--delta", 0, 1), 0U);  // what was not given is not judged
  try {
    parse({"f", "--delta", "0"}).count("--delta", 5, 1);
    FAIL();
  } catch (const UsageError& error) {
    EXPECT_STREQ(error.what(), "option --delta is '0', must be a whole number from 1");
  }
}

TEST(Arguments, PositionalsMayBeLeftOutWithinBounds) {
  EXPECT_TRUE(parse({"--json"}, {0, 1}).positional().empty());
  EXPECT_EQ(parse({"--json", "f"}, {0, 1}).positional().size(), 1U);
  try {
    parse({"f", "g"}, {0, 1});
    FAIL();
  } catch (const UsageError& error) {
    EXPECT_STREQ(error.what(), "expected 0 to 1 argument besides the options, got 2");
  }
}

TEST(Arguments, WhatDoesNotFitIsNamed) {
  EXPECT_THROW(parse({"f", "--typo"}), UsageError);
  EXPECT_THROW(parse({"f", "--out"}), UsageError);
  EXPECT_THROW(parse({"f", "--json=1"}), UsageError);
  EXPECT_THROW(parse({}), UsageError);
  EXPECT_THROW(parse({"f", "g"}), UsageError);
  try {
    parse({"f", "--typo", "1"});
  } catch (const UsageError& error) {
    EXPECT_STREQ(error.what(), "unknown option --typo");
  }
}

TEST(RunTool, GivesExitCodesAndOneLinePerError) {
  EXPECT_EQ(run({}, [] { return 7; }), 7);
  testing::internal::CaptureStderr();
  EXPECT_EQ(run({}, []() -> int { throw FileError("'x' is missing"); }), 1);
  EXPECT_EQ(testing::internal::GetCapturedStderr(), "tool: 'x' is missing\n");
  testing::internal::CaptureStderr();
  EXPECT_EQ(run({}, []() -> int { throw UsageError("unknown option --x"); }), 2);
  EXPECT_EQ(testing::internal::GetCapturedStderr(), "tool: unknown option --x; --help shows the usage\n");
  testing::internal::CaptureStdout();
  EXPECT_EQ(run({"--help"}, [] { return 7; }), 0);
  EXPECT_EQ(testing::internal::GetCapturedStdout(), "the usage\n");
}

}  // namespace
}  // namespace semantic_vslam
