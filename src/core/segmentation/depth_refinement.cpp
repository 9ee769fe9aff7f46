// SPDX-FileCopyrightText: 2026 The semantic_vslam authors
// SPDX-License-Identifier: BSD-3-Clause
#include "semantic_vslam/core/segmentation/depth_refinement.h"

#include <algorithm>
#include <array>
#include <cassert>
#include <cmath>
#include <limits>
#include <numeric>

#include "semantic_vslam/core/segmentation/connected_regions.h"

namespace semantic_vslam {
namespace {

const std::array<cv::Point, 8> kNeighbours{cv::Point(-1, -1), cv::Point(0, -1), cv::Point(1, -1), cv::Point(-1, 0),
                                           cv::Point(1, 0),   cv::Point(-1, 1), cv::Point(0, 1),  cv::Point(1, 1)};

template <class T>
T medianOf(std::vector<T> values) {
  std::nth_element(values.begin(), values.begin() + values.size() / 2, values.end());
  return values[values.size() / 2];
}

float squaredDistance(const cv::Vec3f& a, const cv::Vec3f& b) {
  const float dx = a[0] - b[0], dy = a[1] - b[1], dz = a[2] - b[2];
  return dx * dx + dy * dy + dz * dz;
}

/// One connected mask: its pixels, where it is grown from and how far it may step.
struct Mask {
  std::vector<int> pixels;  ///< row * width + column, in raster order
  MaskMoments moments;
  int seed = -1;                         ///< pixel; -1: the mask has no depth
  float squared_threshold_m2 = 0.0F;     ///< T^2 of eq. (4) at the reference depth
  float inverse_reference_depth = 0.0F;  ///< 1/m
};

/// Collects the masks' pixels and computes the 3-D points of all of them; other points stay undefined.
std::vector<Mask> collectMasks(const ConnectedRegions& masks, const RgbdFrame& frame, cv::Mat3f& points_m) {
  std::vector<Mask> collected(masks.count);
  for (int m = 0; m < masks.count; ++m) collected[m].pixels.reserve(masks.size_px[m]);
  points_m.create(masks.id.size());
  for (int v = 0, i = 0; v < masks.id.rows; ++v) {
    const int* id = masks.id[v];
    const float* depth_m = frame.depth_m[v];
    const cv::Vec2f* ray = frame.camera->rays()[v];
    cv::Vec3f* point_m = points_m[v];
    for (int u = 0; u < masks.id.cols; ++u, ++i) {
      if (id[u] < 0) continue;
      collected[id[u]].pixels.push_back(i);
      collected[id[u]].moments.add({u, v});
      point_m[u] = {ray[u][0] * depth_m[u], ray[u][1] * depth_m[u], depth_m[u]};
    }
  }
  return collected;
}

/// The centroid's pixel, or the mask's nearest to it that has depth; -1 if none has.
int findSeed(const Mask& mask, const ConnectedRegions& masks, int mask_id, const cv::Mat3f& points_m) {
  const cv::Point2d centroid = mask.moments.centroid();
  const cv::Point at(cvRound(centroid.x), cvRound(centroid.y));
  if (masks.id(at) == mask_id && points_m(at)[2] > 0.0F) return at.y * masks.id.cols + at.x;
  int nearest = -1;
  double nearest_squared_px = std::numeric_limits<double>::infinity();
  for (const int i : mask.pixels) {
    if (points_m.ptr<cv::Vec3f>()[i][2] == 0.0F) continue;
    const double dx = i % masks.id.cols - centroid.x, dy = i / masks.id.cols - centroid.y;
    if (dx * dx + dy * dy < nearest_squared_px) {
      nearest_squared_px = dx * dx + dy * dy;
      nearest = i;
    }
  }
  return nearest;
}

/// Median over some pixels of the mask, evenly taken: the depth that its threshold holds at.
float typicalDepth(const Mask& mask, const cv::Mat3f& points_m) {
  constexpr std::size_t kPixels = 255;
  std::vector<float> depths;
  for (std::size_t k = 0; k < mask.pixels.size(); k += 1 + mask.pixels.size() / kPixels) {
    const float z = points_m.ptr<cv::Vec3f>()[mask.pixels[k]][2];
    if (z > 0.0F) depths.push_back(z);
  }
  return depths.empty() ? points_m.ptr<cv::Vec3f>()[mask.seed][2] : medianOf(std::move(depths));
}

void prepareGrowth(Mask& mask, const ConnectedRegions& masks, int mask_id, const cv::Mat3f& points_m,
                   const RefinementConfig& config) {
  mask.seed = findSeed(mask, masks, mask_id, points_m);
  if (mask.seed < 0) return;
  Rng rng(static_cast<std::uint64_t>(config.seed));
  const double rho_m =
      neighbourDistance(masks.id, mask_id, mask.pixels, points_m, config.samples, config.average == "median", rng);
  const double threshold_m = rho_m > 0.0 ? config.epsilon * rho_m : std::numeric_limits<double>::infinity();  // eq. (4)
  mask.squared_threshold_m2 = static_cast<float>(threshold_m * threshold_m);
  mask.inverse_reference_depth = 1.0F / typicalDepth(mask, points_m);
}

/// Splits the masks into pieces that growth does not cross: surfaces without a step of T or more, and holes.
/// All growths at once: what a seed reaches is the piece it lies in.
ConnectedRegions splitMasks(const ConnectedRegions& masks, const std::vector<Mask>& prepared,
                            const cv::Mat3f& points_m) {
  const int* mask_of = masks.id.ptr<int>();
  const auto* point_m = points_m.ptr<cv::Vec3f>();
  const auto joined = [&](int a, int b) {
    if (mask_of[a] != mask_of[b]) return false;
    const float za = point_m[a][2], zb = point_m[b][2];
    if (za == 0.0F || zb == 0.0F) return za == zb;
    // Pixels of a farther part lie farther apart: the threshold grows with them.
    const Mask& mask = prepared[mask_of[a]];
    const float farther = std::max(1.0F, std::min(za, zb) * mask.inverse_reference_depth);
    return squaredDistance(point_m[a], point_m[b]) < mask.squared_threshold_m2 * farther * farther;
  };
  return connectRegions(
      masks.id.size(), [mask_of](int i) { return mask_of[i] >= 0; }, joined);
}

/// A piece of a mask: one depth-continuous surface, or one hole.
struct Piece {
  int mask_id = -1;
  int size_px = 0;
  int border_px = 0;
  bool hole = false;
  bool person = false;
  bool keep = false;
  double depth_sum_m = 0.0;

  double depthM() const { return depth_sum_m / size_px; }
  /// Mean width: a band of width w has 2 border pixels for every w pixels.
  double thicknessPx() const { return 2.0 * size_px / border_px; }
};

std::vector<Piece> describePieces(const ConnectedRegions& parts, const ConnectedRegions& masks,
                                  const cv::Mat3f& points_m, const cv::Mat1b& labels, const LabelSet& label_set) {
  std::vector<Piece> pieces(parts.count);
  const int rows = parts.id.rows, cols = parts.id.cols;
  for (int v = 0; v < rows; ++v) {
    const int* id = parts.id[v];
    const int* above = parts.id[std::max(v - 1, 0)];
    const int* below = parts.id[std::min(v + 1, rows - 1)];
    for (int u = 0; u < cols; ++u) {
      if (id[u] < 0) continue;
      Piece& piece = pieces[id[u]];
      const float z = points_m(v, u)[2];
      if (piece.mask_id < 0) {
        piece.mask_id = masks.id(v, u);
        piece.hole = z == 0.0F;
        piece.person = label_set.mobility(labels(v, u)) == Mobility::kPerson;
      }
      ++piece.size_px;
      piece.depth_sum_m += z;
      const bool inside = v > 0 && v + 1 < rows && u > 0 && u + 1 < cols && id[u - 1] == id[u] && id[u + 1] == id[u] &&
                          above[u] == id[u] && below[u] == id[u];
      if (!inside) ++piece.border_px;
    }
  }
  return pieces;
}

/// The seed's piece of each mask, or its largest where the seed fell on something less than half as large; -1: none.
std::vector<int> mainPieces(const std::vector<Mask>& masks, const std::vector<Piece>& pieces,
                            const ConnectedRegions& parts) {
  std::vector<int> main(masks.size(), -1);
  for (std::size_t k = 0; k < pieces.size(); ++k) {
    int& largest = main[pieces[k].mask_id];
    if (!pieces[k].hole && (largest < 0 || pieces[k].size_px > pieces[largest].size_px)) largest = static_cast<int>(k);
  }
  for (std::size_t m = 0; m < masks.size(); ++m) {
    if (main[m] < 0) continue;
    const int seeded = parts.id.ptr<int>()[masks[m].seed];
    if (2 * pieces[seeded].size_px >= pieces[main[m]].size_px) main[m] = seeded;
  }
  return main;
}

void keepSurfaces(std::vector<Piece>& pieces, const std::vector<int>& main, const std::vector<Mask>& masks,
                  const RefinementConfig& config) {
  for (std::size_t k = 0; k < pieces.size(); ++k) {
    Piece& piece = pieces[k];
    const int main_piece = main[piece.mask_id];
    if (piece.hole || main_piece < 0) continue;
    const bool large =
        config.min_region_share < 1.0 &&
        piece.size_px >= config.min_region_share * static_cast<double>(masks[piece.mask_id].pixels.size());
    const bool solid = piece.thicknessPx() >= config.min_thickness_px;
    const bool near = std::abs(piece.depthM() - pieces[main_piece].depthM()) <= config.object_depth_m;
    piece.keep = static_cast<int>(k) == main_piece || (large && solid && (near || piece.person));
  }
}

/// A hole stays if most of the pixels around it do. What lies outside the mask counts against it: sensors lose depth
/// beside an object, in its shadow, as well as on it.
void keepEnclosedHoles(std::vector<Piece>& pieces, const std::vector<int>& main, const std::vector<Mask>& masks,
                       const ConnectedRegions& parts) {
  const cv::Rect image({0, 0}, parts.id.size());
  std::vector<int> balance(pieces.size(), 0);
  for (const Mask& mask : masks) {
    for (const int i : mask.pixels) {
      const int hole = parts.id.ptr<int>()[i];
      if (!pieces[hole].hole) continue;
      const cv::Point p(i % image.width, i / image.width);
      for (const cv::Point& step : kNeighbours) {
        if (!image.contains(p + step)) continue;
        const int part = parts.id(p + step);
        if (part != hole) balance[hole] += part >= 0 && pieces[part].keep ? 1 : -1;
      }
    }
  }
  for (std::size_t k = 0; k < pieces.size(); ++k) {
    const bool no_depth_at_all = main[pieces[k].mask_id] < 0;
    if (pieces[k].hole) pieces[k].keep = no_depth_at_all || balance[k] > 0;
  }
}

/// Mean distance of a pixel to its neighbours in the mask, the largest and smallest left out; negative if it has fewer
/// than three.
double trimmedNeighbourMean(const cv::Mat1i& mask, int mask_id, const cv::Point& p, const cv::Mat3f& points_m) {
  const cv::Rect image({0, 0}, mask.size());
  double sum = 0.0, smallest = std::numeric_limits<double>::infinity(), largest = 0.0;
  int count = 0;
  for (const cv::Point& step : kNeighbours) {
    const cv::Point q = p + step;
    if (!image.contains(q) || mask(q) != mask_id || points_m(q)[2] == 0.0F) continue;
    const double distance_m = std::sqrt(squaredDistance(points_m(p), points_m(q)));
    sum += distance_m;
    smallest = std::min(smallest, distance_m);
    largest = std::max(largest, distance_m);
    ++count;
  }
  return count >= 3 ? (sum - smallest - largest) / (count - 2) : -1.0;
}

}  // namespace

double neighbourDistance(const cv::Mat1i& mask, int mask_id, const std::vector<int>& pixels, const cv::Mat3f& points_m,
                         int samples, bool median, Rng& rng) {
  constexpr int kDrawsPerSample = 8;  // pixels without depth are drawn in vain; a mask may have few with
  std::vector<double> means;
  for (int draw = 0; draw < kDrawsPerSample * samples && static_cast<int>(means.size()) < samples; ++draw) {
    const int i = pixels[rng.below(pixels.size())];
    const cv::Point p(i % mask.cols, i / mask.cols);
    if (points_m(p)[2] == 0.0F) continue;
    const double mean = trimmedNeighbourMean(mask, mask_id, p, points_m);
    if (mean >= 0.0) means.push_back(mean);
  }
  if (means.empty()) return 0.0;
  if (median) return medianOf(std::move(means));
  return std::accumulate(means.begin(), means.end(), 0.0) / static_cast<double>(means.size());  // eq. (3)
}

cv::Mat1b refineOnDepth(const cv::Mat1b& labels, const LabelSet& label_set, const RgbdFrame& frame,
                        const RefinementConfig& config) {
  assert(labels.size() == frame.depth_m.size() && labels.isContinuous());
  if (!config.enabled) return labels.clone();
  const std::uint8_t* label = labels.ptr<std::uint8_t>();
  const ConnectedRegions masks = connectRegions(
      labels.size(), [label](int i) { return label[i] != 0; }, [label](int a, int b) { return label[a] == label[b]; });
  cv::Mat3f points_m;
  std::vector<Mask> prepared = collectMasks(masks, frame, points_m);
  for (int m = 0; m < masks.count; ++m) prepareGrowth(prepared[m], masks, m, points_m, config);
  const ConnectedRegions parts = splitMasks(masks, prepared, points_m);

  std::vector<Piece> pieces = describePieces(parts, masks, points_m, labels, label_set);
  const std::vector<int> main = mainPieces(prepared, pieces, parts);
  keepSurfaces(pieces, main, prepared, config);
  keepEnclosedHoles(pieces, main, prepared, parts);

  cv::Mat1b refined(labels.size(), std::uint8_t{0});
  for (const Mask& mask : prepared) {
    if (static_cast<int>(mask.pixels.size()) < config.min_mask_px) continue;
    for (const int i : mask.pixels) {
      if (pieces[parts.id.ptr<int>()[i]].keep) refined.ptr<std::uint8_t>()[i] = label[i];
    }
  }
  return refined;
}

}  // namespace semantic_vslam
