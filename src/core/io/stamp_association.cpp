// SPDX-FileCopyrightText: 2026 The semantic_vslam authors
// SPDX-License-Identifier: BSD-3-Clause
#include "core/io/stamp_association.h"

#include <algorithm>
#include <cstdlib>
#include <numeric>
#include <string>
#include <tuple>

#include "semantic_vslam/core/common/error.h"

namespace semantic_vslam {

std::vector<std::pair<std::size_t, std::size_t>> associateStamps(const std::vector<Stamp>& a,
                                                                 const std::vector<Stamp>& b, double max_gap_s) {
  constexpr std::size_t kMostCandidates = 10'000'000;  // 240 MB; an hour at 30 Hz within 1 s of poses at 45 Hz
  const std::int64_t max_gap_ns = Stamp::fromSeconds(max_gap_s).ns;
  std::vector<std::size_t> b_by_time(b.size());
  std::iota(b_by_time.begin(), b_by_time.end(), std::size_t{0});
  std::stable_sort(b_by_time.begin(), b_by_time.end(), [&](std::size_t i, std::size_t j) { return b[i] < b[j]; });

  std::vector<std::tuple<std::int64_t, std::size_t, std::size_t>> candidates;  // gap in ns, index in a, index in b
  for (std::size_t i = 0; i < a.size(); ++i) {
    const Stamp earliest{a[i].ns - max_gap_ns + 1};
    auto it = std::lower_bound(b_by_time.begin(), b_by_time.end(), earliest,
                               [&](std::size_t j, Stamp stamp) { return b[j] < stamp; });
    for (; it != b_by_time.end() && b[*it].ns < a[i].ns + max_gap_ns; ++it) {
      if (candidates.size() == kMostCandidates) {
        throw Error("too many stamps lie within " + std::to_string(max_gap_s) +
                    " s of each other: are they the same, or is the gap too wide?");
      }
      candidates.emplace_back(std::abs(a[i].ns - b[*it].ns), i, *it);
    }
  }
  std::sort(candidates.begin(), candidates.end());

  std::vector<char> used_a(a.size(), 0), used_b(b.size(), 0);
  std::vector<std::pair<std::size_t, std::size_t>> pairs;
  for (const auto& [gap_ns, i, j] : candidates) {
    if (used_a[i] != 0 || used_b[j] != 0) continue;
    used_a[i] = used_b[j] = 1;
    pairs.emplace_back(i, j);
  }
  std::sort(pairs.begin(), pairs.end());
  return pairs;
}

}  // namespace semantic_vslam
