// SPDX-FileCopyrightText: 2026 The semantic_vslam authors
// SPDX-License-Identifier: BSD-3-Clause
#include "core/runtime/read_ahead.h"

#include <cassert>
#include <utility>

#include "core/runtime/this_thread.h"

namespace semantic_vslam {

ReadAhead::ReadAhead(std::unique_ptr<FrameSource> source, std::size_t frames)
    : source_(std::move(source)), items_(frames, QueuePolicy::kBlock) {}

ReadAhead::~ReadAhead() {
  items_.close();
  if (reader_.joinable()) reader_.join();
}

void ReadAhead::skip(std::size_t count) {
  assert(!reader_.joinable());
  source_->skip(count);
}

std::optional<RgbdFrame> ReadAhead::next() {
  if (!reader_.joinable()) reader_ = std::thread([this] { read(); });
  std::optional<Item> item = items_.pop();
  if (!item) return std::nullopt;  // past the end
  skipped_broken_ = item->skipped_broken;
  mask_ = item->mask;
  if (item->error) std::rethrow_exception(item->error);
  return std::move(item->frame);
}

void ReadAhead::read() {
  nameThread("slam_read_ahead");
  while (true) {
    Item item;
    try {
      item.frame = source_->next();
      if (item.frame) item.mask = source_->groundTruthMask();
    } catch (...) {
      item.frame.reset();
      item.error = std::current_exception();
    }
    item.skipped_broken = source_->skippedBroken();
    const bool last = !item.frame;
    if (!items_.push(std::move(item)) || last) break;
  }
  items_.close();
}

}  // namespace semantic_vslam
