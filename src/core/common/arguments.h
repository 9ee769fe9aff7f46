// SPDX-FileCopyrightText: 2026 The semantic_vslam authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <functional>
#include <optional>
#include <set>
#include <string>
#include <utility>
#include <vector>

#include "semantic_vslam/core/common/error.h"

namespace semantic_vslam {

/// A command line that does not fit the program's usage.
class UsageError : public Error {
 public:
  using Error::Error;
};

/// Command line of a tool: `--name value`, `--name=value`, `--flag`, and files in between.
class Arguments {
 public:
  /// How many arguments are no options.
  struct Positionals {
    std::size_t least = 0, most = 0;
  };

  /// @param with_value, flags  known options, with their dashes
  /// @throws UsageError naming what is unknown, missing or too much.
  Arguments(int argc, const char* const* argv, const std::set<std::string>& with_value,
            const std::set<std::string>& flags, Positionals positionals);

  const std::vector<std::string>& positional() const { return positional_; }
  bool has(const std::string& option) const;
  /// @return the last value given; nothing if the option is absent.
  std::optional<std::string> value(const std::string& option) const;
  /// @return every value given, in order.
  std::vector<std::string> values(const std::string& option) const;
  /// @throws UsageError if the value is no positive number of 1e9 at most.
  double positiveNumber(const std::string& option, double default_value) const;
  /// @throws UsageError if the value is no whole number from `least`.
  std::size_t count(const std::string& option, std::size_t default_value, std::size_t least = 0) const;

 private:
  std::vector<std::string> positional_;
  std::vector<std::pair<std::string, std::string>> options_;  // in the order given; flags have an empty value
};

/// Frame of a tool's main(): prints the usage for --help, and turns what `body` throws into one line on stderr.
/// @return exit code: that of body, 2 for a UsageError, 1 for any other error.
int runTool(int argc, const char* const* argv, const std::string& usage, const std::function<int()>& body);

}  // namespace semantic_vslam
