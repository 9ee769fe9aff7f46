// SPDX-FileCopyrightText: 2026 The semantic_vslam authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <functional>
#include <mutex>
#include <utility>
#include <vector>

namespace semantic_vslam {

/// What other threads have for a stage, kept until the stage's own thread has time for it, in the order it came. Of
/// more than kMost the oldest go: a stage that gets no frames asks for nothing.
template <class Stage>
class Inbox {
 public:
  using Letter = std::function<void(Stage&)>;
  static constexpr std::size_t kMost = 100;

  void put(Letter letter) {
    std::lock_guard<std::mutex> lock(mutex_);
    letters_.push_back(std::move(letter));
    if (letters_.size() > kMost) letters_.erase(letters_.begin());
  }
  void deliver(Stage& stage) {
    std::vector<Letter> letters;
    {
      std::lock_guard<std::mutex> lock(mutex_);
      letters.swap(letters_);
    }
    for (const Letter& letter : letters) letter(stage);
  }

 private:
  std::mutex mutex_;
  std::vector<Letter> letters_;  // guarded by mutex_
};

}  // namespace semantic_vslam
