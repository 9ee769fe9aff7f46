// SPDX-FileCopyrightText: 2026 The semantic_vslam authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <memory>
#include <string>
#include <vector>

#include "core/io/frame_source.h"

namespace semantic_vslam {

class BrokenFrames;

/// A colour image and the depth image that goes with it; paths are relative to the sequence's folder, or absolute.
struct TumPair {
  Stamp rgb_stamp, depth_stamp;
  std::string rgb_file, depth_file;
};

/// Reads a folder in the format of the TUM RGB-D benchmark: `associations.txt` if there is one, else `rgb.txt` and
/// `depth.txt` paired by associateStamps(). Words may lie between commas, too. @return pairs in order of the colour
/// stamp; at least one.
/// @throws FileError naming the folder or list and what is wrong with it.
std::vector<TumPair> readTumPairs(const std::string& folder);

/// Sequence of the TUM RGB-D benchmark: colour images, 16-bit depth PNG in units of 1/5000 m, optional
/// `groundtruth.txt`, optional `mask/NAME.png` beside `rgb/NAME.*` (255 = moving).
class TumSequence : public FrameSource {
 public:
  /// @throws FileError as readTumPairs() and readTumTrajectory().
  TumSequence(std::string folder, std::shared_ptr<const CameraModel> camera);
  ~TumSequence() override;
  TumSequence(TumSequence&&) noexcept;

  std::optional<RgbdFrame> next() override;
  void skip(std::size_t count) override { next_ += count; }
  std::size_t size() const override { return pairs_.size(); }
  std::size_t skippedBroken() const override;
  std::shared_ptr<const CameraModel> camera() const override { return camera_; }
  const std::vector<TimedPose>& groundTruth() const override { return ground_truth_; }
  cv::Mat1b groundTruthMask() const override;

  /// The frame that next() returns is this one. @param index  into pairs()
  void seek(std::size_t index) { next_ = index; }
  const std::vector<TumPair>& pairs() const { return pairs_; }

 private:
  RgbdFrame read(std::size_t index) const;

  std::string folder_;
  std::shared_ptr<const CameraModel> camera_;
  std::vector<TumPair> pairs_;
  std::vector<TimedPose> ground_truth_;
  std::unique_ptr<BrokenFrames> broken_;
  std::size_t next_ = 0;
};

}  // namespace semantic_vslam
