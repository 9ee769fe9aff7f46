// SPDX-FileCopyrightText: 2026 The semantic_vslam authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <algorithm>
#include <array>
#include <memory>
#include <opencv2/core.hpp>
#include <vector>

#include "core/camera/bilinear.h"
#include "semantic_vslam/core/camera/rgbd_frame.h"
#include "semantic_vslam/core/geometry/se3.h"

namespace semantic_vslam {

struct CellTransform;

/// One row of cells as another camera sees them, each at its depth.
struct ProjectedRow {
  explicit ProjectedRow(int cells) : x(cells), y(cells), depth_m(cells) {}
  std::vector<float> x, y;     ///< position on the grid, cells (may lie outside; meaningless behind the camera)
  std::vector<float> depth_m;  ///< there; 0 or less: behind the camera
};

/// The camera seen on the motion stage's working grid, whose cells are `cell_px` x `cell_px` pixels of the full image.
/// Cell (x, y) stands for the full-image position ((x + 0.5) * cell_px - 0.5, (y + 0.5) * cell_px - 0.5).
class WorkGrid {
 public:
  /// @param flow_width_px  width of the image the flow is computed on; the grid is half of that.
  WorkGrid(std::shared_ptr<const CameraModel> camera, int flow_width_px);

  const CameraModel& camera() const { return *camera_; }
  cv::Size size() const { return size_; }
  /// Size of the gray image that the flow is computed on: twice the grid.
  cv::Size flowSize() const { return {2 * size_.width, 2 * size_.height}; }
  float cellPx() const { return cell_px_; }
  /// Focal length in cells (mean of both axes).
  float focalCells() const { return 0.5F * (fx_ + fy_); }

  /// x/z and y/z of every cell's centre: 2 x float32.
  const cv::Mat2f& rays() const { return rays_; }
  /// Ray of a position between cells, bilinear; positions outside are clamped to the image.
  cv::Vec2f rayAt(float x, float y) const;
  /// @param x, y, z  metres, z > 0  @return position on the grid, in cells (may lie outside).
  cv::Point2f project(float x, float y, float z) const {
    float a = x / z, b = y / z;
    distortPlumbBob(k_, a, b);
    return {fx_ * a + cx_, fy_ * b + cy_};
  }
  /// Projects one row of the grid, at the given depths, into a camera that T takes its points to.
  /// @param depth_m  one a cell, metres
  void projectRow(int row, const float* depth_m, const CellTransform& T, ProjectedRow& out) const;
  bool contains(const cv::Point2f& cell) const {
    return cell.x >= 0.0F && cell.y >= 0.0F && cell.x <= static_cast<float>(size_.width - 1) &&
           cell.y <= static_cast<float>(size_.height - 1);
  }

 private:
  std::shared_ptr<const CameraModel> camera_;
  cv::Size size_;
  float cell_px_ = 1.0F;
  float fx_ = 0, fy_ = 0, cx_ = 0, cy_ = 0;  // in cells
  std::array<float, 5> k_{};
  cv::Mat2f rays_;
  cv::Mat1f rays_x_, rays_y_;  // the same, one channel each
};

/// What the motion stage keeps of a frame. All but `gray` have the grid's size.
struct GridFrame {
  Stamp stamp;
  cv::Mat1b gray;          ///< flow size, 8-bit
  cv::Mat1b cell_gray;     ///< the same, reduced to one value a cell
  cv::Mat1f depth_m;       ///< 0 = none
  cv::Mat1f depth_low_m;   ///< nearest depth of the 3x3 neighbourhood; in a hole, of its wider surroundings; 0 = none
  cv::Mat1f depth_high_m;  ///< farthest, likewise
  cv::Mat1f surface_m;  ///< depth_m, and in holes depth_high_m: a black screen lies about where its farther edge does
  cv::Mat1f texture;    ///< brightness gradient, gray levels per cell
};

GridFrame makeGridFrame(const RgbdFrame& frame, const WorkGrid& grid);

/// Looks in each block of side x side cells for the one with the most texture, so that points lie spread evenly over
/// the image. Where there is less than the camera's own noise gives, flow is interpolated, not measured: no cell is
/// taken.
/// @param usable  called as usable(x, y) with candidates: whether the cell may be taken
/// @param take    called with the cell of each block that has one
template <class Usable, class Take>
void forEachTexturedBlock(const cv::Mat1f& texture, int side, const Usable& usable, const Take& take) {
  constexpr float kLeastTexture = 3.0F;  // gray levels per cell
  for (int block_y = 0; block_y + side <= texture.rows; block_y += side) {
    for (int block_x = 0; block_x + side <= texture.cols; block_x += side) {
      cv::Point best(-1, -1);
      float best_texture = kLeastTexture;
      for (int y = block_y; y < block_y + side; ++y) {
        for (int x = block_x; x < block_x + side; ++x) {
          if (texture(y, x) <= best_texture || !usable(x, y)) continue;
          best_texture = texture(y, x);
          best = {x, y};
        }
      }
      if (best.x >= 0) take(best);
    }
  }
}

/// Rigid motion in single precision, for the loops over all cells.
struct CellTransform {
  explicit CellTransform(const SE3& transform)
      : R(transform.linear().cast<float>()), t(transform.translation().cast<float>()) {}

  /// Direction of a ray (x/z, y/z, 1) after the rotation.
  cv::Point3f turn(const cv::Vec2f& ray) const {
    return {R(0, 0) * ray[0] + R(0, 1) * ray[1] + R(0, 2), R(1, 0) * ray[0] + R(1, 1) * ray[1] + R(1, 2),
            R(2, 0) * ray[0] + R(2, 1) * ray[1] + R(2, 2)};
  }
  /// The point at depth z_m on a ray, given its turned direction.
  cv::Point3f at(const cv::Point3f& turned, float z_m) const {
    return {turned.x * z_m + t.x(), turned.y * z_m + t.y(), turned.z * z_m + t.z()};
  }

  Eigen::Matrix3f R;
  Eigen::Vector3f t;
};

/// Puts f(value) in the place of each cell's value, row by row: a loop that the compiler can take four cells at a time.
template <class Function>
void changeCells(cv::Mat1f& image, const Function& f) {
  for (int y = 0; y < image.rows; ++y) {
    float* row = image[y];
    for (int x = 0; x < image.cols; ++x) row[x] = f(row[x]);
  }
}

}  // namespace semantic_vslam
