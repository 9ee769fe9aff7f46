// SPDX-FileCopyrightText: 2026 The semantic_vslam authors
// SPDX-License-Identifier: BSD-3-Clause
#include "core/motion/motion_memory.h"

#include <algorithm>
#include <cmath>

#include "core/motion/flow_carry.h"

namespace semantic_vslam {
namespace {

// Log-odds of a cell nothing is known of: most of a room stands still.
constexpr float kPrior = -0.5F;
// Bounds, so that no cell is ever too sure to change its mind within half a second.
constexpr float kLowest = -2.5F, kHighest = 3.0F;
// Evidence of one frame. Neighbouring frames share their errors, so it is far below what independent noise would allow.
constexpr float kFlowMoves = 0.9F;   // full residual, brightness agrees
constexpr float kFlowStays = -0.3F;  // textured and where the rigid flow says: weak, people pause
constexpr float kEntered = 2.4F;     // in space that was free; each cell is compared in every second frame
constexpr float kStayed = -0.5F;     // where it was in an earlier depth image
// The same by keyframes. Each cell is compared in every third frame only.
constexpr float kEnteredRoom = 3.0F, kStayedRoom = -0.75F;
// Residuals: from kSilent sigmas on the flow speaks for motion, at kFull fully.
constexpr float kStaysSigmas = 2.0F, kSilentSigmas = 3.0F, kFullSigmas = 7.0F;
// From here on a cell was surely seen to move. Then neither time nor a flow that agrees with the room clears it: people
// pause. Only a surface that keyframes or frames of the last seconds saw at rest there does.
constexpr float kHeld = 1.0F;
constexpr float kTexture = 4.0F;  // gray levels per cell at which a flow that agrees says something

/// Without branches, so that it runs four cells at a time. @param sigmas  NaN = unknown
float flowEvidence(float sigmas, float gain, float texture, bool held) {
  const float rise = (sigmas - kSilentSigmas) * (1.0F / (kFullSigmas - kSilentSigmas));
  const float strength = rise > 0.0F ? std::min(rise, 1.0F) : 0.0F;  // 0 for NaN
  const float moves = (gain > 0.0F ? kFlowMoves : -kFlowStays) * strength * gain;
  const float stays = texture > kTexture && !held ? kFlowStays : 0.0F;
  return sigmas < kStaysSigmas ? stays : moves;
}

}  // namespace

MotionMemory::MotionMemory(const MotionMemoryConfig& config) : config_(config) {}

void MotionMemory::reset(cv::Size grid_size) { log_odds_ = cv::Mat1f(grid_size, kPrior); }

void MotionMemory::fade(cv::Mat1f carried, double age_s) {
  const auto keep = static_cast<float>(std::exp(-age_s / config_.time_constant_s));
  const auto leak = static_cast<float>((kHighest - kHeld) * age_s / config_.hold_s);
  changeCells(carried,
              [keep, leak](float value) { return value > kHeld ? value - leak : kPrior + keep * (value - kPrior); });
  log_odds_ = carried;
}

void MotionMemory::carry(const cv::Mat2f& source, double dt_s) { fade(carryAlong(log_odds_, source, kPrior), dt_s); }

void MotionMemory::carry(const cv::Mat2f& source, double dt_s, const RigidFlowResidual& residual,
                         const cv::Mat1f& brightness_gain) {
  cv::Mat1f carried = carryAlong(log_odds_, source, kPrior);
  const auto right = static_cast<float>(carried.cols - 1), bottom = static_cast<float>(carried.rows - 1);
  for (int y = 0; y < carried.rows; ++y) {
    const float *sigmas = residual.sigmas[y], *gains = brightness_gain[y];
    const uchar* hidden = residual.hidden[y];
    const cv::Vec2f* previous = residual.previous[y];
    float* out = carried[y];
    for (int x = 0; x < carried.cols; ++x) {
      // Below a sigma both come from the same place.
      if (sigmas[x] < 1.0F && hidden[x] == 0) continue;
      const cv::Vec2f at = previous[x];
      if (!(at[0] >= 0.0F && at[1] >= 0.0F && at[0] <= right && at[1] <= bottom)) continue;
      const float if_still = hidden[x] != 0 ? kPrior : sampleBilinear(log_odds_, at[0], at[1]);
      const float if_moving = out[x], gain = gains[x];
      const float undecided = std::min(if_still, if_moving);
      const float decided = gain > 0.0F ? if_moving : if_still;
      out[x] = undecided + std::abs(gain) * (decided - undecided);
    }
  }
  fade(carried, dt_s);
}

void MotionMemory::add(const GridFrame& current, const RigidFlowResidual& residual, const cv::Mat1f& brightness_gain,
                       const DepthVote& vote, const DepthVote& room) {
  const bool voted = !vote.entered.empty(), in_room = !room.entered.empty();
  for (int y = 0; y < log_odds_.rows; ++y) {
    const float *sigmas = residual.sigmas[y], *gain = brightness_gain[y], *texture = current.texture[y];
    const float *entered = voted ? vote.entered[y] : nullptr, *stayed = voted ? vote.stayed[y] : nullptr;
    const float *came = in_room ? room.entered[y] : nullptr, *rests = in_room ? room.stayed[y] : nullptr;
    const uchar* hidden = residual.hidden[y];
    float* out = log_odds_[y];
    for (int x = 0; x < log_odds_.cols; ++x) {
      const float by_flow = flowEvidence(sigmas[x], gain[x], texture[x], out[x] > kHeld);
      const float by_depth = voted ? kEntered * entered[x] + kStayed * stayed[x] : 0.0F;
      const float by_room = in_room ? kEnteredRoom * came[x] + kStayedRoom * rests[x] : 0.0F;
      const float sum = out[x] + (hidden[x] == 0 ? by_flow : 0.0F) + by_depth + by_room;
      out[x] = std::min(std::max(sum, kLowest), kHighest);
    }
  }
}

}  // namespace semantic_vslam
