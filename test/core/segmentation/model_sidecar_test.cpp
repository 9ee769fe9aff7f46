// SPDX-FileCopyrightText: 2026 The semantic_vslam authors
// SPDX-License-Identifier: BSD-3-Clause
#include "core/segmentation/model_sidecar.h"

#include "core/support/fixtures.h"

namespace semantic_vslam {
namespace {

const char* const kSidecar = R"(
name: a network
license: MIT
input: {width: 48, height: 32, layout: nchw, type: float32, channels: bgr, resize: letterbox, pad_value: 7,
        scale: 0.5, mean: [1, 2, 3], std: [4, 5, 6]}
output: {name: scores, kind: logits, layout: nhwc, stride: 8}
classes: [unknown, man, woman, seat]
labels:
  - {name: person, mobility: person, color: [220, 20, 60], from: [man, woman]}
  - {name: seat, mobility: movable}
)";

ModelSidecar load(const std::string& text) { return loadModelSidecar(writeText("sidecar_test.yaml", text)); }

std::string errorOf(const std::string& from, const std::string& to) {
  return modelError([&] { load(replaced(kSidecar, from, to)); });
}

TEST(ModelSidecar, ReadsEveryKey) {
  const ModelSidecar s = load(kSidecar);
  EXPECT_EQ(s.input.size, cv::Size(48, 32));
  EXPECT_EQ(s.input.layout, TensorLayout::kNchw);
  EXPECT_EQ(s.input.type, TensorType::kFloat32);
  EXPECT_EQ(s.input.channels, ChannelOrder::kBgr);
  EXPECT_EQ(s.input.resize, ResizeMode::kLetterbox);
  EXPECT_EQ(s.input.pad_value, 7);
  EXPECT_EQ(s.input.scale, 0.5);
  EXPECT_EQ(s.input.mean, (std::array<double, 3>{1, 2, 3}));
  EXPECT_EQ(s.input.std, (std::array<double, 3>{4, 5, 6}));
  EXPECT_EQ(s.output.name, "scores");
  EXPECT_EQ(s.output.kind, OutputKind::kLogits);
  EXPECT_EQ(s.output.layout, TensorLayout::kNhwc);
  EXPECT_EQ(s.output.stride, 8);
}

TEST(ModelSidecar, MapsNetworkClassesToLabels) {
  const ModelSidecar s = load(kSidecar);
  EXPECT_EQ(s.label_of_class, (std::vector<std::uint8_t>{0, 1, 1, 2}));
  ASSERT_EQ(s.labels.size(), 3U);
  EXPECT_EQ(s.labels.classes[0].name, "background");
  EXPECT_EQ(s.labels.classes[1].name, "person");
  EXPECT_EQ(s.labels.mobility(1), Mobility::kPerson);
  EXPECT_EQ(s.labels.classes[1].color_bgr, cv::Vec3b(60, 20, 220));
  EXPECT_EQ(s.labels.mobility(2), Mobility::kMovable);
}

TEST(ModelSidecar, NamesFileAndKeyOfEveryMistake) {
  EXPECT_NE(errorOf("width: 48, ", "").find("sidecar_test.yaml': 'input.width' is missing"), std::string::npos);
  EXPECT_NE(errorOf("width: 48", "width: many").find("'input.width' must be a whole number"), std::string::npos);
  EXPECT_NE(errorOf("width: 48", "width: 0").find("'input.width' is 0, must be in [8, 4096]"), std::string::npos);
  EXPECT_NE(errorOf("nchw", "chw").find("'input.layout' is 'chw', must be one of nchw, nhwc"), std::string::npos);
  EXPECT_NE(errorOf("[4, 5, 6]", "[4, 0, 6]").find("'input.std' must hold numbers above 0"), std::string::npos);
  EXPECT_NE(errorOf("[1, 2, 3]", "[1, 2]").find("'input.mean' must be a list of three numbers"), std::string::npos);
  EXPECT_NE(errorOf("float32", "uint8").find("takes no scale, mean or std"), std::string::npos);
  EXPECT_NE(errorOf("stride: 8", "strid: 8").find("'output.stride' is missing"), std::string::npos);
  EXPECT_NE(errorOf("stride: 8", "stride: 8, top: 1").find("'output.top' is unknown"), std::string::npos);
  EXPECT_NE(errorOf("license: MIT", "licence: MIT").find("'licence' is unknown"), std::string::npos);
}

TEST(ModelSidecar, RefusesLabelsThatDoNotFitTheClasses) {
  EXPECT_NE(errorOf("woman]}", "lady]}").find("'labels[0].from' names 'lady', which is not in 'classes'"),
            std::string::npos);
  EXPECT_NE(errorOf("name: seat", "name: stool").find("names 'stool', which is not in 'classes'"), std::string::npos);
  EXPECT_NE(errorOf("name: seat", "name: person").find("'person' is used twice"), std::string::npos);
  EXPECT_NE(errorOf("{name: seat,", "{name: seat, from: [man],").find("takes class 'man' a second time"),
            std::string::npos);
  EXPECT_NE(errorOf("movable", "mobile").find("must be one of movable, person, static"), std::string::npos);
}

TEST(ModelSidecar, RefusesWhatIsNoYaml) {
  EXPECT_NE(modelError([] { load("input: [1, 2"); }).find("is no valid YAML"), std::string::npos);
  EXPECT_NE(modelError([] { load("just text"); }).find("must be a map"), std::string::npos);
  EXPECT_NE(modelError([] { loadModelSidecar("/nowhere.yaml"); }).find("'/nowhere.yaml' cannot be opened"),
            std::string::npos);
}

TEST(ModelSidecar, IsFoundBesideTheNetworkThenInThePackage) {
  const std::string model = testing::TempDir() + "net_a.onnx";
  const std::string beside = writeText("net_a.yaml", kSidecar);
  EXPECT_EQ(findModelSidecar(model, ""), beside);
  const std::string named = writeText("other.yaml", kSidecar);
  EXPECT_EQ(findModelSidecar(model, named), named);
  EXPECT_NE(findModelSidecar("/data/deeplabv3_mnv2_pascal_quant.onnx", "").find("models/sidecars"), std::string::npos);
}

TEST(Model, IsAFileOrANameInThePackage) {
  const std::string file = writeText("net_b.onnx", "");
  EXPECT_EQ(findModel(file), file);
  const std::string shipped = findModel("sidecars/bisenetv2_coco.yaml");  // any file there: the folder is what counts
  EXPECT_EQ(std::filesystem::path(shipped).parent_path().filename(), "sidecars");
  const std::string message = modelError([] { findModel("no_such.onnx"); });
  EXPECT_NE(message.find("'no_such.onnx' is no file"), std::string::npos);
  EXPECT_NE(message.find("models/no_such.onnx'"), std::string::npos);
  EXPECT_FALSE(modelError([] { findModel(testing::TempDir()); }).empty());
}

TEST(ModelSidecar, ThatIsMissingIsNamedWithEveryPlaceLookedAt) {
  const std::string message = modelError([] { findModelSidecar("/data/no_such.onnx", ""); });
  EXPECT_NE(message.find("'/data/no_such.yaml'"), std::string::npos);
  EXPECT_NE(message.find("models/sidecars/no_such.yaml'"), std::string::npos);
  EXPECT_NE(modelError([] { findModelSidecar("/data/a.onnx", "/data/b.yaml"); }).find("'/data/b.yaml' is no file"),
            std::string::npos);
}

TEST(ModelSidecar, EveryOneThatIsShippedLoadsAndKnowsPeople) {
  int count = 0;
  for (const auto& entry : std::filesystem::directory_iterator("models/sidecars")) {
    SCOPED_TRACE(entry.path());
    const ModelSidecar s = loadModelSidecar(entry.path().string());
    ASSERT_GT(s.labels.size(), 1U);
    EXPECT_EQ(s.labels.classes[1].name, "person");
    EXPECT_EQ(s.labels.mobility(1), Mobility::kPerson);
    ++count;
  }
  EXPECT_GE(count, 3);
  EXPECT_EQ(loadModelSidecar("models/sidecars/bisenetv2_coco.yaml").network_classes.size(), 171U);
  EXPECT_EQ(loadModelSidecar("models/sidecars/bisenetv2_coco80.yaml").network_classes.size(), 80U);
}

}  // namespace
}  // namespace semantic_vslam
