// SPDX-FileCopyrightText: 2026 The semantic_vslam authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <array>
#include <cstdint>
#include <opencv2/core.hpp>
#include <string>
#include <vector>

#include "semantic_vslam/core/common/label_set.h"

namespace semantic_vslam {

enum class TensorLayout { kNchw, kNhwc };
enum class TensorType { kFloat32, kUint8 };
enum class ChannelOrder { kRgb, kBgr };
/// kStretch resizes without keeping the aspect ratio; kLetterbox keeps it and pads right and bottom.
enum class ResizeMode { kStretch, kLetterbox };
enum class OutputKind { kLogits, kLabels };

/// What a network file cannot say about itself: how its input is made and what its output means. Read from a YAML file
/// that lies beside the network, so that any semantic network runs without a change of code. The form is described in
/// models/README.md.
struct ModelSidecar {
  std::string path;  ///< the file it was read from, for messages

  struct Input {
    cv::Size size;  ///< px
    TensorLayout layout = TensorLayout::kNchw;
    TensorType type = TensorType::kFloat32;
    ChannelOrder channels = ChannelOrder::kRgb;
    ResizeMode resize = ResizeMode::kStretch;
    /// A float tensor holds (pixel * scale - mean) / std, each in the order of `channels`. Unused for uint8.
    double scale = 1.0;
    std::array<double, 3> mean{0.0, 0.0, 0.0};
    std::array<double, 3> std{1.0, 1.0, 1.0};
    int pad_value = 114;  ///< 8-bit grey that a letterbox is filled with, before normalisation
  } input;

  struct Output {
    std::string name;  ///< of the tensor; empty: the network's first output
    OutputKind kind = OutputKind::kLogits;
    TensorLayout layout = TensorLayout::kNchw;  ///< of logits
    int stride = 1;                             ///< input pixels per output pixel
  } output;

  std::vector<std::string> network_classes;  ///< in the network's own order
  LabelSet labels;                           ///< ours; 0 is "background"
  std::vector<std::uint8_t> label_of_class;  ///< network class -> index into labels, one per network class
};

/// @throws ModelError naming the file and the key that is missing, unknown, mistyped or does not fit.
ModelSidecar loadModelSidecar(const std::string& path);

/// The file of a network: `model` itself, or that name in this package's folder models.
/// @throws ModelError naming every place looked at.
std::string findModel(const std::string& model);

/// The sidecar of a network: `sidecar` if it is not empty, else the .yaml of the same stem beside the network, else
/// that name in this package's models/sidecars.
/// @throws ModelError naming every place looked at.
std::string findModelSidecar(const std::string& model, const std::string& sidecar);

}  // namespace semantic_vslam
