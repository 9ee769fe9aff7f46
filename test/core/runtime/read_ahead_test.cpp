// SPDX-FileCopyrightText: 2026 The semantic_vslam authors
// SPDX-License-Identifier: BSD-3-Clause
#include "core/runtime/read_ahead.h"

#include <gtest/gtest.h>

#include <atomic>
#include <chrono>
#include <thread>

#include "semantic_vslam/core/common/error.h"

namespace semantic_vslam {
namespace {

using namespace std::chrono_literals;

/// Ten numbered frames; the fifth read fails if so told, and the mask carries the frame's number.
class CountingSource : public FrameSource {
 public:
  explicit CountingSource(std::atomic<int>& reads, bool fails = false) : reads_(reads), fails_(fails) {}

  std::optional<RgbdFrame> next() override {
    if (next_ == size()) return std::nullopt;
    ++reads_;
    if (fails_ && next_ == 4) throw FileError("torn");
    RgbdFrame frame;
    frame.index = next_++;
    return frame;
  }
  void skip(std::size_t count) override { next_ += count; }
  std::size_t size() const override { return 10; }
  std::size_t skippedBroken() const override { return next_ / 5; }
  std::shared_ptr<const CameraModel> camera() const override { return nullptr; }
  const std::vector<TimedPose>& groundTruth() const override { return truth_; }
  cv::Mat1b groundTruthMask() const override { return cv::Mat1b(1, 1, static_cast<uchar>(next_ - 1)); }

 private:
  std::atomic<int>& reads_;
  const bool fails_;
  std::size_t next_ = 0;
  std::vector<TimedPose> truth_;
};

TEST(ReadAhead, GivesTheSameFramesWithTheirMasksInOrder) {
  std::atomic<int> reads{0};
  ReadAhead ahead(std::make_unique<CountingSource>(reads), 3);
  ahead.skip(2);
  for (std::uint64_t i = 2; i < 10; ++i) {
    const auto frame = ahead.next();
    ASSERT_TRUE(frame);
    EXPECT_EQ(frame->index, i);
    EXPECT_EQ(ahead.groundTruthMask()(0, 0), i);
    EXPECT_EQ(ahead.skippedBroken(), (i + 1) / 5) << "as if nothing had been read beyond this frame";
  }
  EXPECT_FALSE(ahead.next());
  EXPECT_FALSE(ahead.next()) << "the end stays the end";
}

TEST(ReadAhead, ReadsNoFartherThanAsked) {
  std::atomic<int> reads{0};
  {
    ReadAhead ahead(std::make_unique<CountingSource>(reads), 3);
    ASSERT_TRUE(ahead.next());
    const auto give_up = std::chrono::steady_clock::now() + 10s;
    while (reads < 5 && std::chrono::steady_clock::now() < give_up) std::this_thread::sleep_for(1ms);
    std::this_thread::sleep_for(20ms);
    EXPECT_EQ(reads, 5) << "one taken, three in the queue, one in hand";
  }
  EXPECT_EQ(reads, 5) << "given up without reading the rest";
}

TEST(ReadAhead, AnErrorComesInItsPlace) {
  std::atomic<int> reads{0};
  ReadAhead ahead(std::make_unique<CountingSource>(reads, true), 3);
  for (int i = 0; i < 4; ++i) EXPECT_TRUE(ahead.next());
  EXPECT_THROW(ahead.next(), FileError);
  EXPECT_FALSE(ahead.next());
}

}  // namespace
}  // namespace semantic_vslam
