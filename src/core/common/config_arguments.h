// SPDX-FileCopyrightText: 2026 The semantic_vslam authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string>

#include "core/common/arguments.h"
#include "semantic_vslam/core/common/config_fields.h"

namespace semantic_vslam {

/// Sets what the command line asks for with --set KEY=VALUE, in that order.
/// @throws UsageError for one without '='
/// @throws ConfigError for an unknown key or a value that does not fit
template <class Config>
void applySettings(const Arguments& arguments, Config& config) {
  for (const std::string& setting : arguments.values("--set")) {
    const std::size_t equals = setting.find('=');
    if (equals == std::string::npos) throw UsageError("--set " + setting + ": expected KEY=VALUE");
    setConfig(config, setting.substr(0, equals), setting.substr(equals + 1));
  }
}

}  // namespace semantic_vslam
