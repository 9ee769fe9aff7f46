// SPDX-FileCopyrightText: 2026 The semantic_vslam authors
// SPDX-License-Identifier: BSD-3-Clause
// In place of onnx_segmenter.cpp where CMake finds no ONNX Runtime.
#include "core/segmentation/model_sidecar.h"
#include "core/segmentation/onnx_segmenter.h"
#include "semantic_vslam/core/common/config_fields.h"
#include "semantic_vslam/core/common/error.h"

namespace semantic_vslam {

bool canRunNetworks() { return false; }

std::unique_ptr<Segmenter> makeOnnxSegmenter(const SegmentationConfig& config) {
  validateConfig(config);
  throw ModelError("network '" + findModel(config.model) +
                   "' cannot run: this build has no ONNX Runtime; build again with -DONNXRUNTIME_ROOT=<prefix>, or "
                   "leave segmentation.model empty");
}

}  // namespace semantic_vslam
