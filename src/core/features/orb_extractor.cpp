// SPDX-FileCopyrightText: 2026 The semantic_vslam authors
// SPDX-License-Identifier: BSD-3-Clause
#include "core/features/orb_extractor.h"

#include <algorithm>
#include <array>
#include <cassert>
#include <cmath>
#include <cstdint>
#include <opencv2/features2d.hpp>
#include <opencv2/imgproc.hpp>
#include <tuple>

#include "semantic_vslam/core/common/config_fields.h"

namespace semantic_vslam {
namespace {

constexpr int kPatchRadius = 15;  // px; ORB's descriptor and orientation patch is 31 px wide
constexpr int kBorder = 19;       // px; a rotated patch reaches sqrt(2) * 13 px, plus the smoothing kernel

using Pyramid = std::array<cv::Mat1b, kPyramidLevels>;

Pyramid makePyramid(const cv::Mat1b& gray) {
  Pyramid pyramid;
  pyramid[0] = gray;
  for (int level = 1; level < kPyramidLevels; ++level) {
    const double scale = 1.0 / pyramidScale(level);
    const cv::Size size(cvRound(gray.cols * scale), cvRound(gray.rows * scale));
    cv::resize(pyramid[level - 1], pyramid[level], size, 0, 0, cv::INTER_LINEAR);
  }
  return pyramid;
}

/// Share of the features per level: proportional to the level's side, so that the density is the same per scale.
std::array<int, kPyramidLevels> quotaPerLevel(int features) {
  double sum = 0.0;
  for (int level = 0; level < kPyramidLevels; ++level) sum += 1.0 / pyramidScale(level);
  std::array<int, kPyramidLevels> quota{};
  for (int level = 0; level < kPyramidLevels; ++level) {
    quota[level] = cvRound(features / pyramidScale(level) / sum);
  }
  return quota;
}

struct Corner {
  cv::Point2f px;  // in the level's image
  float response = 0.0F;
  float weight = 1.0F;
  int cell = 0;
  int rank = 0;  // 0 = strongest of its cell
};

/// The disc over which orientation is measured, as rows of factors: one loop of fixed length for each, which compilers
/// turn into vector instructions.
struct Disc {
  static constexpr int kRows = 2 * kPatchRadius + 1, kColumns = kRows + 1;  // the last column is empty
  std::array<std::array<std::int16_t, kColumns>, kRows> inside{}, dx{};

  Disc() {
    for (int row = 0; row < kRows; ++row) {
      const int dy = row - kPatchRadius;
      const int half_width = static_cast<int>(std::sqrt(double(kPatchRadius * kPatchRadius - dy * dy)));
      for (int x = -half_width; x <= half_width; ++x) {
        inside[row][x + kPatchRadius] = 1;
        dx[row][x + kPatchRadius] = static_cast<std::int16_t>(x);
      }
    }
  }
};

/// Intensity-centroid orientation (Rublee et al. 2011, section 3.2). @return rad.
float centroidAngle(const cv::Mat1b& image, int u, int v) {
  static const Disc disc;
  int m01 = 0, m10 = 0;
  for (int row = 0; row < Disc::kRows; ++row) {
    const std::uint8_t* pixels = image.ptr(v + row - kPatchRadius) + u - kPatchRadius;
    int sum = 0;
    for (int i = 0; i < Disc::kColumns; ++i) {
      m10 += disc.dx[row][i] * pixels[i];
      sum += disc.inside[row][i] * pixels[i];
    }
    m01 += (row - kPatchRadius) * sum;
  }
  return std::atan2(static_cast<float>(m01), static_cast<float>(m10));
}

/// FAST over the whole level at the high threshold, and again at the low one in the cells that stayed empty.
class CornerDetector {
 public:
  CornerDetector(const OrbConfig& config, const cv::Mat1b& image, double scale, const cv::Mat1b& dynamic)
      : config_(config), image_(image), scale_(scale), dynamic_(dynamic) {
    columns_ = std::max(1, (image.cols - 2 * kBorder) / config.cell_px);
    rows_ = std::max(1, (image.rows - 2 * kBorder) / config.cell_px);
  }

  int cells() const { return columns_ * rows_; }

  std::vector<Corner> detect() {
    const cv::Rect inside(kBorder, kBorder, image_.cols - 2 * kBorder, image_.rows - 2 * kBorder);
    if (inside.width < 8 || inside.height < 8) return {};
    detectIn(inside, config_.fast_threshold);
    std::vector<bool> occupied(static_cast<std::size_t>(columns_) * rows_, false);
    for (const Corner& corner : corners_) occupied[corner.cell] = true;
    for (int row = 0; row < rows_; ++row) {
      for (int column = 0; column < columns_; ++column) {
        if (!occupied[row * columns_ + column]) detectIn(cellRect(inside, column, row), config_.fast_threshold_low);
      }
    }
    return std::move(corners_);
  }

 private:
  cv::Rect cellRect(const cv::Rect& inside, int column, int row) const {
    const int x0 = inside.x + inside.width * column / columns_, x1 = inside.x + inside.width * (column + 1) / columns_;
    const int y0 = inside.y + inside.height * row / rows_, y1 = inside.y + inside.height * (row + 1) / rows_;
    return {x0, y0, x1 - x0, y1 - y0};
  }

  void detectIn(const cv::Rect& area, int threshold) {
    constexpr int kRing = 3;  // FAST looks 3 px around, so the searched area must be wider than the one that counts
    const cv::Rect wide(area.x - kRing, area.y - kRing, area.width + 2 * kRing, area.height + 2 * kRing);
    keypoints_.clear();
    cv::FAST(image_(wide), keypoints_, threshold, true);
    for (const auto& keypoint : keypoints_) {
      Corner corner;
      corner.px = keypoint.pt + cv::Point2f(static_cast<float>(wide.x), static_cast<float>(wide.y));
      corner.response = keypoint.response;
      corner.weight = weightAt(corner.px);
      const int column =
          std::clamp(int((corner.px.x - kBorder) * columns_ / (image_.cols - 2 * kBorder)), 0, columns_ - 1);
      const int row = std::clamp(int((corner.px.y - kBorder) * rows_ / (image_.rows - 2 * kBorder)), 0, rows_ - 1);
      corner.cell = row * columns_ + column;
      corners_.push_back(corner);
    }
  }

  float weightAt(const cv::Point2f& px) const {
    if (dynamic_.empty()) return 1.0F;
    const int u = std::min(cvRound(px.x * scale_), dynamic_.cols - 1);
    const int v = std::min(cvRound(px.y * scale_), dynamic_.rows - 1);
    return 1.0F - static_cast<float>(dynamic_(v, u)) / 255.0F;
  }

  const OrbConfig& config_;
  const cv::Mat1b& image_;
  const double scale_;
  const cv::Mat1b& dynamic_;
  int columns_ = 0, rows_ = 0;
  std::vector<cv::KeyPoint> keypoints_;
  std::vector<Corner> corners_;
};

/// Sets each corner's rank among those of its cell, strongest first.
void rankInCells(std::vector<Corner>& corners, int cells) {
  std::vector<int> begin_of_cell(cells + 1, 0);
  for (const Corner& corner : corners) ++begin_of_cell[corner.cell + 1];
  for (int cell = 0; cell < cells; ++cell) begin_of_cell[cell + 1] += begin_of_cell[cell];
  std::vector<Corner*> by_cell(corners.size());
  std::vector<int> next(begin_of_cell.begin(), begin_of_cell.end() - 1);
  for (Corner& corner : corners) by_cell[next[corner.cell]++] = &corner;
  for (int cell = 0; cell < cells; ++cell) {
    const auto begin = by_cell.begin() + begin_of_cell[cell], end = by_cell.begin() + begin_of_cell[cell + 1];
    std::sort(begin, end, [](const Corner* a, const Corner* b) {
      return std::tie(b->response, a->px.y, a->px.x) < std::tie(a->response, b->px.y, b->px.x);
    });
    for (auto it = begin; it != end; ++it) (*it)->rank = static_cast<int>(it - begin);
  }
}

/// Takes the strongest corner of every cell, then the second of every cell, and so on until the quota is full.
void keepSpread(std::vector<Corner>& corners, int cells, int quota) {
  rankInCells(corners, cells);
  const auto first = [](const Corner& a, const Corner& b) {
    return std::tie(a.rank, b.response, a.cell) < std::tie(b.rank, a.response, b.cell);
  };
  if (static_cast<int>(corners.size()) > quota) {
    std::nth_element(corners.begin(), corners.begin() + quota, corners.end(), first);
    corners.resize(quota);
  }
  std::sort(corners.begin(), corners.end(), first);
}

float depthAt(const cv::Mat1f& depth_m, const cv::Point2f& px) {
  return depth_m(std::clamp(cvRound(px.y), 0, depth_m.rows - 1), std::clamp(cvRound(px.x), 0, depth_m.cols - 1));
}

constexpr float kDynamicWeight = 1.0F - 128.0F / 255.0F;  // a mask value of 128 and more counts as dynamic

}  // namespace

struct OrbExtractor::Implementation {
  OrbConfig config;
  std::array<int, kPyramidLevels> quota;
  cv::Ptr<cv::ORB> descriptor;

  std::vector<cv::KeyPoint> detect(const Pyramid& pyramid, const cv::Mat1b& dynamic,
                                   std::vector<float>& weights) const {
    std::vector<cv::KeyPoint> keypoints;
    std::vector<std::pair<Corner, int>> masked;  // with level
    const auto keep = [&](const Corner& corner, int level) {
      const float scale = static_cast<float>(pyramidScale(level));
      const float angle = centroidAngle(pyramid[level], cvRound(corner.px.x), cvRound(corner.px.y));
      keypoints.emplace_back(corner.px * scale, 31.0F * scale, angle * static_cast<float>(180.0 / M_PI),
                             corner.response, level, static_cast<int>(weights.size()));
      weights.push_back(corner.weight);
    };
    for (int level = 0; level < kPyramidLevels; ++level) {
      CornerDetector detector(config, pyramid[level], pyramidScale(level), dynamic);
      auto corners = detector.detect();
      const auto first_masked = std::stable_partition(
          corners.begin(), corners.end(), [](const Corner& corner) { return corner.weight > kDynamicWeight; });
      for (auto it = first_masked; it != corners.end(); ++it) masked.emplace_back(*it, level);
      corners.erase(first_masked, corners.end());
      keepSpread(corners, detector.cells(), quota[level]);
      for (const Corner& corner : corners) keep(corner, level);
    }
    fillFromMasked(masked, static_cast<int>(keypoints.size()), keep);
    return keypoints;
  }

  /// Describes key points level by level, so that OpenCV need not build its own, bordered pyramid for all of them.
  cv::Mat1b describe(const Pyramid& pyramid, const std::vector<cv::KeyPoint>& keypoints) const {
    cv::Mat1b descriptors(static_cast<int>(keypoints.size()), 32);
    for (int level = 0; level < kPyramidLevels; ++level) {
      const float scale = static_cast<float>(pyramidScale(level));
      std::vector<cv::KeyPoint> of_level;
      for (int i = 0; i < static_cast<int>(keypoints.size()); ++i) {
        if (keypoints[i].octave != level) continue;
        of_level.push_back(keypoints[i]);
        of_level.back().pt /= scale;
        of_level.back().octave = 0;
        of_level.back().class_id = i;
      }
      if (of_level.empty()) continue;
      cv::Mat rows;
      descriptor->compute(pyramid[level], of_level, rows);
      assert(rows.rows == static_cast<int>(of_level.size()));  // corners keep to the border that ORB asks for
      for (int i = 0; i < rows.rows; ++i) rows.row(i).copyTo(descriptors.row(of_level[i].class_id));
    }
    return descriptors;
  }

  template <class Keep>
  void fillFromMasked(std::vector<std::pair<Corner, int>>& masked, int have, const Keep& keep) const {
    const int missing = std::min<int>(config.minimum_static - have, static_cast<int>(masked.size()));
    if (missing <= 0) return;
    std::stable_sort(masked.begin(), masked.end(), [](const auto& a, const auto& b) {
      return a.first.weight != b.first.weight ? a.first.weight > b.first.weight : a.first.response > b.first.response;
    });
    for (int i = 0; i < missing; ++i) {
      if (masked[i].first.weight > 0.0F) keep(masked[i].first, masked[i].second);
    }
  }
};

OrbExtractor::OrbExtractor(const OrbConfig& config) : implementation_(std::make_unique<Implementation>()) {
  validateConfig(config);
  implementation_->config = config;
  implementation_->quota = quotaPerLevel(config.features);
  // OpenCV's ORB only describes here: it keeps every key point it is given (nfeatures does not cut in compute()).
  implementation_->descriptor = cv::ORB::create(config.features, static_cast<float>(kPyramidScale), 1, kBorder, 0, 2,
                                                cv::ORB::FAST_SCORE, 2 * kPatchRadius + 1, config.fast_threshold);
}

OrbExtractor::~OrbExtractor() = default;

FrameFeatures OrbExtractor::extract(const RgbdFrame& frame, const cv::Mat1b& dynamic) const {
  std::vector<float> weights;
  const Pyramid pyramid = makePyramid(frame.gray);
  const auto keypoints = implementation_->detect(pyramid, dynamic, weights);
  FrameFeatures out;
  out.descriptors = implementation_->describe(pyramid, keypoints);
  out.features.reserve(keypoints.size());
  for (const auto& keypoint : keypoints) {
    Feature feature;
    feature.raw_px = {keypoint.pt.x, keypoint.pt.y};
    feature.undistorted_px = frame.camera->undistort(feature.raw_px.cast<double>()).cast<float>();
    feature.depth_m = depthAt(frame.depth_m, keypoint.pt);
    feature.angle_rad = keypoint.angle * static_cast<float>(M_PI / 180.0);
    feature.octave = keypoint.octave;
    feature.static_weight = weights[keypoint.class_id];
    out.features.push_back(feature);
  }
  return out;
}

}  // namespace semantic_vslam
