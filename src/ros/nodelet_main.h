// SPDX-FileCopyrightText: 2026 The semantic_vslam authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string>

namespace semantic_vslam {

/// Runs one nodelet as a process of its own.
/// @param node_name  unless __name:= says otherwise  @param nodelet  class, as in nodelet_plugins.xml
/// @return exit status: 1 if the nodelet did not start, of which it has said why.
int runNodelet(int argc, char** argv, const std::string& node_name, const std::string& nodelet);

}  // namespace semantic_vslam
