// SPDX-FileCopyrightText: 2026 The semantic_vslam authors
// SPDX-License-Identifier: BSD-3-Clause
#include "core/common/atomic_file.h"

#include <fcntl.h>
#include <sys/stat.h>
#include <unistd.h>

#include <cerrno>
#include <csignal>
#include <cstdio>
#include <cstring>
#include <filesystem>
#include <random>
#include <utility>
#include <vector>

#include "semantic_vslam/core/common/error.h"

namespace semantic_vslam {
namespace {

namespace fs = std::filesystem;

constexpr const char* kPrefix = ".writing-";

/// No two writers share one, and nobody can guess it.
std::string temporaryName(const std::string& path) {
  thread_local std::random_device random;
  char unique[40];
  std::snprintf(unique, sizeof unique, "%d-%08x%08x-", static_cast<int>(getpid()), random(), random());
  const std::size_t slash = path.rfind('/');
  const std::size_t name = slash == std::string::npos ? 0 : slash + 1;
  return path.substr(0, name) + kPrefix + unique + path.substr(name);
}

[[noreturn]] void throwCannotWrite(const std::string& path, int error) {
  throw FileError("cannot write '" + path + "': " + std::strerror(error));
}

/// The file that a path means: where a link leads.
std::string target(const std::string& path) {
  std::error_code failed;
  if (!fs::is_symlink(path, failed)) return path;
  const fs::path end = fs::weakly_canonical(path, failed);
  if (failed) throwCannotWrite(path, failed.value());
  return end.string();
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

AtomicFile::AtomicFile(std::string path)
    : path_(std::move(path)), target_(target(path_)), temporary_(temporaryName(target_)) {
  struct stat old {};
  const bool exists = stat(target_.c_str(), &old) == 0;
  if (exists && !S_ISREG(old.st_mode)) throwCannotWrite(path_, S_ISDIR(old.st_mode) ? EISDIR : ENOTSUP);
  constexpr mode_t kAsUmaskSays = 0666;
  const int file = open(temporary_.c_str(), O_WRONLY | O_CREAT | O_EXCL | O_NOFOLLOW | O_CLOEXEC, kAsUmaskSays);
  if (file < 0) throwCannotWrite(path_, errno);
  if (exists && fchmod(file, old.st_mode & 07777) != 0) {
    // Of another owner: then the new file has the usual permissions.
  }
  close(file);
}

AtomicFile::~AtomicFile() {
  if (!committed_) std::remove(temporary_.c_str());
}

void AtomicFile::commit() {
  if (std::rename(temporary_.c_str(), target_.c_str()) != 0) throwCannotWrite(path_, errno);
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
  const AtomicFile trial(path);  // never committed, so that nothing is left of it
  writeText(trial.temporary(), path, "");
}

void removeLeftOvers(const std::string& folder) {
  std::error_code failed;
  std::vector<fs::path> left;
  for (fs::directory_iterator entry(folder, failed), end; !failed && entry != end; entry.increment(failed)) {
    const std::string name = entry->path().filename().string();
    int writer = 0;
    if (std::sscanf(name.c_str(), ".writing-%d-", &writer) != 1 || writer <= 0) continue;
    if (kill(writer, 0) != 0 && errno == ESRCH) left.push_back(entry->path());
  }
  for (const fs::path& file : left) fs::remove(file, failed);
}

}  // namespace semantic_vslam
