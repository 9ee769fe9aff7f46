// SPDX-FileCopyrightText: 2026 The semantic_vslam authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <utility>
#include <vector>

#include "semantic_vslam/core/common/stamp.h"

namespace semantic_vslam {

/// The benchmark's tolerance between the two halves of a pair, s.
constexpr double kAssociationGapS = 0.02;

/// Pairs two streams by their stamps as the TUM benchmark does: of all pairs closer than the gap, the closest is taken
/// first, and each stamp is used once.
/// @return (index in a, index in b), in order of the index in a.
std::vector<std::pair<std::size_t, std::size_t>> associateStamps(const std::vector<Stamp>& a,
                                                                 const std::vector<Stamp>& b, double max_gap_s);

}  // namespace semantic_vslam
