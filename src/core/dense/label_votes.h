// SPDX-FileCopyrightText: 2026 The semantic_vslam authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <array>
#include <cstdint>

namespace semantic_vslam {

/// Votes for the label of one voxel, in 8 bytes. Four labels are counted at a time; when a fifth comes, all counts fall
/// by one (Misra and Gries 1982): a label with more than a fifth of the votes is never lost. Private to dense/.
class LabelVotes {
 public:
  void add(std::uint8_t label) {
    Slot* empty = nullptr;
    for (Slot& slot : slots_) {
      if (slot.count > 0 && slot.label == label) {
        increment(slot);
        return;
      }
      if (slot.count == 0 && empty == nullptr) empty = &slot;
    }
    if (empty != nullptr) {
      *empty = {label, 1};
    } else {
      for (Slot& slot : slots_) --slot.count;
    }
  }

  /// @return the label with most votes; the smallest such label on a tie, 0 where none was cast.
  std::uint8_t winner() const { return best().label; }
  /// @return share of the votes counted at present that are for the winner; 0 where none was cast
  double share() const {
    int all = 0;
    for (const Slot& slot : slots_) all += slot.count;
    return all == 0 ? 0.0 : static_cast<double>(best().count) / all;
  }

 private:
  struct Slot {
    std::uint8_t label = 0;
    std::uint8_t count = 0;
  };

  Slot best() const {
    Slot best{0, 0};
    for (const Slot& slot : slots_) {
      if (slot.count > best.count || (slot.count == best.count && slot.count > 0 && slot.label < best.label)) {
        best = slot;
      }
    }
    return best;
  }

  /// At the end of the range all counts are halved: their proportions stay, and newer votes weigh more.
  void increment(Slot& slot) {
    if (slot.count == 255) {
      for (Slot& each : slots_) each.count /= 2;
    }
    ++slot.count;
  }

  std::array<Slot, 4> slots_{};
};

}  // namespace semantic_vslam
