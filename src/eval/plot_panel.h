// SPDX-FileCopyrightText: 2026 The semantic_vslam authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <opencv2/core.hpp>
#include <string>
#include <vector>

namespace semantic_vslam {

/// A picture that plots are drawn on; larger inside than its final size, so that lines and text come out smooth.
class PlotCanvas {
 public:
  explicit PlotCanvas(cv::Size size_px);

  /// Draws text. @param at_px  left end of its base line, in pixels of the final picture
  void text(const std::string& text, cv::Point2d at_px, double height_px, const cv::Scalar& bgr, bool bold = false);
  /// Draws an image scaled into an area of the final picture.
  void image(const cv::Mat3b& bgr, cv::Rect area_px);
  void fill(cv::Rect2d area_px, const cv::Vec3b& bgr);
  /// @return width in pixels of the final picture.
  static double textWidth(const std::string& text, double height_px);
  /// @return the picture in its final size.
  cv::Mat3b picture() const;

 private:
  friend class PlotPanel;
  cv::Mat3b image_;
};

/// Interval of one axis, in the unit of the data.
struct AxisRange {
  double low = 0.0, high = 1.0;

  /// Smallest interval that holds the values, widened by a share of its length on both sides.
  static AxisRange around(const std::vector<double>& values, double margin);
};

struct PanelText {
  std::string title, x_label, y_label;
};

/// One pair of axes on a canvas: title, grid, ticks at 1, 2 or 5 times a power of ten, lines, legend.
class PlotPanel {
 public:
  /// @param area_px     in pixels of the final picture, labels included
  /// @param same_scale  one metre is as long along x as along y; the range that is too short for its side is widened
  PlotPanel(PlotCanvas& canvas, cv::Rect area_px, const PanelText& text, AxisRange x, AxisRange y, bool same_scale);

  void line(const std::vector<cv::Point2d>& points, const cv::Scalar& bgr, double width_px);
  void segment(cv::Point2d from, cv::Point2d to, const cv::Scalar& bgr, double width_px);
  void disc(cv::Point2d center, double radius_px, const cv::Scalar& bgr);
  /// Small square without smoothing, for clouds of many points.
  void dot(cv::Point2d at, double size_px, const cv::Vec3b& bgr);
  /// @return pixels of the final picture that one unit of x takes.
  double pixelsPerUnitX() const { return box_px_.width / (x_.high - x_.low); }
  /// Adds a line to the legend in the upper right corner.
  void legend(const std::string& name, const cv::Scalar& bgr);

 private:
  void drawTicks(AxisRange range, bool along_x);
  void drawLabels(const PanelText& text);
  cv::Point2d toPixel(cv::Point2d value) const;  // in pixels of the large picture
  cv::Mat3b& image_;
  PlotCanvas& canvas_;
  cv::Rect2d box_px_;  // of the axes, in pixels of the final picture
  AxisRange x_, y_;
  int legend_lines_ = 0;
};

}  // namespace semantic_vslam
