// SPDX-FileCopyrightText: 2026 The semantic_vslam authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <memory>

#include "semantic_vslam/core/segmentation/segmentation_config.h"
#include "semantic_vslam/core/segmentation/segmenter.h"

namespace semantic_vslam {

/// Whether this build has ONNX Runtime. Without it no network can be opened; all else works.
bool canRunNetworks();

/// Opens config.model with its sidecar on ONNX Runtime and runs it once, so that the first frame is as fast as the
/// rest. A network that gives labels is up-sampled by nearest neighbour; one that gives logits as if they were
/// up-sampled bilinearly and the best class taken then, at the cost of the label borders only (see label_upsampling.h).
/// @throws ConfigError if config is out of range; ModelError, one line, if the network or its sidecar is missing or
///         corrupt, or shape, type or number of classes are not what the sidecar says, or !canRunNetworks().
std::unique_ptr<Segmenter> makeOnnxSegmenter(const SegmentationConfig& config);

}  // namespace semantic_vslam
