// SPDX-FileCopyrightText: 2026 The semantic_vslam authors
// SPDX-License-Identifier: BSD-3-Clause
#include "core/common/arguments.h"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <exception>

#include "core/common/input_file.h"
#include "semantic_vslam/core/common/error.h"

namespace semantic_vslam {

Arguments::Arguments(int argc, const char* const* argv, const std::set<std::string>& with_value,
                     const std::set<std::string>& flags, Positionals positionals) {
  for (int i = 1; i < argc; ++i) {
    const std::string word = argv[i];
    if (word.rfind("--", 0) != 0) {
      positional_.push_back(word);
      continue;
    }
    const std::size_t equals = word.find('=');
    const std::string name = word.substr(0, equals);
    if (flags.count(name) != 0) {
      if (equals != std::string::npos) throw UsageError("option " + name + " takes no value");
      options_.emplace_back(name, "");
    } else if (with_value.count(name) == 0) {
      throw UsageError("unknown option " + name);
    } else if (equals != std::string::npos) {
      options_.emplace_back(name, word.substr(equals + 1));
    } else if (i + 1 < argc) {
      options_.emplace_back(name, argv[++i]);
    } else {
      throw UsageError("option " + name + " needs a value");
    }
  }
  const auto& [least, most] = positionals;
  if (positional_.size() < least || positional_.size() > most) {
    throw UsageError("expected " + (least < most ? std::to_string(least) + " to " : "") + std::to_string(most) +
                     (most == 1 ? " argument" : " arguments") + " besides the options, got " +
                     std::to_string(positional_.size()));
  }
}

bool Arguments::has(const std::string& option) const { return value(option).has_value(); }

std::optional<std::string> Arguments::value(const std::string& option) const {
  const std::vector<std::string> all = values(option);
  if (all.empty()) return std::nullopt;
  return all.back();
}

std::vector<std::string> Arguments::values(const std::string& option) const {
  std::vector<std::string> found;
  for (const auto& [name, value] : options_) {
    if (name == option) found.push_back(value);
  }
  return found;
}

double Arguments::positiveNumber(const std::string& option, double default_value) const {
  const auto text = value(option);
  if (!text) return default_value;
  constexpr double kMost = 1e9;  // as seconds it stays within a stamp
  char* end = nullptr;
  const double number = std::strtod(text->c_str(), &end);
  if (text->empty() || *end != '\0' || !(number > 0.0 && number <= kMost)) {
    throw UsageError("option " + option + " is '" + *text + "', must be a positive number of 1e9 at most");
  }
  return number;
}

std::size_t Arguments::count(const std::string& option, std::size_t default_value, std::size_t least) const {
  const auto text = value(option);
  if (!text) return default_value;
  const bool digits = !text->empty() && text->size() < 10 && text->find_first_not_of("0123456789") == std::string::npos;
  if (!digits || std::stoul(*text) < least) {
    throw UsageError("option " + option + " is '" + *text + "', must be a whole number from " + std::to_string(least));
  }
  return std::stoul(*text);
}

int runTool(int argc, const char* const* argv, const std::string& usage, const std::function<int()>& body) {
  const auto is_help = [](const char* word) { return std::string(word) == "--help" || std::string(word) == "-h"; };
  if (std::any_of(argv + 1, argv + argc, is_help)) {
    std::fputs(usage.c_str(), stdout);
    return 0;
  }
  const std::string path = argv[0];
  const std::string name = path.substr(path.rfind('/') + 1);
  try {
    const int status = body();
    if (std::fflush(stdout) != 0 || std::ferror(stdout) != 0) throw FileError("cannot write to standard output");
    return status;
  } catch (const UsageError& error) {
    std::fprintf(stderr, "%s: %s; --help shows the usage\n", name.c_str(), printable(error.what()).c_str());
    return 2;
  } catch (const std::exception& error) {
    std::fprintf(stderr, "%s: %s\n", name.c_str(), printable(error.what()).c_str());
    return 1;
  }
}

}  // namespace semantic_vslam
