// SPDX-FileCopyrightText: 2026 The semantic_vslam authors
// SPDX-License-Identifier: BSD-3-Clause
//
// Runs network and refinement over a TUM folder and measures both against its true masks or labels.
#include <algorithm>
#include <cstdint>
#include <cstdio>
#include <filesystem>
#include <opencv2/imgcodecs.hpp>
#include <opencv2/imgproc.hpp>
#include <string>
#include <vector>

#include "core/common/arguments.h"
#include "core/common/config_arguments.h"
#include "core/common/progress.h"
#include "core/io/image_file.h"
#include "core/segmentation/depth_refinement.h"
#include "core/segmentation/label_picture.h"
#include "core/segmentation/onnx_segmenter.h"
#include "eval/mask_score.h"
#include "eval/open_recording.h"
#include "semantic_vslam/core/common/error.h"
#include "semantic_vslam/core/common/stage_timing.h"

namespace {

using namespace semantic_vslam;
namespace fs = std::filesystem;

constexpr const char* kUsage =
    "usage: measure_segmentation SEQUENCE_DIR --camera FILE (--set model=FILE.onnx | --dilate PX) [options]\n"
    "Truth: SEQUENCE_DIR/labels/*.png (numbered as the network's sidecar lists its labels, person = 1) or mask/*.png\n"
    "(255 = person).\n"
    "  --set KEY=VALUE  a key of the segmentation stage, e.g. refinement.epsilon=3\n"
    "  --dilate PX      true masks, made this much larger, take the network's place: the refinement alone\n"
    "  --every N        every N-th frame (10)\n"
    "  --pictures DIR   overlays: the network's labels on the left, refined on the right, true people outlined\n";

/// A labelled point farther than this from any point of its object is no question of the contact line: feet on the
/// floor and a cup on a table have no depth edge there.
constexpr float kFarM = 0.05F;
constexpr int kSearchPx = 24;  ///< around a point, for its object

/// Whether no pixel of the same true label nearby has a point within kFarM.
bool isFar(const cv::Point& p, std::uint8_t label, const cv::Mat1b& truth, const RgbdFrame& frame) {
  const auto pointAt = [&frame](int u, int v) {
    const cv::Vec2f ray = frame.camera->rays()(v, u);
    return cv::Vec3f(ray[0], ray[1], 1.0F) * frame.depth_m(v, u);
  };
  const cv::Vec3f here = pointAt(p.x, p.y);
  const cv::Rect window =
      cv::Rect(p.x - kSearchPx, p.y - kSearchPx, 2 * kSearchPx + 1, 2 * kSearchPx + 1) & cv::Rect({0, 0}, truth.size());
  for (int v = window.y; v < window.br().y; ++v) {
    for (int u = window.x; u < window.br().x; ++u) {
      if (truth(v, u) == label && frame.depth_m(v, u) > 0.0F && cv::norm(pointAt(u, v) - here) < kFarM) return false;
    }
  }
  return true;
}

/// Labelled points that lie off the object they are labelled as, and object points that lost their label.
struct PointErrors {
  double labelled = 0.0, off = 0.0, far = 0.0, real = 0.0, lost = 0.0;

  void add(const cv::Mat1b& labels, const cv::Mat1b& truth, const RgbdFrame& frame) {
    for (int v = 0; v < labels.rows; ++v) {
      for (int u = 0; u < labels.cols; ++u) {
        if (frame.depth_m(v, u) == 0.0F) continue;
        const std::uint8_t label = labels(v, u), real_label = truth(v, u);
        labelled += label != 0;
        real += real_label != 0;
        lost += real_label != 0 && label != real_label;
        if (label == 0 || label == real_label) continue;
        ++off;
        far += isFar({u, v}, label, truth, frame);
      }
    }
  }
  double offShare() const { return off / std::max(labelled, 1.0); }
  double farShare() const { return far / std::max(labelled, 1.0); }
  double lostShare() const { return lost / std::max(real, 1.0); }
};

/// Scores of each label, before and after refinement.
class LabelScores {
 public:
  explicit LabelScores(const LabelSet& set) : set_(set), scores_(set.classes.size()) {}

  void add(const cv::Mat1b& before, const cv::Mat1b& refined, const cv::Mat1b& truth) {
    for (std::size_t label = 0; label < scores_.size(); ++label) {
      const auto id = static_cast<double>(label);
      const cv::Mat1b real = truth == id;
      scores_[label].before.add(before == id, real);
      scores_[label].refined.add(refined == id, real);
      scores_[label].occurs |= cv::countNonZero(real) > 0;
    }
  }
  const MaskScore& peopleBefore() const { return scores_[kPerson].before; }
  const MaskScore& peopleRefined() const { return scores_[kPerson].refined; }

  /// The labels that the truth has; their mean as usual, with the background as one of them (Everingham et al., "The
  /// PASCAL Visual Object Classes Challenge", IJCV 2010), and without it.
  void print() const {
    Mean all, labels;
    for (std::size_t label = 0; label < scores_.size(); ++label) {
      const Score& score = scores_[label];
      if (!score.occurs) continue;
      std::printf("%-10s IoU %.3f, refined %.3f\n", set_.classes[label].name.c_str(), score.before.iou(),
                  score.refined.iou());
      all.add(score);
      if (label != 0) labels.add(score);
    }
    if (labels.count <= 1) return;
    all.print("");
    labels.print(", without background");
  }

 private:
  static constexpr std::size_t kPerson = 1;  // of the truth
  struct Score {
    MaskScore before, refined;
    bool occurs = false;
  };
  struct Mean {
    int count = 0;
    double before = 0.0, refined = 0.0;

    void add(const Score& score) {
      ++count;
      before += score.before.iou();
      refined += score.refined.iou();
    }
    void print(const char* of) const {
      std::printf("%-10s IoU %.3f, refined %.3f%s\n", "mean", before / count, refined / count, of);
    }
  };
  const LabelSet set_;
  std::vector<Score> scores_;
};

double removed(double before, double after) { return before > 0.0 ? 1.0 - after / before : 0.0; }

cv::Mat1b trueLabels(const fs::path& folder, const std::string& rgb_file) {
  const std::string name = fs::path(rgb_file).stem().string() + ".png";
  if (fs::exists(folder / "labels" / name)) {
    return readImageFile((folder / "labels" / name).string(), cv::IMREAD_GRAYSCALE);
  }
  const cv::Mat1b mask = readImageFile((folder / "mask" / name).string(), cv::IMREAD_GRAYSCALE);
  return mask / 255;
}

cv::Mat1b dilateLabels(const cv::Mat1b& truth, int by_px) {
  const cv::Mat disc = cv::getStructuringElement(cv::MORPH_ELLIPSE, {2 * by_px + 1, 2 * by_px + 1});
  double last = 0.0;
  cv::minMaxLoc(truth, nullptr, &last);
  cv::Mat1b labels = truth.clone();
  for (int label = 1; label <= last; ++label) {
    cv::Mat1b mask;
    cv::dilate(truth == label, mask, disc);
    labels.setTo(label, mask & (labels == 0));
  }
  return labels;
}

LabelSet numberedLabels() {
  LabelSet set;
  set.classes.push_back({"person", Mobility::kPerson, cv::Vec3b(60, 20, 220)});
  for (int label = 2; label < 32; ++label) {
    set.classes.push_back({"label " + std::to_string(label), Mobility::kMovable,
                           cv::Vec3b(37 * label % 256, 91 * label % 256, 151 * label % 256)});
  }
  return set;
}

void writePicture(const std::string& path, const RgbdFrame& frame, const cv::Mat1b& labels, const cv::Mat1b& refined,
                  const cv::Mat1b& truth, const LabelSet& set) {
  const cv::Mat3b left = drawLabels(frame.bgr, labels, set);
  cv::Mat3b right = drawLabels(frame.bgr, refined, set), both;
  std::vector<std::vector<cv::Point>> outlines;
  cv::findContours(truth == 1, outlines, cv::RETR_LIST, cv::CHAIN_APPROX_NONE);
  cv::drawContours(right, outlines, -1, cv::Scalar(0, 255, 0), 1);
  cv::hconcat(left, right, both);
  writeImageFile(path, both);
}

struct Options {
  std::string pictures;
  SegmentationConfig config;
  int dilate_px = 0;
  std::size_t every = 10;
};

Options readOptions(const Arguments& arguments) {
  Options options;
  options.pictures = arguments.value("--pictures").value_or("");
  options.dilate_px = static_cast<int>(arguments.count("--dilate", 0));
  options.every = arguments.count("--every", options.every, 1);
  options.config.model.clear();
  applySettings(arguments, options.config);
  if (options.config.model.empty() == (options.dilate_px == 0)) {
    throw UsageError("give either --set model=FILE.onnx or --dilate PX");
  }
  return options;
}

void print(const char* what, const MaskScore& people, const PointErrors& points) {
  std::printf(
      "%-8s person IoU %.3f precision %.3f recall %.3f; points off their object %.2f %%, by over 5 cm %.2f %%, lost "
      "%.2f %%\n",
      what, people.iou(), people.precision(), people.recall(), 100.0 * points.offShare(), 100.0 * points.farShare(),
      100.0 * points.lostShare());
}

int run(const Arguments& arguments) {
  cv::setNumThreads(1);
  const Options options = readOptions(arguments);
  const std::string& folder = arguments.positional()[0];
  TumSequence sequence = openTumFolder(arguments);
  const auto segmenter = options.dilate_px > 0 ? nullptr : makeOnnxSegmenter(options.config);
  DepthRefiner refiner(options.config.refinement);
  const LabelSet set = segmenter ? segmenter->labels() : numberedLabels();
  if (!options.pictures.empty()) fs::create_directories(options.pictures);
  PointErrors points_before, points_after;
  LabelScores labels(set);
  StageTimes times;
  Progress progress(sequence.size(), "frames");
  while (auto frame = sequence.next()) {
    const cv::Mat1b truth = trueLabels(folder, sequence.pairs()[frame->index].rgb_file);
    Segmentation segmented;
    cv::Mat1b refined;
    {
      auto timer = times.scope(segmenter ? "network" : "dilation", frame->index);
      segmented = segmenter ? segmenter->segment(frame->bgr) : Segmentation{dilateLabels(truth, options.dilate_px)};
    }
    {
      auto timer = times.scope("refinement", frame->index);
      refined = refiner.refine(segmented, set, *frame);
    }
    points_before.add(segmented.labels, truth, *frame);
    points_after.add(refined, truth, *frame);
    labels.add(segmented.labels, refined, truth);
    if (!options.pictures.empty()) {
      const std::string name = fs::path(sequence.pairs()[frame->index].rgb_file).stem().string() + ".jpg";
      writePicture(options.pictures + "/" + name, *frame, segmented.labels, refined, truth, set);
    }
    progress.show(frame->index + 1);
    sequence.skip(options.every - 1);
  }
  progress.end();
  std::printf("%zu frames\n", labels.peopleBefore().frames());
  print("before", labels.peopleBefore(), points_before);
  print("refined", labels.peopleRefined(), points_after);
  labels.print();
  std::printf("refinement removes %.1f %% of the points off their object, %.1f %% of those by over 5 cm\n",
              100.0 * removed(points_before.offShare(), points_after.offShare()),
              100.0 * removed(points_before.farShare(), points_after.farShare()));
  for (const StageSummary& stage : times.summarize()) {
    std::printf("%-10s CPU median %.2f p95 %.2f ms\n", stage.stage.c_str(), stage.cpu.median_ms, stage.cpu.p95_ms);
  }
  return 0;
}

}  // namespace

int main(int argc, char** argv) {
  return runTool(argc, argv, kUsage, [&] {
    return run(Arguments(argc, argv, {"--camera", "--set", "--dilate", "--every", "--pictures"}, {}, {1, 1}));
  });
}
