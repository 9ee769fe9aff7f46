// SPDX-FileCopyrightText: 2026 The semantic_vslam authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "semantic_vslam/core/pipeline/config.h"

namespace semantic_vslam {

/// The defaults but without the package's network, which rendered rooms say nothing about and tests would wait for.
inline SystemConfig motionAlone() {
  SystemConfig config;
  config.segmentation.model.clear();
  return config;
}

}  // namespace semantic_vslam
