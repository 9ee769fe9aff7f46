// SPDX-FileCopyrightText: 2026 The semantic_vslam authors
// SPDX-License-Identifier: BSD-3-Clause
//
// Runs a semantic network over a folder of images: to see what it knows, or to make labels to train another one on.
#include <algorithm>
#include <filesystem>
#include <opencv2/imgcodecs.hpp>
#include <opencv2/imgproc.hpp>
#include <string>
#include <vector>

#include "core/common/arguments.h"
#include "core/common/progress.h"
#include "core/io/image_file.h"
#include "core/segmentation/label_picture.h"
#include "core/segmentation/onnx_segmenter.h"
#include "semantic_vslam/core/common/error.h"

namespace {

using namespace semantic_vslam;
namespace fs = std::filesystem;

constexpr const char* kUsage =
    "usage: label_images NETWORK.onnx IMAGE_DIR OUT_DIR [options]\n"
    "Writes OUT_DIR/images/* (copies), OUT_DIR/labels/*.png (8-bit labels) and OUT_DIR/overlays/*.jpg.\n"
    "  --sidecar FILE   YAML that describes the network; without it the .yaml beside it, else in models/sidecars\n"
    "  --unknown N      write N (255: ignored in training) where the network finds nothing it knows, instead of 0\n"
    "  --threads N      threads of the network (1)\n";

std::vector<fs::path> listImages(const std::string& folder) {
  if (!fs::is_directory(folder)) throw FileError("'" + folder + "' is no folder");
  std::vector<fs::path> paths;
  for (const auto& entry : fs::directory_iterator(folder)) {
    const std::string extension = entry.path().extension().string();
    if (extension == ".jpg" || extension == ".png") paths.push_back(entry.path());
  }
  if (paths.empty()) throw FileError("'" + folder + "' holds no .jpg or .png");
  std::sort(paths.begin(), paths.end());
  return paths;
}

int run(const Arguments& arguments) {
  SegmentationConfig config;
  config.model = arguments.positional()[0];
  config.sidecar = arguments.value("--sidecar").value_or("");
  config.threads = static_cast<int>(arguments.count("--threads", 1));
  const std::size_t unknown = arguments.count("--unknown", 0);
  if (unknown > 255) throw UsageError("--unknown must be in [0, 255]");
  const std::vector<fs::path> images = listImages(arguments.positional()[1]);
  const fs::path out = arguments.positional()[2];
  for (const char* folder : {"images", "labels", "overlays"}) fs::create_directories(out / folder);

  const auto segmenter = makeOnnxSegmenter(config);
  Progress progress(images.size(), "images");
  for (std::size_t i = 0; i < images.size(); ++i) {
    const cv::Mat3b bgr = readImageFile(images[i].string(), cv::IMREAD_COLOR);
    cv::Mat1b labels = segmenter->segment(bgr).labels;
    const std::string stem = images[i].stem().string();
    writeImageFile((out / "overlays" / (stem + ".jpg")).string(), drawLabels(bgr, labels, segmenter->labels()));
    labels.setTo(static_cast<double>(unknown), labels == 0);
    writeImageFile((out / "labels" / (stem + ".png")).string(), labels);
    fs::copy_file(images[i], out / "images" / images[i].filename(), fs::copy_options::overwrite_existing);
    progress.show(i + 1);
  }
  return 0;
}

}  // namespace

int main(int argc, char** argv) {
  return runTool(argc, argv, kUsage, [&] {
    return run(Arguments(argc, argv, {"--sidecar", "--unknown", "--threads"}, {}, {3, 3}));
  });
}
