// SPDX-FileCopyrightText: 2026 The semantic_vslam authors
// SPDX-License-Identifier: BSD-3-Clause
#include "core/pipeline/slam_runner.h"

#include <utility>

namespace semantic_vslam {
namespace {

// As many as wait before a nodelet by default: a sixth of a second.
constexpr std::size_t kWaitingFrames = 5;
// Observed frames wait for tracking, and motion waits with the next: what is to be lost is lost before it cost
// anything.
constexpr std::size_t kWaitingObserved = 2;

}  // namespace

SlamRunner::SlamRunner(SlamSystem& system, Sink sink)
    : system_(system),
      sink_(std::move(sink)),
      frames_(kWaitingFrames, QueuePolicy::kDropOldest),
      observed_(kWaitingObserved, QueuePolicy::kBlock),
      observer_([this] { guarded([this] { observe(); }); }),
      tracker_([this] { guarded([this] { track(); }); }) {}

SlamRunner::~SlamRunner() { join(); }

void SlamRunner::finish() {
  join();
  if (error_) std::rethrow_exception(std::exchange(error_, nullptr));
}

void SlamRunner::join() {
  frames_.close();
  if (observer_.joinable()) observer_.join();
  observed_.close();
  if (tracker_.joinable()) tracker_.join();
}

void SlamRunner::guarded(const std::function<void()>& work) {
  try {
    work();
  } catch (...) {
    {
      std::lock_guard<std::mutex> lock(error_mutex_);
      if (!error_) error_ = std::current_exception();
    }
    frames_.close();
    observed_.close();
  }
}

void SlamRunner::observe() {
  while (const std::optional<RgbdFrame> frame = frames_.pop()) {
    std::optional<ObservedFrame> observed = system_.observe(*frame);
    if (observed && !observed_.push(std::move(*observed))) return;
  }
}

void SlamRunner::track() {
  while (std::optional<ObservedFrame> observed = observed_.pop()) {
    const RgbdFrame frame = observed->frame;
    sink_(frame, system_.track(std::move(*observed)));
  }
}

}  // namespace semantic_vslam
