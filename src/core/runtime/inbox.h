// SPDX-FileCopyrightText: 2026 The semantic_vslam authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <algorithm>
#include <cstddef>
#include <functional>
#include <mutex>
#include <utility>
#include <vector>

namespace semantic_vslam {

/// What other threads have for a stage, kept until the stage's own thread has time for it, in the order it came. A
/// stage that gets no frames asks for nothing: of more than kMost letters the oldest that may be lost goes.
template <class Stage>
class Inbox {
 public:
  using Letter = std::function<void(Stage&)>;
  static constexpr std::size_t kMost = 100;

  /// @param must_arrive  it comes seldom and is never said again, as a list of classes
  void put(Letter letter, bool must_arrive = false) {
    std::lock_guard<std::mutex> lock(mutex_);
    letters_.push_back({std::move(letter), must_arrive});
    if (letters_.size() <= kMost) return;
    const auto lost =
        std::find_if(letters_.begin(), letters_.end(), [](const Entry& entry) { return !entry.must_arrive; });
    if (lost != letters_.end()) letters_.erase(lost);
  }
  void deliver(Stage& stage) {
    std::vector<Entry> letters;
    {
      std::lock_guard<std::mutex> lock(mutex_);
      letters.swap(letters_);
    }
    for (const Entry& entry : letters) entry.letter(stage);
  }

 private:
  struct Entry {
    Letter letter;
    bool must_arrive = false;
  };

  std::mutex mutex_;
  std::vector<Entry> letters_;  // guarded by mutex_
};

}  // namespace semantic_vslam
