// SPDX-FileCopyrightText: 2026 The semantic_vslam authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string>

namespace YAML {
class Node;
}

namespace semantic_vslam {

/// To be called before a file is opened: a folder gives no message of its own, and a pipe waits for ever. What does not
/// exist passes: who opens it says so.
/// @param what  e.g. "map file", for the message  @throws FileError naming path if it is a folder, pipe or device
void requireRegularFile(const std::string& what, const std::string& path);

/// Reads a YAML file written by hand. Aliases, which can refer to themselves or multiply to gigabytes, keys that are
/// said twice, of which one would be lost in silence, and keys that are no words are refused.
/// @param what  e.g. "camera file", for the messages  @throws FileError naming path and line
YAML::Node readYamlFile(const std::string& what, const std::string& path);

/// @return the text on one line, without what a terminal would obey: control characters become \xNN
std::string printable(const std::string& text);

}  // namespace semantic_vslam
