// SPDX-FileCopyrightText: 2026 The semantic_vslam authors
// SPDX-License-Identifier: BSD-3-Clause
#include "core/segmentation/depth_refinement.h"

#include <algorithm>
#include <array>
#include <cassert>
#include <cmath>
#include <limits>
#include <numeric>
#include <vector>

#include "core/segmentation/block_grid.h"
#include "core/segmentation/mask_bands.h"
#include "core/segmentation/people_completion.h"
#include "semantic_vslam/core/common/config_fields.h"

namespace semantic_vslam {
namespace {

const std::array<cv::Point, 8> kNeighbours{cv::Point(-1, -1), cv::Point(0, -1), cv::Point(1, -1), cv::Point(-1, 0),
                                           cv::Point(1, 0),   cv::Point(-1, 1), cv::Point(0, 1),  cv::Point(1, 1)};

template <class T>
T medianOf(std::vector<T> values) {
  std::nth_element(values.begin(), values.begin() + values.size() / 2, values.end());
  return values[values.size() / 2];
}

/// The pixels that regions are grown over: the middle of each block of stride x stride px.
struct Grid {
  int stride = 1;
  cv::Mat1b labels;
  cv::Mat1f depth_m;
};

/// Collects the masks' pixels and computes the 3-D points of all of them; other points stay undefined.
/// @param pixels, points_m  memory for the result
std::vector<GrownMask> collectMasks(const ConnectedRegions& masks, const std::vector<cv::Point>& labelled,
                                    const Grid& grid, const cv::Mat2f& rays, std::vector<int>& pixels,
                                    cv::Mat3f& points_m) {
  std::vector<int*> next(masks.count);
  std::vector<GrownMask> collected(masks.count);
  pixels.resize(labelled.size());
  int* first = pixels.data();
  for (int m = 0; m < masks.count; ++m) {
    collected[m].pixels = next[m] = first;
    collected[m].size_px = masks.size_px[m];
    first += masks.size_px[m];
  }
  points_m.create(masks.id.size());
  const int* id = masks.id.ptr<int>();
  for (const cv::Point& p : labelled) {
    const int i = p.y * masks.id.cols + p.x;
    *next[id[i]]++ = i;
    collected[id[i]].moments.add(p);
    const float z = grid.depth_m(p);
    const cv::Vec2f& ray = rays(middleOfBlock(p.y, grid.stride, rays.rows), middleOfBlock(p.x, grid.stride, rays.cols));
    points_m.ptr<cv::Vec3f>()[i] = {ray[0] * z, ray[1] * z, z};
  }
  return collected;
}

/// The centroid's pixel, or the mask's nearest to it that has depth; -1 if none has.
int findSeed(const GrownMask& mask, const ConnectedRegions& masks, int mask_id, const cv::Mat3f& points_m) {
  const cv::Point2d centroid = mask.moments.centroid();
  const cv::Point at(cvRound(centroid.x), cvRound(centroid.y));
  if (masks.id(at) == mask_id && points_m(at)[2] > 0.0F) return at.y * masks.id.cols + at.x;
  int nearest = -1;
  double nearest_squared_px = std::numeric_limits<double>::infinity();
  for (std::size_t k = 0; k < mask.size_px; ++k) {
    const int i = mask.pixels[k];
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
float typicalDepth(const GrownMask& mask, const cv::Mat3f& points_m) {
  constexpr std::size_t kPixels = 255;
  std::vector<float> depths;
  for (std::size_t k = 0; k < mask.size_px; k += 1 + mask.size_px / kPixels) {
    const float z = points_m.ptr<cv::Vec3f>()[mask.pixels[k]][2];
    if (z > 0.0F) depths.push_back(z);
  }
  return depths.empty() ? points_m.ptr<cv::Vec3f>()[mask.seed][2] : medianOf(std::move(depths));
}

/// Finds the mask's seed, and how far growth steps from each of its pixels: T^2, more beyond the depth that T holds at,
/// since pixels of a farther part lie farther apart.
void prepareGrowth(GrownMask& mask, const ConnectedRegions& masks, int mask_id, const cv::Mat3f& points_m,
                   const RefinementConfig& config, cv::Mat1f& reach_m2) {
  mask.seed = findSeed(mask, masks, mask_id, points_m);
  if (mask.seed < 0) return;
  Rng rng(static_cast<std::uint64_t>(config.seed));
  const double rho_m = neighbourDistance(masks.id, mask_id, mask.pixels, mask.size_px, points_m, config.samples,
                                         config.average == "median", rng);
  const double threshold_m = rho_m > 0.0 ? config.epsilon * rho_m : std::numeric_limits<double>::infinity();  // eq. (4)
  const auto least_m2 = static_cast<float>(threshold_m * threshold_m);
  const float inverse_depth = 1.0F / typicalDepth(mask, points_m);
  for (std::size_t k = 0; k < mask.size_px; ++k) {
    const int i = mask.pixels[k];
    const float farther = points_m.ptr<cv::Vec3f>()[i][2] * inverse_depth;
    reach_m2.ptr<float>()[i] = least_m2 * std::max(1.0F, farther * farther);
  }
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
                                  const std::vector<cv::Point>& labelled, const cv::Mat3f& points_m,
                                  const cv::Mat1b& labels, const LabelSet& label_set) {
  std::vector<Piece> pieces(parts.count);
  const int rows = parts.id.rows, cols = parts.id.cols;
  const int* part_of = parts.id.ptr<int>();
  for (const cv::Point& p : labelled) {
    const int i = p.y * cols + p.x, part = part_of[i];
    Piece& piece = pieces[part];
    const float z = points_m.ptr<cv::Vec3f>()[i][2];
    if (piece.mask_id < 0) {
      piece.mask_id = masks.id(p);
      piece.hole = z == 0.0F;
      piece.person = label_set.mobility(labels(p)) == Mobility::kPerson;
    }
    ++piece.size_px;
    piece.depth_sum_m += z;
    const bool inside = p.y > 0 && p.y + 1 < rows && p.x > 0 && p.x + 1 < cols && part_of[i - 1] == part &&
                        part_of[i + 1] == part && part_of[i - cols] == part && part_of[i + cols] == part;
    if (!inside) ++piece.border_px;
  }
  return pieces;
}

/// The seed's piece of each mask, or its largest where the seed fell on something less than half as large; -1: none.
std::vector<int> mainPieces(const std::vector<GrownMask>& masks, const std::vector<Piece>& pieces,
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

bool near(const Piece& piece, const Piece& main, const RefinementConfig& config) {
  return std::abs(piece.depthM() - main.depthM()) <= config.object_depth_m;
}

void keepSurfaces(std::vector<Piece>& pieces, const std::vector<int>& main, const std::vector<GrownMask>& masks,
                  const RefinementConfig& config) {
  for (std::size_t k = 0; k < pieces.size(); ++k) {
    Piece& piece = pieces[k];
    const int main_piece = main[piece.mask_id];
    if (piece.hole || main_piece < 0) continue;
    const bool large = config.min_region_share < 1.0 &&
                       piece.size_px >= config.min_region_share * static_cast<double>(masks[piece.mask_id].size_px);
    const bool solid = piece.thicknessPx() >= config.min_thickness_px;
    piece.keep = static_cast<int>(k) == main_piece ||
                 (large && solid && (piece.person || near(piece, pieces[main_piece], config)));
  }
}

/// What the growths left out stays if most of the pixels around it stay: holes, and specks of noise at about the
/// object's depth, but not the wall seen through the crook of an arm. What lies outside the mask counts against it:
/// sensors lose depth beside an object, in its shadow, as well as on it.
void keepEnclosed(std::vector<Piece>& pieces, const std::vector<int>& main, const std::vector<GrownMask>& masks,
                  const ConnectedRegions& parts, const cv::Mat1b& bands, const RefinementConfig& config) {
  const int width = parts.id.cols, height = parts.id.rows;
  const int* part_of = parts.id.ptr<int>();
  const std::uint8_t* band = bands.ptr<std::uint8_t>();
  std::vector<int> balance(pieces.size(), 0);
  for (const GrownMask& mask : masks) {
    for (std::size_t k = 0; k < mask.size_px; ++k) {
      const int i = mask.pixels[k], part = part_of[i];
      if (pieces[part].keep) continue;
      const int u = i % width, v = i / width;
      for (int y = std::max(v - 1, 0); y <= std::min(v + 1, height - 1); ++y) {
        for (int x = std::max(u - 1, 0); x <= std::min(u + 1, width - 1); ++x) {
          const int around = part_of[y * width + x];
          if (around == part) continue;
          balance[part] += around >= 0 && pieces[around].keep && band[y * width + x] == 0 ? 1 : -1;
        }
      }
    }
  }
  for (std::size_t k = 0; k < pieces.size(); ++k) {
    Piece& piece = pieces[k];
    const int main_piece = main[piece.mask_id];
    if (piece.keep || main_piece < 0) {
      piece.keep = true;  // a mask without any depth stays whole
    } else {
      piece.keep = balance[k] > 0 && (piece.hole || near(piece, pieces[main_piece], config));
    }
  }
}

/// Labels of all pixels from those that were kept on the grid: a pixel stays with its block if the two are level, and
/// if one of them has no depth.
cv::Mat1b spread(const cv::Mat1b& kept, const Grid& grid, const cv::Mat1f& reach_m2, const cv::Mat1b& labels,
                 const cv::Mat1f& depth_m) {
  const int width = labels.cols;
  cv::Mat1b refined(labels.size());
  std::vector<std::uint8_t> kept_row;
  std::vector<float> level_row, reach_row;
  for (int row = 0; row < kept.rows; ++row) {
    const std::uint8_t* wanted = expandRow(grid.stride, kept, row, kept_row);
    const float* level_m = expandRow(grid.stride, grid.depth_m, row, level_row);
    const float* reach = expandRow(grid.stride, reach_m2, row, reach_row);
    for (int v = row * grid.stride; v < std::min((row + 1) * grid.stride, labels.rows); ++v) {
      const std::uint8_t* label = labels[v];
      const float* z = depth_m[v];
      std::uint8_t* to = refined[v];
      for (int u = 0; u < width; ++u) {
        const float step = z[u] - level_m[u];
        const bool level = (z[u] == 0.0F) | (level_m[u] == 0.0F) | (step * step < reach[u]);
        to[u] = (label[u] == wanted[u]) & level ? wanted[u] : 0;
      }
    }
  }
  return refined;
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

/// Lengths and areas in px of the grid.
RefinementConfig onGrid(RefinementConfig config) {
  validateConfig(config);
  const int stride = config.stride_px;
  if (stride > 1 && config.band_px > 0)
    config.band_px = config.band_px / stride + 1;  // a border may lie that much inside
  config.min_mask_px /= stride * stride;
  config.min_thickness_px /= stride;
  return config;
}

}  // namespace

double neighbourDistance(const cv::Mat1i& mask, int mask_id, const int* pixels, std::size_t count,
                         const cv::Mat3f& points_m, int samples, bool median, Rng& rng) {
  constexpr int kDrawsPerSample = 8;  // pixels without depth are drawn in vain; a mask may have few with
  std::vector<double> means;
  for (int draw = 0; draw < kDrawsPerSample * samples && static_cast<int>(means.size()) < samples; ++draw) {
    const int i = pixels[rng.below(count)];
    const cv::Point p(i % mask.cols, i / mask.cols);
    if (points_m(p)[2] == 0.0F) continue;
    const double mean = trimmedNeighbourMean(mask, mask_id, p, points_m);
    if (mean >= 0.0) means.push_back(mean);
  }
  if (means.empty()) return 0.0;
  if (median) return medianOf(std::move(means));
  return std::accumulate(means.begin(), means.end(), 0.0) / static_cast<double>(means.size());  // eq. (3)
}

struct DepthRefiner::Buffers {
  Grid grid;
  std::vector<cv::Point> labelled;  ///< in raster order: most of an image has no label
  ConnectedRegions masks, parts;
  std::vector<int> pixels;  ///< the same, mask by mask
  cv::Mat3f points_m;
  cv::Mat1f reach_m2;
  cv::Mat1b bands, scratch, kept;
  PeopleCompletion completion;

  explicit Buffers(const RefinementConfig& config) : completion(config.stride_px, config.weak_share) {}
};

DepthRefiner::DepthRefiner(const RefinementConfig& config)
    : config_(onGrid(config)), buffers_(std::make_unique<Buffers>(config)) {}
DepthRefiner::~DepthRefiner() = default;
DepthRefiner::DepthRefiner(DepthRefiner&&) noexcept = default;
DepthRefiner& DepthRefiner::operator=(DepthRefiner&&) noexcept = default;

cv::Mat1b DepthRefiner::refine(const Segmentation& segmentation, const LabelSet& label_set, const RgbdFrame& frame) {
  assert(segmentation.labels.size() == frame.depth_m.size());
  if (!config_.enabled) return segmentation.labels.clone();
  cv::Mat1b labels = cut(segmentation.labels, label_set, frame);
  if (!segmentation.weak_people.empty() && label_set.person() != 0) {
    buffers_->completion.complete(labels, segmentation.weak_people, label_set.person(), frame);
  }
  return labels;
}

cv::Mat1b DepthRefiner::cut(const cv::Mat1b& labels, const LabelSet& label_set, const RgbdFrame& frame) {
  auto& [grid, labelled, masks, parts, pixels, points_m, reach_m2, bands, scratch, kept, completion] = *buffers_;
  grid.stride = config_.stride_px;
  takeEvery(grid.stride, labels, grid.labels);
  takeEvery(grid.stride, frame.depth_m, grid.depth_m);
  const cv::Size size = grid.labels.size();
  assert(grid.labels.isContinuous());
  const std::uint8_t* label = grid.labels.ptr<std::uint8_t>();
  cv::findNonZero(grid.labels, labelled);
  connectRegions<true>(
      size, labelled, [label](int a, int b) { return label[a] == label[b]; }, masks);
  std::vector<GrownMask> grown = collectMasks(masks, labelled, grid, frame.camera->rays(), pixels, points_m);
  reach_m2.create(size);
  reach_m2.setTo(0.0F);
  for (int m = 0; m < masks.count; ++m) prepareGrowth(grown[m], masks, m, points_m, config_, reach_m2);
  // All growths at once: what a seed reaches is the piece it lies in.
  const Steps steps(masks, points_m, reach_m2);
  connectRegions(
      size, labelled, [&steps](int a, int b) { return steps.joined(a, b); }, parts);
  findBands(masks, labelled, steps, grid.depth_m, config_.band_px, bands, scratch);

  std::vector<Piece> pieces = describePieces(parts, masks, labelled, points_m, grid.labels, label_set);
  const std::vector<int> main = mainPieces(grown, pieces, parts);
  keepSurfaces(pieces, main, grown, config_);
  keepEnclosed(pieces, main, grown, parts, bands, config_);

  kept.create(size);
  kept.setTo(0);
  for (const GrownMask& mask : grown) {
    if (static_cast<int>(mask.size_px) < config_.min_mask_px) continue;
    for (std::size_t k = 0; k < mask.size_px; ++k) {
      const int i = mask.pixels[k];
      const bool keep = pieces[parts.id.ptr<int>()[i]].keep && bands.ptr<std::uint8_t>()[i] == 0;
      if (keep) kept.ptr<std::uint8_t>()[i] = label[i];
    }
  }
  return grid.stride == 1 ? kept.clone() : spread(kept, grid, reach_m2, labels, frame.depth_m);
}

}  // namespace semantic_vslam
