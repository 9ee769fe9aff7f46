// SPDX-FileCopyrightText: 2026 The semantic_vslam authors
// SPDX-License-Identifier: BSD-3-Clause
#include "core/segmentation/onnx_segmenter.h"

#include <opencv2/imgcodecs.hpp>
#include <opencv2/imgproc.hpp>

#include "core/support/fixtures.h"

namespace semantic_vslam {
namespace {

const char* const kLogits = R"(
input: {width: 48, height: 32, layout: nchw, type: float32, channels: rgb, resize: stretch}
output: {kind: logits, layout: nchw, stride: 8}
classes: [red, green, blue]
labels:
  - {name: green, mobility: movable}
  - {name: blue, mobility: person}
)";

const char* const kLabels = R"(
input: {width: 48, height: 32, layout: nhwc, type: uint8, channels: rgb, resize: stretch}
output: {kind: labels, stride: 1}
classes: [dark, bright]
labels: [{name: bright, mobility: static}]
)";

SegmentationConfig configOf(const std::string& model, const std::string& sidecar_text) {
  SegmentationConfig config;
  config.model = tinyModel(model);
  config.sidecar = writeText(model + ".yaml", sidecar_text);
  return config;
}

std::string errorOf(const std::string& model, const std::string& sidecar_text) {
  return modelError([&] { makeOnnxSegmenter(configOf(model, sidecar_text)); });
}

/// Left third red, middle green, right blue.
cv::Mat3b threeColours(cv::Size size) {
  cv::Mat3b bgr(size, cv::Vec3b(0, 200, 0));
  bgr.colRange(0, size.width / 3).setTo(cv::Scalar(0, 0, 200));
  bgr.colRange(2 * size.width / 3, size.width).setTo(cv::Scalar(200, 0, 0));
  return bgr;
}

TEST(OnnxSegmenter, LabelsByLogitsAtTheImagesOwnSize) {
  const auto segmenter = makeOnnxSegmenter(configOf("tiny_logits.onnx", kLogits));
  const cv::Mat1b labels = segmenter->segment(threeColours({480, 320})).labels;
  ASSERT_EQ(labels.size(), cv::Size(480, 320));
  EXPECT_EQ(labels(160, 80), 0);                        // red is nothing we know
  EXPECT_EQ(labels(160, 240), 1);                       // green
  EXPECT_EQ(labels(160, 400), 2);                       // blue
  EXPECT_EQ(cv::countNonZero(labels == 1), 320 * 160);  // the borders lie where the colours change
  EXPECT_EQ(segmenter->labels().classes[2].name, "blue");
}

TEST(OnnxSegmenter, LabelsByLabels) {
  const auto segmenter = makeOnnxSegmenter(configOf("tiny_labels.onnx", kLabels));
  const cv::Mat1b labels = segmenter->segment(threeColours({96, 64})).labels;
  EXPECT_EQ(cv::countNonZero(labels == 1), 64 * 32);  // only red has a bright first channel
  EXPECT_EQ(labels(30, 10), 1);
}

TEST(OnnxSegmenter, GivesTheSameLabelsTwice) {
  const auto segmenter = makeOnnxSegmenter(configOf("tiny_logits.onnx", kLogits));
  const cv::Mat1b first = segmenter->segment(threeColours({100, 70})).labels.clone();
  segmenter->segment(cv::Mat3b(64, 64, cv::Vec3b(1, 2, 3)));
  EXPECT_EQ(cv::countNonZero(first != segmenter->segment(threeColours({100, 70})).labels), 0);
}

TEST(OnnxSegmenter, FallsBackToTheCpu) {
  SegmentationConfig config = configOf("tiny_logits.onnx", kLogits);
  config.provider = "cuda";
  EXPECT_EQ(makeOnnxSegmenter(config)->segment(threeColours({48, 32})).labels(16, 24), 1);
}

TEST(OnnxSegmenter, RunsTheUsualExportOfACocoNetwork) {
  std::string sidecar = readText("models/sidecars/bisenetv2_coco.yaml");
  sidecar = replaced(replaced(sidecar, "width: 640", "width: 64"), "height: 640", "height: 64");
  const auto segmenter = makeOnnxSegmenter(configOf("bisenetv2_coco.onnx", sidecar));
  cv::Mat3b noise(48, 64);
  cv::RNG rng(5);
  rng.fill(noise, cv::RNG::UNIFORM, 0, 256);
  const cv::Mat1b labels = segmenter->segment(noise).labels;
  EXPECT_EQ(labels.size(), noise.size());
  double largest = 0.0;
  cv::minMaxLoc(labels, nullptr, &largest);
  EXPECT_LT(largest, segmenter->labels().size());
}

TEST(OnnxSegmenter, SaysInOneLineWhatDoesNotFit) {
  EXPECT_NE(errorOf("no_such.onnx", kLogits).find("no_such.onnx' is no file"), std::string::npos);
  EXPECT_NE(errorOf("tiny_logits.onnx", replaced(kLogits, "width: 48", "width: 64"))
                .find("takes an input of 1x3x32x48 but the sidecar's input says 1x3x32x64"),
            std::string::npos);
  EXPECT_NE(errorOf("tiny_logits.onnx", replaced(kLogits, "layout: nchw, type", "layout: nhwc, type"))
                .find("but the sidecar's input says 1x32x48x3"),
            std::string::npos);
  EXPECT_NE(errorOf("tiny_logits.onnx", replaced(kLogits, "float32", "uint8"))
                .find("takes float32 but the sidecar's input.type says uint8"),
            std::string::npos);
  EXPECT_NE(errorOf("tiny_logits.onnx", replaced(kLogits, "green, blue]", "green, blue, grey]"))
                .find("gives 3 classes but the sidecar lists 4"),
            std::string::npos);
  EXPECT_NE(errorOf("tiny_logits.onnx", replaced(kLogits, "stride: 8", "stride: 4"))
                .find("gives an output of 1x3x4x6 but the sidecar's input size, output and classes make 1x3x8x12"),
            std::string::npos);
  EXPECT_NE(errorOf("tiny_logits.onnx", replaced(kLogits, "{kind", "{name: scores, kind"))
                .find("has no output 'scores', it has logits"),
            std::string::npos);
  EXPECT_NE(errorOf("tiny_labels.onnx", replaced(kLabels, "kind: labels", "kind: logits, layout: nchw"))
                .find("gives int64 but the sidecar's output.kind wants float32 logits"),
            std::string::npos);
}

TEST(OnnxSegmenter, RefusesScoresThatAreNotFinite) {
  EXPECT_NE(errorOf("tiny_logits.onnx", replaced(kLogits, "channels: rgb", "scale: 1.0e+38, channels: rgb"))
                .find("gives scores that are not finite"),
            std::string::npos);
}

TEST(OnnxSegmenter, RefusesLabelsBeyondTheClassList) {
  // The first image that shows the class tells; the warm-up does not.
  const auto segmenter = makeOnnxSegmenter(configOf(
      "tiny_labels.onnx", replaced(replaced(kLabels, "[dark, bright]", "[dark]"), "name: bright", "name: dark")));
  EXPECT_NE(modelError([&] {
              segmenter->segment(threeColours({48, 32}));
            }).find("gives class 1 but the sidecar lists 1"),
            std::string::npos);
}

TEST(OnnxSegmenter, SaysThatAFileIsCorrupt) {
  SegmentationConfig config = configOf("tiny_logits.onnx", kLogits);
  const std::string whole = readText(config.model);
  config.model = writeText("corrupt.onnx", whole.substr(0, whole.size() / 2));
  const std::string message = modelError([&] { makeOnnxSegmenter(config); });
  EXPECT_NE(message.find("corrupt.onnx' cannot be loaded"), std::string::npos);
}

TEST(OnnxSegmenter, SaysThatTheSidecarIsMissing) {
  SegmentationConfig config = configOf("tiny_logits.onnx", kLogits);
  config.model = writeText("alone.onnx", readText(config.model));
  config.sidecar = "";
  EXPECT_NE(modelError([&] { makeOnnxSegmenter(config); }).find("has no sidecar"), std::string::npos);
}

TEST(OnnxSegmenter, RefusesAConfigurationOutOfRange) {
  SegmentationConfig config = configOf("tiny_logits.onnx", kLogits);
  config.threads = 0;
  EXPECT_THROW(makeOnnxSegmenter(config), ConfigError);
}

TEST(OnnxSegmenter, RunsTheNetworksOfThePackage) {
  for (const char* model : {"bisenetv2_indoor.onnx", "bisenetv2_indoor_float.onnx"}) {
    SegmentationConfig config;
    config.model = model;
    const auto segmenter = makeOnnxSegmenter(config);
    ASSERT_EQ(segmenter->labels().size(), 11U);
    EXPECT_EQ(segmenter->labels().classes[1].name, "person");
    const Segmentation segmentation = segmenter->segment(threeColours({64, 48}));
    EXPECT_EQ(segmentation.labels.size(), cv::Size(64, 48));
    EXPECT_EQ(segmentation.weak_people.size(), cv::Size(64, 48));
    double largest = 0.0;
    cv::minMaxLoc(segmentation.labels, nullptr, &largest);
    EXPECT_LT(largest, 11.0);
  }
}

TEST(OnnxSegmenter, FindsThePeopleOfAPhotograph) {
  SegmentationConfig config;
  config.model = sharedPath("data/models/deeplabv3_mnv2_pascal_quant.onnx");
  const std::string photograph = sharedPath("data/coco128_train/images/000000000036.jpg");
  const std::string truth = sharedPath("data/coco128_train/masks/000000000036.png");
  if (config.model.empty() || photograph.empty() || truth.empty()) GTEST_SKIP() << "needs ../shared/data";
  const auto segmenter = makeOnnxSegmenter(config);
  const cv::Mat1b person = segmenter->segment(cv::imread(photograph)).labels == 1;
  const cv::Mat1b expected = cv::imread(truth, cv::IMREAD_UNCHANGED) == 1;
  const double iou = static_cast<double>(cv::countNonZero(person & expected)) / cv::countNonZero(person | expected);
  EXPECT_GT(iou, 0.7);
}

}  // namespace
}  // namespace semantic_vslam
