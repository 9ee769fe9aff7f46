// SPDX-FileCopyrightText: 2026 The semantic_vslam authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <atomic>

namespace semantic_vslam {

/// Set by who no longer wants the result of a long computation, which looks at it between two steps.
using AbortFlag = std::atomic<bool>;

}  // namespace semantic_vslam
