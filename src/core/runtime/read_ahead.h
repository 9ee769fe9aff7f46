// SPDX-FileCopyrightText: 2026 The semantic_vslam authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <exception>
#include <memory>
#include <thread>

#include "core/io/frame_source.h"
#include "core/runtime/bounded_queue.h"

namespace semantic_vslam {

/// Reads another source ahead on a thread of its own, so that decoding does not hold up who takes the frames: a camera
/// does not wait for files either. Gives the same frames in the same order.
class ReadAhead : public FrameSource {
 public:
  /// @param source  not to be used by anyone else from here on
  /// @param frames  decoded ahead at most; 2.5 MB each at 640x480
  ReadAhead(std::unique_ptr<FrameSource> source, std::size_t frames);
  ~ReadAhead() override;

  /// The first call starts to read. @throws what the source threw at this place
  std::optional<RgbdFrame> next() override;
  /// Only before the first next().
  void skip(std::size_t count) override;
  std::size_t size() const override { return source_->size(); }
  std::size_t skippedBroken() const override { return skipped_broken_; }
  std::shared_ptr<const CameraModel> camera() const override { return source_->camera(); }
  const std::vector<TimedPose>& groundTruth() const override { return source_->groundTruth(); }
  cv::Mat1b groundTruthMask() const override { return mask_; }

 private:
  struct Item {
    std::optional<RgbdFrame> frame;  ///< none: the end, or the error that ended it
    cv::Mat1b mask;
    std::size_t skipped_broken = 0;
    std::exception_ptr error;
  };

  void read();

  const std::unique_ptr<FrameSource> source_;  // its frames are the reader's; what never changes is everyone's
  cv::Mat1b mask_;                             // of the frame returned last
  std::size_t skipped_broken_ = 0;
  BoundedQueue<Item> items_;
  std::thread reader_;
};

}  // namespace semantic_vslam
