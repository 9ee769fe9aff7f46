// SPDX-FileCopyrightText: 2026 The semantic_vslam authors
// SPDX-License-Identifier: BSD-3-Clause
#include "core/segmentation/segmentation_stage.h"

#include <opencv2/imgcodecs.hpp>
#include <opencv2/imgproc.hpp>

#include "core/support/fixtures.h"
#include "semantic_vslam/core/common/config_fields.h"
#include "semantic_vslam/core/common/log.h"

namespace semantic_vslam {
namespace {

const cv::Rect kBox(20, 20, 30, 40);

/// Says that a person stands in kBox, 5 px too large; fails when asked to.
class FixedSegmenter : public Segmenter {
 public:
  explicit FixedSegmenter(bool* fail) : fail_(fail) {}
  const LabelSet& labels() const override { return labels_; }
  Segmentation segment(const cv::Mat3b& bgr) override {
    if (*fail_) throw ModelError("network 'fixed' fails");
    cv::Mat1b labels(bgr.size(), std::uint8_t{0});
    labels(cv::Rect(kBox.x - 5, kBox.y - 5, kBox.width + 10, kBox.height + 10)).setTo(1);
    return {labels};
  }

 private:
  bool* fail_;
  LabelSet labels_ = officeLabels();
};

RgbdFrame personBeforeWall() {
  cv::Mat1f depth(100, 80, 3.0F);
  depth(kBox).setTo(1.0F);
  return frameOf(depth);
}

TEST(SegmentationStage, RefinesWhatTheNetworkSays) {
  bool fail = false;
  SegmentationConfig config;
  config.refinement.stride_px = 1;
  SegmentationStage stage(config, std::make_unique<FixedSegmenter>(&fail));
  EXPECT_TRUE(stage.enabled());
  EXPECT_EQ(stage.labels().size(), 4U);
  const cv::Mat1b labels = stage.process(personBeforeWall());
  EXPECT_EQ(cv::countNonZero(labels), kBox.area());
  EXPECT_EQ(cv::countNonZero(labels(kBox) == 1), kBox.area());
}

TEST(SegmentationStage, WithoutANetworkSaysSoOnceAndGivesNoLabels) {
  std::vector<std::string> messages;
  setLogSink([&messages](LogLevel, const std::string& message) { messages.push_back(message); });
  SegmentationConfig config;
  config.model.clear();
  SegmentationStage stage(config);
  EXPECT_FALSE(stage.enabled());
  EXPECT_EQ(stage.labels().size(), 1U);
  EXPECT_TRUE(stage.process(personBeforeWall()).empty());
  EXPECT_TRUE(stage.process(personBeforeWall()).empty());
  setLogSink({});
  ASSERT_EQ(messages.size(), 1U);
  EXPECT_NE(messages[0].find("no semantic network"), std::string::npos);
}

TEST(SegmentationStage, GoesOnWithoutLabelsWhenTheNetworkFails) {
  std::vector<std::string> messages;
  setLogSink([&messages](LogLevel, const std::string& message) { messages.push_back(message); });
  bool fail = false;
  SegmentationStage stage({}, std::make_unique<FixedSegmenter>(&fail));
  EXPECT_FALSE(stage.process(personBeforeWall()).empty());
  fail = true;
  EXPECT_TRUE(stage.process(personBeforeWall()).empty());
  EXPECT_TRUE(stage.process(personBeforeWall()).empty());
  setLogSink({});
  EXPECT_FALSE(stage.enabled());
  EXPECT_EQ(stage.labels().size(), 4U);  // labels already given keep their meaning
  EXPECT_EQ(messages.size(), 1U);
}

TEST(SegmentationStage, RunsThePackagesNetworkUnlessToldOtherwise) {
  const SegmentationStage stage{SegmentationConfig()};
  EXPECT_TRUE(stage.enabled());
  EXPECT_EQ(stage.labels().size(), 11U);
}

TEST(SegmentationStage, RefusesANetworkThatIsNotThere) {
  SegmentationConfig config;
  config.model = "/nowhere/net.onnx";
  EXPECT_NE(modelError([&] { SegmentationStage stage(config); }).find("'/nowhere/net.onnx' is no file"),
            std::string::npos);
}

TEST(SegmentationConfig, IsDescribed) {
  SegmentationConfig config;
  setConfig(config, "refinement.epsilon", "3.5");
  EXPECT_EQ(config.refinement.epsilon, 3.5);
  EXPECT_THROW(setConfig(config, "provider", "tpu"), ConfigError);
}

}  // namespace
}  // namespace semantic_vslam
