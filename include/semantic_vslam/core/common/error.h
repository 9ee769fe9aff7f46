// SPDX-FileCopyrightText: 2026 The semantic_vslam authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <stdexcept>
#include <string>

namespace semantic_vslam {

/// Base of everything this library throws. The message is one line that names the thing and says what to do.
/// Thrown by constructors and loaders only; the frame loop reports by status.
class Error : public std::runtime_error {
 public:
  using std::runtime_error::runtime_error;
};

/// A configuration key that is unknown, of the wrong type, or out of its range.
class ConfigError : public Error {
 public:
  using Error::Error;
};

/// A file or folder that is missing, truncated, unreadable, of the wrong format, or cannot be written.
class FileError : public Error {
 public:
  using Error::Error;
};

/// A network or its sidecar that does not load or does not fit.
class ModelError : public Error {
 public:
  using Error::Error;
};

}  // namespace semantic_vslam
