// SPDX-FileCopyrightText: 2026 The semantic_vslam authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <functional>
#include <string>

namespace semantic_vslam {

/// A file that readers see with its old content or with the whole new one, never a part: the new content goes to a
/// temporary file in the same folder, which takes the name on commit(). Without a commit the temporary is removed. A
/// link is followed, and permissions of an old file are kept.
class AtomicFile {
 public:
  /// Makes the temporary file. @throws FileError naming path if that fails, or path is a folder or device
  explicit AtomicFile(std::string path);
  ~AtomicFile();
  AtomicFile(const AtomicFile&) = delete;
  AtomicFile& operator=(const AtomicFile&) = delete;

  const std::string& path() const { return path_; }
  /// Where to write; ends like path, since many writers choose the format by the extension.
  const std::string& temporary() const { return temporary_; }
  /// @throws FileError naming path if the temporary cannot take the name.
  void commit();

 private:
  std::string path_, target_, temporary_;
  bool committed_ = false;
};

/// @param write  writes all of the file to the path it is given; what it throws is passed on, and the old file stays
/// @throws FileError as AtomicFile::commit()
void writeFileAtomically(const std::string& path, const std::function<void(const std::string& temporary_path)>& write);

/// Writes content as the whole of a file. @throws FileError naming path and cause (no such folder, disk full, ...).
void writeTextAtomically(const std::string& path, const std::string& content);

/// Removes the temporaries of programs that were killed.
void removeLeftOvers(const std::string& folder);

/// For the start of a long run that writes a file at its end. @throws FileError if that would fail
void requireWritable(const std::string& path);

}  // namespace semantic_vslam
