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

/// Pixels of every region, in raster order: those of region k are pixels[first[k]] to pixels[first[k + 1]].
struct PixelLists {
  std::vector<int> pixels;
  std::vector<int> first;
};

PixelLists listPixels(const ConnectedRegions& regions) {
  PixelLists lists;
  lists.first.assign(regions.count + 1, 0);
  const int* id = regions.id.ptr<int>();
  const int total = static_cast<int>(regions.id.total());
  for (int i = 0; i < total; ++i) {
    if (id[i] >= 0) ++lists.first[id[i] + 1];
  }
  for (int k = 0; k < regions.count; ++k) lists.first[k + 1] += lists.first[k];
  lists.pixels.resize(lists.first.back());
  std::vector<int> next(lists.first.begin(), lists.first.end() - 1);
  for (int i = 0; i < total; ++i) {
    if (id[i] >= 0) lists.pixels[next[id[i]]++] = i;
  }
  return lists;
}

float squaredDistance(const cv::Vec3f& a, const cv::Vec3f& b) {
  const cv::Vec3f d = a - b;
  return d.dot(d);
}

cv::Mat3f pointsOf(const cv::Mat1b& labels, const RgbdFrame& frame) {
  cv::Mat3f points(labels.size());
  const cv::Mat2f& rays = frame.camera->rays();
  for (int v = 0; v < labels.rows; ++v) {
    for (int u = 0; u < labels.cols; ++u) {
      if (labels(v, u) == 0) continue;
      const float z = frame.depth_m(v, u);
      points(v, u) = {rays(v, u)[0] * z, rays(v, u)[1] * z, z};
    }
  }
  return points;
}

/// The pixel with depth that is nearest to the centroid.
cv::Point seedOf(const std::vector<cv::Point>& with_depth, const cv::Point2d& centroid) {
  const auto squared = [&centroid](const cv::Point& p) {
    const cv::Point2d d(p.x - centroid.x, p.y - centroid.y);
    return d.dot(d);
  };
  return *std::min_element(with_depth.begin(), with_depth.end(),
                           [&squared](const cv::Point& a, const cv::Point& b) { return squared(a) < squared(b); });
}

/// Median of the depths that are not 0; 0 if there are none.
float medianDepth(const cv::Mat3f& points_m, const int* begin, const int* end) {
  std::vector<float> depths;
  depths.reserve(end - begin);
  for (const int* i = begin; i != end; ++i) {
    const float z = points_m.ptr<cv::Vec3f>()[*i][2];
    if (z > 0.0F) depths.push_back(z);
  }
  if (depths.empty()) return 0.0F;
  std::nth_element(depths.begin(), depths.begin() + depths.size() / 2, depths.end());
  return depths[depths.size() / 2];
}

/// What is known of one connected mask before it is grown.
struct Mask {
  bool has_depth = false;
  cv::Point seed;
  float squared_threshold_m2 = 0.0F;  ///< T^2 of eq. (4) at median_depth_m; infinite where no rho could be taken
  float median_depth_m = 0.0F;
};

Mask prepareMask(const ConnectedRegions& masks, int mask_id, const int* begin, const int* end,
                 const cv::Mat3f& points_m, const RefinementConfig& config) {
  std::vector<cv::Point> pixels, with_depth;
  pixels.reserve(end - begin);
  with_depth.reserve(end - begin);
  for (const int* i = begin; i != end; ++i) {
    const cv::Point p(*i % masks.id.cols, *i / masks.id.cols);
    pixels.push_back(p);
    if (points_m(p)[2] > 0.0F) with_depth.push_back(p);
  }
  Mask mask;
  mask.has_depth = !with_depth.empty();
  if (!mask.has_depth) return mask;
  mask.median_depth_m = medianDepth(points_m, begin, end);
  mask.seed = seedOf(with_depth, centroidByMoments(pixels));
  Rng rng(static_cast<std::uint64_t>(config.seed));
  const double rho_m =
      neighbourDistance(masks.id, mask_id, with_depth, points_m, config.samples, config.average == "median", rng);
  const double threshold_m = config.epsilon * rho_m;  // eq. (4)
  mask.squared_threshold_m2 =
      rho_m > 0.0 ? static_cast<float>(threshold_m * threshold_m) : std::numeric_limits<float>::infinity();
  return mask;
}

/// A piece of a mask: one depth-continuous surface, or one hole.
struct Region {
  int mask_id = 0;
  int size_px = 0;
  bool hole = false;
  bool person = false;
  float median_depth_m = 0.0F;
  double thickness_px = 0.0;  ///< mean width: a band of width w has 2 border pixels for every w pixels
};

/// Number of a part's pixels that have a neighbour outside of it, or lie on the image's edge.
int borderPixels(const ConnectedRegions& parts, const int* begin, const int* end) {
  const int width = parts.id.cols, height = parts.id.rows;
  const int* id = parts.id.ptr<int>();
  int border = 0;
  for (const int* i = begin; i != end; ++i) {
    const int u = *i % width, v = *i / width, part = id[*i];
    const bool inside = u > 0 && v > 0 && u + 1 < width && v + 1 < height && id[*i - 1] == part && id[*i + 1] == part &&
                        id[*i - width] == part && id[*i + width] == part;
    if (!inside) ++border;
  }
  return border;
}

std::vector<Region> describeRegions(const ConnectedRegions& parts, const PixelLists& lists,
                                    const ConnectedRegions& masks, const cv::Mat3f& points_m, const cv::Mat1b& labels,
                                    const LabelSet& label_set) {
  std::vector<Region> regions(parts.count);
  for (int k = 0; k < parts.count; ++k) {
    const int* begin = lists.pixels.data() + lists.first[k];
    const int* end = lists.pixels.data() + lists.first[k + 1];
    Region& region = regions[k];
    region.mask_id = masks.id.ptr<int>()[*begin];
    region.size_px = static_cast<int>(end - begin);
    region.hole = points_m.ptr<cv::Vec3f>()[*begin][2] == 0.0F;
    region.person = label_set.mobility(labels.ptr<std::uint8_t>()[*begin]) == Mobility::kPerson;
    if (region.hole) continue;
    region.median_depth_m = medianDepth(points_m, begin, end);
    region.thickness_px = 2.0 * region.size_px / borderPixels(parts, begin, end);
  }
  return regions;
}

/// The seed's region, or the mask's largest where the seed fell on something less than half as large.
std::vector<int> mainRegions(const std::vector<Mask>& masks, const std::vector<Region>& regions,
                             const ConnectedRegions& parts) {
  std::vector<int> largest(masks.size(), -1);
  for (std::size_t k = 0; k < regions.size(); ++k) {
    int& best = largest[regions[k].mask_id];
    if (!regions[k].hole && (best < 0 || regions[k].size_px > regions[best].size_px)) best = static_cast<int>(k);
  }
  for (std::size_t m = 0; m < masks.size(); ++m) {
    if (largest[m] < 0) continue;
    const int seeded = parts.id(masks[m].seed);
    if (2 * regions[seeded].size_px >= regions[largest[m]].size_px) largest[m] = seeded;
  }
  return largest;
}

std::vector<char> keptSurfaces(const std::vector<Region>& regions, const std::vector<int>& main_of_mask,
                               const PixelLists& mask_pixels, const RefinementConfig& config) {
  std::vector<char> keep(regions.size(), 0);
  for (std::size_t k = 0; k < regions.size(); ++k) {
    const Region& region = regions[k];
    const int main = main_of_mask[region.mask_id];
    if (region.hole || main < 0) continue;
    const int mask_px = mask_pixels.first[region.mask_id + 1] - mask_pixels.first[region.mask_id];
    const bool large = config.min_region_share < 1.0 && region.size_px >= config.min_region_share * mask_px;
    const bool solid = region.thickness_px >= config.min_thickness_px;
    const bool near = std::abs(region.median_depth_m - regions[main].median_depth_m) <= config.object_depth_m;
    keep[k] = static_cast<int>(k) == main || (large && solid && (near || region.person));
  }
  return keep;
}

/// A hole stays if most of the pixels around it do. What lies outside the mask counts against it: sensors lose depth
/// beside an object, in its shadow, as well as on it.
void keepEnclosedHoles(const std::vector<Region>& regions, const ConnectedRegions& parts, const PixelLists& lists,
                       const std::vector<int>& main_of_mask, std::vector<char>& keep) {
  const cv::Rect image({0, 0}, parts.id.size());
  const std::vector<char> surface_kept = keep;
  for (std::size_t k = 0; k < regions.size(); ++k) {
    if (!regions[k].hole) continue;
    if (main_of_mask[regions[k].mask_id] < 0) {  // no depth in the whole mask
      keep[k] = 1;
      continue;
    }
    int balance = 0;
    for (int i = lists.first[k]; i < lists.first[k + 1]; ++i) {
      const cv::Point p(lists.pixels[i] % image.width, lists.pixels[i] / image.width);
      for (const cv::Point& step : kNeighbours) {
        const cv::Point q = p + step;
        if (!image.contains(q)) continue;
        const int part = parts.id(q);
        if (part == static_cast<int>(k)) continue;
        balance += part >= 0 && surface_kept[part] ? 1 : -1;
      }
    }
    keep[k] = balance > 0;
  }
}

}  // namespace

cv::Point2d centroidByMoments(const std::vector<cv::Point>& pixels) {
  assert(!pixels.empty());
  double m10 = 0.0, m01 = 0.0;
  for (const cv::Point& p : pixels) {
    m10 += p.x;
    m01 += p.y;
  }
  const auto m00 = static_cast<double>(pixels.size());
  return {m10 / m00, m01 / m00};  // eq. (2)
}

double neighbourDistance(const cv::Mat1i& mask, int mask_id, const std::vector<cv::Point>& pixels,
                         const cv::Mat3f& points_m, int samples, bool median, Rng& rng) {
  const cv::Rect image({0, 0}, mask.size());
  std::vector<double> means;
  for (int n = 0; n < samples; ++n) {
    const cv::Point p = pixels[rng.below(pixels.size())];
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
    if (count >= 3) means.push_back((sum - smallest - largest) / (count - 2));  // eq. (3), one pixel
  }
  if (means.empty()) return 0.0;
  if (!median) return std::accumulate(means.begin(), means.end(), 0.0) / static_cast<double>(means.size());
  std::nth_element(means.begin(), means.begin() + means.size() / 2, means.end());
  return means[means.size() / 2];
}

cv::Mat1b refineOnDepth(const cv::Mat1b& labels, const LabelSet& label_set, const RgbdFrame& frame,
                        const RefinementConfig& config) {
  assert(labels.size() == frame.depth_m.size());
  if (!config.enabled) return labels.clone();
  const std::uint8_t* label = labels.ptr<std::uint8_t>();
  const ConnectedRegions masks = connectRegions(
      labels.size(), [label](int i) { return label[i] != 0; }, [label](int a, int b) { return label[a] == label[b]; });
  const PixelLists mask_pixels = listPixels(masks);
  const cv::Mat3f points_m = pointsOf(labels, frame);
  std::vector<Mask> prepared(masks.count);
  for (int m = 0; m < masks.count; ++m) {
    const int* pixels = mask_pixels.pixels.data();
    prepared[m] =
        prepareMask(masks, m, pixels + mask_pixels.first[m], pixels + mask_pixels.first[m + 1], points_m, config);
  }

  // All growths at once: what the seed reaches is the connected region it lies in.
  const int* mask_of = masks.id.ptr<int>();
  const auto* point = points_m.ptr<cv::Vec3f>();
  const ConnectedRegions parts = connectRegions(
      labels.size(), [mask_of](int i) { return mask_of[i] >= 0; },
      [&](int a, int b) {
        if (mask_of[a] != mask_of[b]) return false;
        const bool hole_a = point[a][2] == 0.0F, hole_b = point[b][2] == 0.0F;
        if (hole_a || hole_b) return hole_a && hole_b;
        // Pixels of a farther part lie farther apart: the threshold grows with them.
        const Mask& mask = prepared[mask_of[a]];
        const float farther = std::max(1.0F, std::min(point[a][2], point[b][2]) / mask.median_depth_m);
        return squaredDistance(point[a], point[b]) < mask.squared_threshold_m2 * farther * farther;
      });
  const PixelLists part_pixels = listPixels(parts);
  const std::vector<Region> regions = describeRegions(parts, part_pixels, masks, points_m, labels, label_set);
  const std::vector<int> main_of_mask = mainRegions(prepared, regions, parts);
  std::vector<char> keep = keptSurfaces(regions, main_of_mask, mask_pixels, config);
  keepEnclosedHoles(regions, parts, part_pixels, main_of_mask, keep);

  cv::Mat1b refined(labels.size());
  std::uint8_t* out = refined.ptr<std::uint8_t>();
  const int* part_of = parts.id.ptr<int>();
  for (int i = 0; i < static_cast<int>(labels.total()); ++i) {
    const bool noise =
        part_of[i] < 0 || mask_pixels.first[mask_of[i] + 1] - mask_pixels.first[mask_of[i]] < config.min_mask_px;
    out[i] = !noise && keep[part_of[i]] ? label[i] : 0;
  }
  return refined;
}

}  // namespace semantic_vslam
