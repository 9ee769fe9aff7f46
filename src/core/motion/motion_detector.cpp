// SPDX-FileCopyrightText: 2026 The semantic_vslam authors
// SPDX-License-Identifier: BSD-3-Clause
#include "core/motion/motion_detector.h"

#include <cmath>
#include <opencv2/imgproc.hpp>

#include "core/motion/flow_carry.h"
#include "core/motion/homography_motion.h"
#include "core/motion/mask_cleanup.h"
#include "core/motion/rigid_flow.h"
#include "core/motion/surface_evidence.h"
#include "semantic_vslam/core/common/config_fields.h"

namespace semantic_vslam {
namespace {

// Above this step, below 8 frames a second, there is time for a dearer flow and for all that depth can say, and both
// pay: at 5 Hz they find a fifth more of who walks. At 10 Hz the flow was better in one recording and worse in another.
constexpr double kSlowStepS = 0.12;
// Number of earlier depth images that the present one is compared with, spread over the configured age.
constexpr int kReferences = 4;
// Trust left in a cell that surely moves: if everything seems to move, the least moving still counts.
constexpr float kLeastTrust = 0.01F;
// Three keyframes that saw a surface at rest, whatever labels said of it, make it known.
constexpr float kKnownStep = 0.3F, kSurelyKnown = 0.85F;
// What is left of a label there: it still weighs in the pose, a little less than what nobody calls a person.
constexpr float kGivesWay = 0.4F;

MotionConfig validated(const MotionConfig& config) {
  validateConfig(config);
  return config;
}

/// @param semantic  NaN = unknown
void raiseTo(const cv::Mat1f& semantic, cv::Mat1f& dynamic) {
  for (int y = 0; y < dynamic.rows; ++y) {
    const float* from = semantic[y];
    float* to = dynamic[y];
    for (int x = 0; x < dynamic.cols; ++x) to[x] = from[x] > to[x] ? from[x] : to[x];
  }
}

/// Log-odds to 0 .. 1, with 0 at 0.5: the logistic function's slope there, without its cost.
float squash(float log_odds) { return 0.5F + 0.25F * log_odds / (1.0F + 0.5F * std::abs(log_odds)); }

/// @param moving  255 = moving; empty: nothing is known  @param log_odds  may be empty
/// @return 0 .. 1, grid size
cv::Mat1f movingProbability(const cv::Mat1b& moving, const cv::Mat1f& log_odds, cv::Size grid_size) {
  cv::Mat1f probability(grid_size, 0.0F);
  if (moving.empty()) return probability;
  for (int y = 0; y < grid_size.height; ++y) {
    const uchar* moves = moving[y];
    const float* odds = log_odds.empty() ? nullptr : log_odds[y];
    float* out = probability[y];
    for (int x = 0; x < grid_size.width; ++x) {
      const float evidence = odds != nullptr ? squash(odds[x]) : moves[x] != 0 ? 0.9F : 0.1F;
      // The cleaned mask decides; the evidence says how surely.
      out[x] = moves[x] != 0 ? std::max(evidence, 0.55F) : std::min(evidence, 0.45F);
    }
  }
  return probability;
}

/// Adds what carried masks say. A fresh mask outweighs the surest evidence of rest, one that is a second old does
/// not any more: so a coarse mask that holds a piece of desk, or one that went astray, is corrected, and who stands
/// still in front of the camera stays out as long as the network says so. That something is no person does not stop it
/// from moving, but in holes, where motion is only guessed from what lies around.
/// @param semantic  faded with the mask's age, NaN = unknown  @param log_odds  of motion; empty: nothing is known
/// @param depth_m  0 = hole
void addMasks(const cv::Mat1f& semantic, const cv::Mat1f& log_odds, const cv::Mat1f& depth_m, cv::Mat1f& dynamic) {
  constexpr float kFreshMask = 4.0F;  // log-odds
  for (int y = 0; y < dynamic.rows; ++y) {
    const float *mask = semantic[y], *odds = log_odds.empty() ? nullptr : log_odds[y], *depth = depth_m[y];
    float* out = dynamic[y];
    for (int x = 0; x < dynamic.cols; ++x) {
      const bool person = mask[x] > 0.5F, nobody_in_hole = mask[x] < 0.5F && depth[x] <= 0.0F;
      if (!person && !nobody_in_hole) continue;
      const float together = squash(kFreshMask * (2.0F * mask[x] - 1.0F) + (odds != nullptr ? odds[x] : 0.0F));
      out[x] = person ? std::max(out[x], together) : std::min(out[x], together);
    }
  }
}

/// Velocity scaled to another time step.
SE3 scaleMotion(const SE3& motion, double factor) { return se3Exp(factor * se3Log(motion)); }

}  // namespace

MotionDetector::MotionDetector(const MotionConfig& config, const RemovalConfig& removal)
    : config_(validated(config)),
      quick_flow_(config.flow.preset),
      slow_flow_(config.flow.slow_preset),
      memory_(config.memory),
      propagation_(config.semantics, removal),
      room_(config.room) {}

void MotionDetector::setConfig(const MotionConfig& config) {
  validateConfig(config);
  if (config.model != config_.model || config.flow.width_px != config_.flow.width_px) reset();
  config_ = config;
  quick_flow_ = DenseFlow(config.flow.preset);
  slow_flow_ = DenseFlow(config.flow.slow_preset);
  memory_.setConfig(config.memory);
  room_.setConfig(config.room);
  propagation_.setConfig(config.semantics);
}

void MotionDetector::reset() {
  room_.clear();
  forgetFrames();
}

void MotionDetector::forgetFrames() {
  room_.breakOdometry();
  propagation_.reset();
  label_memory_.clear();
  grid_.reset();
  camera_.reset();
  previous_ = {};
  references_.clear();
  turn_ = 0;
  first_row_ = 0;
  velocity_ = T_odometry_camera_ = SE3::Identity();
  velocity_dt_s_ = 0.0;
}

void MotionDetector::start(const RgbdFrame& frame) {
  if (frame.camera != camera_) room_.clear();
  forgetFrames();
  camera_ = frame.camera;
  grid_ = std::make_unique<WorkGrid>(frame.camera, config_.flow.width_px);
  memory_.reset(grid_->size());
  dynamic_probability_ = cv::Mat1f(grid_->size(), 0.0F);
}

bool MotionDetector::addLabels(Stamp stamp, const cv::Mat1b& labels, const LabelSet& label_set) {
  return propagation_.addLabels(stamp, labels, label_set, [this](const cv::Mat1f& dynamic, const PlacedFrame& place) {
    return label_memory_.weigh(dynamic, place, *grid_, config_.rigid);
  });
}

MotionResult MotionDetector::detect(const RgbdFrame& frame) {
  const cv::Size full_size = frame.gray.size();
  const double dt_s = grid_ ? secondsBetween(previous_.stamp, frame.stamp) : 0.0;
  if (!grid_ || frame.camera != camera_ || dt_s <= 0.0 || dt_s > kLongestGapS) {
    start(frame);
    previous_ = makeGridFrame(frame, *grid_);
    propagation_.addFrame(frame.stamp, grid_->size(), {});
    if (config_.model == "rigid_flow") {
      propagation_.setPlace(placed(previous_));
      room_.addFrame(placed(previous_), previous_.depth_low_m, cv::Mat1b::zeros(grid_->size()), {});
    }
    MotionResult first;
    first.told = config_.model == "none";
    first.dynamic = cv::Mat1b::zeros(full_size);
    first.moving = cv::Mat1b::zeros(grid_->size());
    return first;
  }
  const GridFrame current = makeGridFrame(frame, *grid_);
  const cv::Mat2f flow_cells = flowFor(current).compute(previous_.cell_gray, current.cell_gray);
  const cv::Mat2f source = traceBack(flow_cells, previous_.depth_m, current.surface_m, dt_s);
  propagation_.addFrame(frame.stamp, grid_->size(), source);
  cv::Mat1f semantic = propagation_.dynamicNow();
  const cv::Mat1f said = semantic.clone();  // what gives way has been said all the same
  giveWay(source, semantic);
  const cv::Mat1f static_weight = staticWeight(source, semantic);

  Estimate estimate;
  if (config_.model == "homography") estimate = explainByHomography(current, flow_cells, static_weight);
  if (config_.model == "rigid_flow") estimate = explainByRigidFlow(current, flow_cells, source, static_weight);
  const SurfaceEvidence surface = shareAlongSurfaces(estimate.log_odds, semantic, current.depth_m);
  if (!surface.log_odds.empty()) {
    estimate.log_odds = surface.log_odds;
    estimate.moving = cleanMask(surface.log_odds > 0.0F, grid_->cellPx(), config_.cleanup);
  }
  propagation_.setMoving(estimate.moving);

  const MotionResult result = compose(current, estimate, flow_cells, surface.semantic, full_size);
  if (config_.model == "rigid_flow") {
    propagation_.setPlace(placed(current));
    keepReference(current);
    room_.addFrame(placed(current), current.depth_low_m, result.moving, said);
  }
  previous_ = current;
  return result;
}

bool MotionDetector::isSlow(const GridFrame& current) const {
  return secondsBetween(previous_.stamp, current.stamp) > kSlowStepS;
}

DenseFlow& MotionDetector::flowFor(const GridFrame& current) { return isSlow(current) ? slow_flow_ : quick_flow_; }

cv::Mat1f MotionDetector::staticWeight(const cv::Mat2f& source, const cv::Mat1f& semantic) const {
  constexpr float kNewCell = 0.3F;  // what comes into view may be anything
  cv::Mat1f dynamic = carryAlong(dynamic_probability_, source, kNewCell);
  if (!semantic.empty()) raiseTo(semantic, dynamic);
  changeCells(dynamic, [](float value) { return std::max(kLeastTrust, (1.0F - value) * (1.0F - value)); });
  return dynamic;
}

MotionDetector::Estimate MotionDetector::explainByHomography(const GridFrame& current, const cv::Mat2f& flow_cells,
                                                             const cv::Mat1f& static_weight) {
  Estimate estimate;
  const HomographyMotion motion = estimateHomography(current, flow_cells, static_weight, *grid_, config_.homography);
  if (!motion.valid) return estimate;
  const cv::Mat2f residual = flowFor(current).compute(warpPrevious(previous_, current, motion), current.cell_gray);
  estimate.model = MotionModel::kHomography;
  estimate.inliers = motion.inliers;
  estimate.residual_px = flowAmplitude(residual) * grid_->cellPx();  // eq. (1)
  estimate.moving = cleanMask(estimate.residual_px > config_.homography.theta_px, grid_->cellPx(), config_.cleanup);
  return estimate;
}

MotionDetector::Estimate MotionDetector::explainByRigidFlow(const GridFrame& current, const cv::Mat2f& flow_cells,
                                                            const cv::Mat2f& source, const cv::Mat1f& static_weight) {
  const double dt_s = secondsBetween(previous_.stamp, current.stamp);
  const SE3 predicted = velocity_dt_s_ > 0.0 ? scaleMotion(velocity_, dt_s / velocity_dt_s_) : SE3::Identity();
  const auto points = selectFlowPoints(previous_, current, flow_cells, static_weight, *grid_);
  const CameraMotion camera = estimateCameraMotion(points, *grid_, predicted, dt_s, config_.rigid);
  if (!camera.valid) {
    // Too little depth, or nothing that stands still: a homography is the better guess, and the past is of no use.
    references_.clear();
    propagation_.forgetPlaces();
    label_memory_.clear();
    room_.breakOdometry();
    velocity_dt_s_ = 0.0;
    memory_.carry(source, dt_s);
    return explainByHomography(current, flow_cells, static_weight);
  }
  velocity_ = camera.T_previous_current;
  velocity_dt_s_ = dt_s;
  T_odometry_camera_ = T_odometry_camera_ * camera.T_previous_current;

  Estimate estimate;
  const RigidFlowResidual residual =
      computeRigidFlowResidual(previous_, current, flow_cells, camera, *grid_, config_.rigid);
  const cv::Mat1f gain = compareBrightness(previous_, current, flow_cells, residual);
  memory_.carry(source, dt_s, residual, gain);
  const DepthVote vote = askReferences(current);
  const RoomVote room = room_.look(placed(current), *grid_, config_.rigid).value_or(RoomVote{});
  learnKnown(room);
  memory_.add(current, residual, gain, vote, room);
  estimate.model = MotionModel::kRigidFlow;
  estimate.camera = camera;
  estimate.inliers = camera.inliers;
  estimate.residual_px = residual.amplitude_px;
  estimate.log_odds = memory_.logOdds();
  return estimate;
}

DepthVote MotionDetector::askReferences(const GridFrame& current) {
  DepthVote vote;
  if (references_.empty()) return vote;
  if (!isSlow(current)) {
    // One reference a frame, in turn, and every second row of it: the evidence gathers over frames and along surfaces.
    turn_ = (turn_ + 1) % references_.size();
    first_row_ = 1 - first_row_;
    return voteByDepth(placed(current), references_[turn_], *grid_, config_.rigid, {first_row_, 2});
  }
  // Few frames see somebody pass: all at once.
  vote = {cv::Mat1f(grid_->size(), 0.0F), cv::Mat1f(grid_->size(), 0.0F)};
  for (const DepthReference& reference : references_) {
    const DepthVote one = voteByDepth(placed(current), reference, *grid_, config_.rigid);
    vote.entered = cv::min(vote.entered + one.entered, 1.0F);
    vote.stayed = cv::min(vote.stayed + one.stayed, 1.0F);
  }
  return vote;
}

void MotionDetector::giveWay(const cv::Mat2f& source, cv::Mat1f& semantic) {
  if (semantic.empty()) {
    known_.release();
    return;
  }
  known_ = known_.empty() ? cv::Mat1f(grid_->size(), 0.0F) : carryAlong(known_, source, 0.0F);
  for (int y = 0; y < semantic.rows; ++y) {
    const float* known = known_[y];
    float* mask = semantic[y];
    for (int x = 0; x < semantic.cols; ++x) {
      if (known[x] > kSurelyKnown && mask[x] > kGivesWay) mask[x] = kGivesWay;
    }
  }
}

void MotionDetector::learnKnown(const RoomVote& vote) {
  if (known_.empty()) return;
  const cv::Mat1f& moves = memory_.logOdds();
  for (int y = 0; y < known_.rows; ++y) {
    const float *says = vote.known.empty() ? nullptr : vote.known[y], *odds = moves[y];
    float* known = known_[y];
    for (int x = 0; x < known_.cols; ++x) {
      const float learnt = says != nullptr ? kKnownStep * says[x] : 0.0F;
      known[x] = odds[x] > 0.0F ? 0.0F : std::clamp(known[x] + learnt, 0.0F, 1.0F);
    }
  }
}

PlacedFrame MotionDetector::placed(const GridFrame& current) const {
  return {current.stamp, current.depth_m, current.surface_m, T_odometry_camera_};
}

void MotionDetector::keepReference(const GridFrame& current) {
  const double spacing_s = config_.memory.reference_age_s / kReferences;
  if (!references_.empty() && secondsBetween(references_.back().place.stamp, current.stamp) < spacing_s) return;
  references_.push_back({placed(current), current.depth_low_m, dynamic_probability_.clone()});
  if (references_.size() > kReferences) references_.pop_front();
}

MotionResult MotionDetector::compose(const GridFrame& current, const Estimate& estimate, const cv::Mat2f& flow_cells,
                                     const cv::Mat1f& semantic, cv::Size full_size) {
  dynamic_probability_ = movingProbability(estimate.moving, estimate.log_odds, grid_->size());
  MotionResult result;
  dynamic_probability_.convertTo(result.moving, CV_8U, 255.0);
  if (!semantic.empty()) addMasks(semantic, estimate.log_odds, current.depth_m, dynamic_probability_);
  cv::Mat1b dynamic_cells;
  dynamic_probability_.convertTo(dynamic_cells, CV_8U, 255.0);
  cv::resize(dynamic_cells, result.dynamic, full_size, 0, 0, cv::INTER_LINEAR);
  result.flow_px = flow_cells * grid_->cellPx();
  result.residual_px = estimate.residual_px;
  result.model = estimate.model;
  result.T_current_previous = estimate.camera.T_previous_current.inverse();
  result.inliers = estimate.inliers;
  result.told = estimate.model != MotionModel::kNone || config_.model == "none";
  result.labels = propagation_.maskStamp();
  result.dynamic_share = static_cast<double>(cv::countNonZero(dynamic_cells >= 128)) / dynamic_cells.total();
  return result;
}

}  // namespace semantic_vslam
