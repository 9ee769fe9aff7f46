// SPDX-FileCopyrightText: 2026 The semantic_vslam authors
// SPDX-License-Identifier: BSD-3-Clause
#include "core/io/tum_sequence.h"

#include <algorithm>
#include <filesystem>
#include <fstream>
#include <opencv2/imgcodecs.hpp>
#include <sstream>
#include <utility>

#include "core/common/input_file.h"
#include "core/io/broken_frames.h"
#include "core/io/image_file.h"
#include "core/io/stamp_association.h"
#include "core/io/trajectory.h"
#include "semantic_vslam/core/common/error.h"
#include "semantic_vslam/core/common/log.h"

namespace semantic_vslam {
namespace {

namespace fs = std::filesystem;

constexpr double kTumDepthUnitM = 1.0 / 5000.0;

/// Rows of words between spaces, tabs or commas; blank lines, comments and a byte-order mark left out.
std::vector<std::vector<std::string>> readRows(const std::string& path, std::size_t words_per_row) {
  requireRegularFile("list", path);
  std::ifstream in(path);
  if (!in) throw FileError("'" + path + "' is missing or cannot be opened; a TUM sequence needs it");
  std::vector<std::vector<std::string>> rows;
  std::string line;
  for (int number = 1; std::getline(in, line); ++number) {
    constexpr const char* kByteOrderMark = "\xEF\xBB\xBF";
    if (number == 1 && line.compare(0, 3, kByteOrderMark) == 0) line.erase(0, 3);
    std::replace(line.begin(), line.end(), ',', ' ');
    std::istringstream words(line);
    std::vector<std::string> row;
    for (std::string word; words >> word;) row.push_back(word);
    if (row.empty() || row[0][0] == '#') continue;
    if (row.size() < words_per_row) {
      throw FileError("'" + path + "', line " + std::to_string(number) + ": expected " + std::to_string(words_per_row) +
                      " words, found " + std::to_string(row.size()));
    }
    rows.push_back(std::move(row));
  }
  return rows;
}

Stamp stampOf(const std::string& text, const std::string& path) {
  const std::optional<Stamp> stamp = parseStamp(text);
  if (!stamp) throw FileError("'" + path + "': '" + text + "' is no time stamp");
  return *stamp;
}

/// The benchmark's associate.py writes what it is given first first.
bool depthComesFirst(const std::vector<std::string>& row) {
  const auto names_depth = [](const std::string& file) { return file.find("depth") != std::string::npos; };
  return names_depth(row[1]) && !names_depth(row[3]);
}

std::vector<TumPair> readAssociations(const std::string& path) {
  std::vector<TumPair> pairs;
  for (const auto& row : readRows(path, 4)) {
    const std::size_t rgb = depthComesFirst(row) ? 2 : 0, depth = 2 - rgb;
    pairs.push_back({stampOf(row[rgb], path), stampOf(row[depth], path), row[rgb + 1], row[depth + 1]});
  }
  return pairs;
}

struct StampedFiles {
  std::vector<Stamp> stamps;
  std::vector<std::string> files;
};

StampedFiles readFileList(const std::string& path) {
  StampedFiles list;
  for (const auto& row : readRows(path, 2)) {
    list.stamps.push_back(stampOf(row[0], path));
    list.files.push_back(row[1]);
  }
  return list;
}

std::vector<TumPair> associateLists(const std::string& folder) {
  const StampedFiles rgb = readFileList(folder + "/rgb.txt");
  const StampedFiles depth = readFileList(folder + "/depth.txt");
  std::vector<TumPair> pairs;
  for (const auto& [i, j] : associateStamps(rgb.stamps, depth.stamps, kAssociationGapS)) {
    pairs.push_back({rgb.stamps[i], depth.stamps[j], rgb.files[i], depth.files[j]});
  }
  if (pairs.empty()) {
    throw FileError("'" + folder + "': none of the " + std::to_string(rgb.files.size()) +
                    " colour images has a depth image within 0.02 s");
  }
  if (pairs.size() < rgb.files.size()) {
    logInfo("'" + folder + "': " + std::to_string(rgb.files.size() - pairs.size()) + " of " +
            std::to_string(rgb.files.size()) + " colour images have no depth image within 0.02 s and are left out");
  }
  return pairs;
}

}  // namespace

std::vector<TumPair> readTumPairs(const std::string& folder) {
  if (!fs::is_directory(folder)) throw FileError("sequence folder '" + folder + "' does not exist");
  const std::string associations = folder + "/associations.txt";
  const bool associated = fs::exists(associations);
  std::vector<TumPair> pairs = associated ? readAssociations(associations) : associateLists(folder);
  if (pairs.empty()) throw FileError("'" + associations + "' lists no pair of images");
  std::stable_sort(pairs.begin(), pairs.end(),
                   [](const TumPair& a, const TumPair& b) { return a.rgb_stamp < b.rgb_stamp; });
  return pairs;
}

TumSequence::TumSequence(std::string folder, std::shared_ptr<const CameraModel> camera)
    : folder_(std::move(folder)),
      camera_(std::move(camera)),
      pairs_(readTumPairs(folder_)),
      broken_(std::make_unique<BrokenFrames>(folder_)) {
  const std::string truth = folder_ + "/groundtruth.txt";
  if (fs::exists(truth)) ground_truth_ = readTumTrajectory(truth);
}

TumSequence::~TumSequence() = default;
TumSequence::TumSequence(TumSequence&&) noexcept = default;

std::size_t TumSequence::skippedBroken() const { return broken_->count(); }

std::optional<RgbdFrame> TumSequence::next() {
  while (next_ < pairs_.size()) {
    try {
      RgbdFrame frame = read(next_++);
      broken_->countGood();
      return frame;
    } catch (const FileError& error) {
      broken_->countUnreadable(error.what());
    } catch (const Error& error) {
      broken_->countMisfit(error.what());
    }
  }
  broken_->countEnd();
  return std::nullopt;
}

RgbdFrame TumSequence::read(std::size_t index) const {
  const TumPair& pair = pairs_[index];
  const auto in_folder = [this](const std::string& file) { return (fs::path(folder_) / file).string(); };
  const cv::Mat bgr = readImageFile(in_folder(pair.rgb_file), cv::IMREAD_COLOR);
  const cv::Mat depth = readImageFile(in_folder(pair.depth_file), cv::IMREAD_UNCHANGED);
  if (depth.type() != CV_16UC1) {
    throw Error("depth image '" + in_folder(pair.depth_file) + "' must be 16-bit gray, in units of 1/5000 m");
  }
  try {
    return makeRgbdFrame(index, pair.rgb_stamp, bgr, depth, kTumDepthUnitM, camera_);
  } catch (const Error& error) {
    throw Error("'" + in_folder(pair.rgb_file) + "': " + error.what());
  }
}

cv::Mat1b TumSequence::groundTruthMask() const {
  if (next_ == 0 || next_ > pairs_.size()) return {};
  const fs::path name = fs::path(pairs_[next_ - 1].rgb_file).stem();
  const fs::path path = fs::path(folder_) / "mask" / (name.string() + ".png");
  if (!fs::exists(path)) return {};
  try {
    return readImageFile(path.string(), cv::IMREAD_GRAYSCALE);
  } catch (const FileError& error) {
    logWarning(error.what());
    return {};
  }
}

}  // namespace semantic_vslam
