// SPDX-FileCopyrightText: 2026 The semantic_vslam authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

namespace semantic_vslam {

/// Step between neighbouring Kinect depths: 1/8 px of disparity is 2.85e-3 z^2 (Khoshelham and Elberink 2012).
constexpr double kKinectStepPerM2 = 2.85e-3;

}  // namespace semantic_vslam
