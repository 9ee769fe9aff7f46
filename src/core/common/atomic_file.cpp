// SPDX-FileCopyrightText: 2026 The semantic_vslam authors
// SPDX-License-Identifier: BSD-3-Clause
#include "core/common/atomic_file.h"

#include <unistd.h>

#include <atomic>
#include <cerrno>
#include <cstdio>
#include <cstring>
#include <filesystem>
#include <utility>

#include "semantic_vslam/core/common/error.h"

namespace semantic_vslam {
namespace {

/// No two writers share one, not even those of one file.
std::string temporaryName(const std::string& path) {
  static std::atomic<int> writers{0};
  const std::size_t slash = path.rfind('/');
  const std::size_t name = slash == std::string::npos ? 0 : slash + 1;
  return path.substr(0, name) + ".writing-" + std::to_string(getpid()) + "-" + std::to_string(writers++) + "-" +
         path.substr(name);
}

[[noreturn]] void throwCannotWrite(const std::string& path, int error) {
  throw FileError("cannot write '" + path + "': " + std::strerror(error));
}

void writeText(const std::string& temporary, const std::string& path, const std::string& content) {
  std::FILE* file = std::fopen(temporary.c_str(), "wb");
  if (file == nullptr) throwCannotWrite(path, errno);
  bool written = std::fwrite(content.data(), 1, content.size(), file) == content.size();
  written = written && std::fflush(file) == 0 && fsync(fileno(file)) == 0;  // a full disk often shows only here
  int error = written ? 0 : errno;
  if (std::fclose(file) != 0 && error == 0) error = errno;
  if (error != 0) throwCannotWrite(path, error);
}

}  // namespace

AtomicFile::AtomicFile(std::string path) : path_(std::move(path)), temporary_(temporaryName(path_)) {}

AtomicFile::~AtomicFile() {
  if (!committed_) std::remove(temporary_.c_str());
}

void AtomicFile::commit() {
  if (std::rename(temporary_.c_str(), path_.c_str()) != 0) throwCannotWrite(path_, errno);
  committed_ = true;
}

void writeFileAtomically(const std::string& path, const std::function<void(const std::string&)>& write) {
  AtomicFile file(path);
  write(file.temporary());
  file.commit();
}

void writeTextAtomically(const std::string& path, const std::string& content) {
  writeFileAtomically(path, [&](const std::string& temporary) { writeText(temporary, path, content); });
}

void requireWritable(const std::string& path) {
  if (std::filesystem::is_directory(path)) throwCannotWrite(path, EISDIR);
  const AtomicFile trial(path);  // never committed, so that nothing is left of it
  writeText(trial.temporary(), path, "");
}

}  // namespace semantic_vslam
