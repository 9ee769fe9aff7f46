// SPDX-FileCopyrightText: 2026 The semantic_vslam authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <functional>
#include <string>

namespace semantic_vslam {

/// Writes a file so that a reader sees the old content or the whole new one, never a part: the content goes to a
/// temporary file in the same folder, which then takes the name.
/// @param write  writes all of it to the path it is given; what it throws is passed on after the temporary is removed
/// @throws FileError naming path if the temporary cannot be renamed.
void writeFileAtomically(const std::string& path, const std::function<void(const std::string& temporary_path)>& write);

/// The same for content at hand. @throws FileError naming path and cause (no such folder, disk full, ...).
void writeTextAtomically(const std::string& path, const std::string& content);

}  // namespace semantic_vslam
