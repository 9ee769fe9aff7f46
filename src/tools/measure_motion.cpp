// SPDX-FileCopyrightText: 2026 The semantic_vslam authors
// SPDX-License-Identifier: BSD-3-Clause
//
// Runs the motion stage alone over a TUM folder and measures it against the sequence's masks and ground truth.
#include <algorithm>
#include <cstdio>
#include <deque>
#include <filesystem>
#include <opencv2/imgproc.hpp>
#include <string>
#include <vector>

#include "core/common/arguments.h"
#include "core/common/config_arguments.h"
#include "core/common/progress.h"
#include "core/io/image_file.h"
#include "core/motion/flow_colour.h"
#include "core/motion/mask_picture.h"
#include "core/motion/motion_detector.h"
#include "eval/mask_score.h"
#include "eval/open_recording.h"
#include "semantic_vslam/core/common/error.h"
#include "semantic_vslam/core/common/stage_timing.h"

namespace semantic_vslam {
namespace {

constexpr char kUsage[] =
    "usage: measure_motion SEQUENCE_DIR --camera FILE [--set key=value ...] [--pictures DIR] [--every N]\n"
    "                      [--truth-masks SECONDS] [--mask-period N] [--frames N]\n"
    "  --set KEY=VALUE        a key of the motion stage, e.g. model=homography\n"
    "  --pictures DIR         write mask overlay, residual and flow of every N-th frame (--every, default 10)\n"
    "  --truth-masks SECONDS  feed the sequence's masks as person labels, this late (above 0), of every N-th frame\n"
    "                         (--mask-period, default 5)\n"
    "  --frames N             stop after N frames\n";

struct Options {
  std::string pictures;
  MotionConfig config;
  std::size_t every = 10, mask_period = 5;
  double mask_delay_s = -1.0;
};

Options readOptions(const Arguments& arguments) {
  Options options;
  applySettings(arguments, options.config);
  options.pictures = arguments.value("--pictures").value_or("");
  options.every = arguments.count("--every", options.every, 1);
  options.mask_period = arguments.count("--mask-period", options.mask_period, 1);
  if (arguments.has("--truth-masks")) options.mask_delay_s = arguments.positiveNumber("--truth-masks", 0.0);
  return options;
}

/// Error of the camera's motion between frames against the ground truth.
class MotionError {
 public:
  explicit MotionError(const std::vector<TimedPose>& truth) : truth_(truth) {}

  void add(Stamp previous, Stamp current, const MotionResult& result) {
    if (truth_.size() < 2 || result.model != MotionModel::kRigidFlow) return;
    const SE3 T_current_previous = poseAt(current).inverse() * poseAt(previous);
    const SE3 error = T_current_previous.inverse() * result.T_current_previous;
    translation_mm_.push_back(1e3 * error.translation().norm());
    rotation_deg_.push_back(rotationAngle(error) * 180.0 / CV_PI);
  }
  void print() const {
    if (translation_mm_.empty()) return;
    std::printf("camera motion a frame: translation error median %.2f p95 %.2f mm, rotation %.3f p95 %.3f deg\n",
                quantile(translation_mm_, 0.5), quantile(translation_mm_, 0.95), quantile(rotation_deg_, 0.5),
                quantile(rotation_deg_, 0.95));
  }

 private:
  SE3 poseAt(Stamp stamp) const {
    auto after = std::lower_bound(truth_.begin() + 1, truth_.end() - 1, stamp,
                                  [](const TimedPose& pose, Stamp s) { return pose.stamp < s; });
    const TimedPose& before = *(after - 1);
    const double span_s = secondsBetween(before.stamp, after->stamp);
    return interpolate(before.T_world_camera, after->T_world_camera, secondsBetween(before.stamp, stamp) / span_s);
  }

  const std::vector<TimedPose>& truth_;
  std::vector<double> translation_mm_, rotation_deg_;
};

/// Red: called dynamic. Green outline: true mask.
cv::Mat3b overlay(const RgbdFrame& frame, const cv::Mat1b& dynamic, const cv::Mat1b& truth) {
  cv::Mat3b picture = maskPicture(frame.bgr, dynamic);
  if (!truth.empty()) {
    std::vector<std::vector<cv::Point>> contours;
    cv::findContours(truth.clone(), contours, cv::RETR_LIST, cv::CHAIN_APPROX_SIMPLE);
    cv::drawContours(picture, contours, -1, cv::Scalar(0, 255, 0), 2);
  }
  return picture;
}

void writePictures(const std::string& folder, const RgbdFrame& frame, const MotionResult& result,
                   const cv::Mat1b& truth) {
  cv::Mat residual, panel;
  cv::Mat1b moving_px;
  cv::resize(result.moving, moving_px, frame.gray.size());
  cv::Mat left = overlay(frame, result.dynamic, truth), moving = overlay(frame, moving_px, {});
  if (result.residual_px.empty()) {
    residual = cv::Mat3b::zeros(frame.bgr.size());
  } else {
    cv::Mat1b scaled;
    result.residual_px.convertTo(scaled, CV_8U, 25.0);  // 10 px = white
    cv::resize(scaled, scaled, frame.bgr.size(), 0, 0, cv::INTER_NEAREST);
    cv::cvtColor(scaled, residual, cv::COLOR_GRAY2BGR);
  }
  cv::Mat flow = cv::Mat3b::zeros(frame.bgr.size());
  if (!result.flow_px.empty()) cv::resize(flowPicture(result.flow_px, 20.0), flow, frame.bgr.size());
  cv::Mat top, bottom;
  cv::hconcat(left, moving, top);
  cv::hconcat(residual, flow, bottom);
  cv::vconcat(top, bottom, panel);
  cv::resize(panel, panel, {}, 0.5, 0.5, cv::INTER_AREA);
  char name[32];
  std::snprintf(name, sizeof(name), "/%06d.png", static_cast<int>(frame.index));
  writeImageFile(folder + name, panel);
}

LabelSet personLabels() {
  LabelSet labels;
  labels.classes.push_back({"person", Mobility::kPerson, cv::Vec3b(0, 0, 255)});
  return labels;
}

struct LateMask {
  Stamp stamp;
  cv::Mat1b labels;
};

int run(const Arguments& arguments) {
  cv::setNumThreads(1);
  const Options options = readOptions(arguments);
  TumSequence sequence = openTumFolder(arguments);
  const std::size_t most_frames = arguments.count("--frames", sequence.size(), 1);
  MotionDetector detector(options.config);
  if (!options.pictures.empty()) std::filesystem::create_directories(options.pictures);
  const LabelSet label_set = personLabels();
  StageTimes times;
  MaskScore score;
  MotionError motion_error(sequence.groundTruth());
  std::deque<LateMask> late;
  std::vector<double> shares;
  std::size_t by_model[3] = {0, 0, 0};
  Stamp previous;
  Progress progress(std::min(most_frames, sequence.size()), "frames");
  while (auto frame = sequence.next()) {
    if (frame->index >= most_frames) break;
    progress.show(frame->index + 1);
    const cv::Mat1b truth = sequence.groundTruthMask();
    MotionResult result;
    {
      auto timer = times.scope("motion", frame->index);
      while (!late.empty() && secondsBetween(late.front().stamp, frame->stamp) >= options.mask_delay_s) {
        detector.addLabels(late.front().stamp, late.front().labels, label_set);
        late.pop_front();
      }
      result = detector.detect(*frame);
    }
    if (options.mask_delay_s >= 0.0 && !truth.empty() && frame->index % options.mask_period == 0) {
      late.push_back({frame->stamp, cv::Mat1b(truth / 255)});
    }
    if (!truth.empty()) score.add(result.dynamic, truth);
    shares.push_back(result.dynamic_share);
    ++by_model[static_cast<int>(result.model)];
    if (frame->index > 0) motion_error.add(previous, frame->stamp, result);
    previous = frame->stamp;
    if (!options.pictures.empty() && frame->index % options.every == 0) {
      writePictures(options.pictures, *frame, result, truth);
    }
  }
  progress.end();
  if (shares.empty()) throw FileError("none of the first " + std::to_string(most_frames) + " frames can be read");
  const StageSummary cpu = times.summarize().at(0);
  double mean_share = 0.0;
  for (const double share : shares) mean_share += share / static_cast<double>(shares.size());
  std::printf("frames %zu (none %zu, homography %zu, rigid flow %zu); CPU median %.2f p95 %.2f worst %.2f ms\n",
              shares.size(), by_model[0], by_model[1], by_model[2], cpu.cpu.median_ms, cpu.cpu.p95_ms,
              cpu.cpu.worst_ms);
  std::printf("called dynamic: mean %.2f %%, p95 %.2f %%, worst %.2f %% of the pixels\n", 100.0 * mean_share,
              100.0 * quantile(shares, 0.95), 100.0 * quantile(shares, 1.0));
  if (score.frames() > 0) {
    std::printf("against the masks: recall %.3f precision %.3f IoU %.3f\n", score.recall(), score.precision(),
                score.iou());
  }
  motion_error.print();
  return 0;
}

}  // namespace
}  // namespace semantic_vslam

int main(int argc, char** argv) {
  using namespace semantic_vslam;
  return runTool(argc, argv, kUsage, [&] {
    return run(Arguments(argc, argv,
                         {"--camera", "--set", "--pictures", "--every", "--truth-masks", "--mask-period", "--frames"},
                         {}, {1, 1}));
  });
}
