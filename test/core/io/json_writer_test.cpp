// SPDX-FileCopyrightText: 2026 The semantic_vslam authors
// SPDX-License-Identifier: BSD-3-Clause
#include "core/io/json_writer.h"

#include <gtest/gtest.h>

#include <limits>

namespace semantic_vslam {
namespace {

TEST(JsonWriter, WritesNestedObjectsInOrder) {
  JsonWriter json;
  json.field("frames", std::uint64_t{250});
  json.field("ate", 0.0125);
  json.beginObject("stages");
  json.beginObject("empty");
  json.endObject();
  json.field("on", true);
  json.endObject();
  json.field("name", "a \"b\"\n\\");
  EXPECT_EQ(json.finish(),
            "{\n  \"frames\": 250,\n  \"ate\": 0.0125,\n  \"stages\": {\n    \"empty\": {},\n    \"on\": true\n  },\n"
            "  \"name\": \"a \\\"b\\\"\\u000a\\\\\"\n}\n");
}

TEST(JsonWriter, NumbersThatJsonLacksBecomeNull) {
  JsonWriter json;
  json.field("nan", std::numeric_limits<double>::quiet_NaN());
  json.field("inf", std::numeric_limits<double>::infinity());
  json.null("none");
  EXPECT_EQ(json.finish(), "{\n  \"nan\": null,\n  \"inf\": null,\n  \"none\": null\n}\n");
}

TEST(JsonWriter, ArraysStandOnOneLine) {
  JsonWriter json;
  json.field("share", std::vector<double>{0.25, std::numeric_limits<double>::quiet_NaN(), 1.0});
  json.field("model", std::vector<std::string>{"none", "a \"b\""});
  json.field("empty", std::vector<double>{});
  EXPECT_EQ(json.finish(),
            "{\n  \"share\": [0.25, null, 1],\n  \"model\": [\"none\", \"a \\\"b\\\"\"],\n  \"empty\": []\n}\n");
}

}  // namespace
}  // namespace semantic_vslam
