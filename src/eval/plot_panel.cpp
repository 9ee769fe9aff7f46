// SPDX-FileCopyrightText: 2026 The semantic_vslam authors
// SPDX-License-Identifier: BSD-3-Clause
#include "eval/plot_panel.h"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <opencv2/imgproc.hpp>

namespace semantic_vslam {
namespace {

constexpr int kSupersample = 2;
constexpr int kFont = cv::FONT_HERSHEY_SIMPLEX;
constexpr double kFontHeightPx = 21.0;  // of a capital letter at scale 1
constexpr double kTextPx = 10.0, kTitlePx = 12.0;
constexpr int kSubpixelBits = 4;

const cv::Scalar kInk(50, 50, 50), kGridColor(228, 228, 228), kWhite(255, 255, 255);

int thickness(double width_px) { return std::max(1, static_cast<int>(std::lround(width_px * kSupersample))); }

cv::Point fixedPoint(cv::Point2d px) {
  constexpr double kFactor = 1 << kSubpixelBits;
  return {static_cast<int>(std::lround(px.x * kFactor)), static_cast<int>(std::lround(px.y * kFactor))};
}

/// Step of 1, 2 or 5 times a power of ten that gives about the wanted number of ticks.
double tickStep(AxisRange range, double wanted) {
  const double rough = (range.high - range.low) / std::max(wanted, 1.0);
  const double power = std::pow(10.0, std::floor(std::log10(rough)));
  for (const double factor : {1.0, 2.0, 5.0}) {
    if (factor * power >= rough) return factor * power;
  }
  return 10.0 * power;
}

std::vector<double> ticksOf(AxisRange range, double step) {
  std::vector<double> ticks;
  const auto last = static_cast<long>(std::floor(range.high / step + 1e-9));
  for (auto k = static_cast<long>(std::ceil(range.low / step - 1e-9)); k <= last; ++k) {
    ticks.push_back(static_cast<double>(k) * step);
  }
  return ticks;
}

std::string tickText(double value, double step) {
  const int decimals = std::max(0, static_cast<int>(std::ceil(-std::log10(step) - 1e-9)));
  char text[32];
  std::snprintf(text, sizeof text, "%.*f", decimals, value);
  return text;
}

void widenTo(AxisRange& range, double length) {
  const double middle = 0.5 * (range.low + range.high);
  range = {middle - 0.5 * length, middle + 0.5 * length};
}

double ticksWanted(double side_px, double px_per_tick) { return side_px / px_per_tick; }

}  // namespace

PlotCanvas::PlotCanvas(cv::Size size_px) : image_(size_px * kSupersample, cv::Vec3b(255, 255, 255)) {}

void PlotCanvas::text(const std::string& text, cv::Point2d at_px, double height_px, const cv::Scalar& bgr, bool bold) {
  const double scale = height_px * kSupersample / kFontHeightPx;
  cv::putText(image_, text, cv::Point(at_px * kSupersample), kFont, scale, bgr, bold ? 3 : 2, cv::LINE_AA);
}

void PlotCanvas::image(const cv::Mat3b& bgr, cv::Rect area_px) {
  const cv::Rect area(area_px.tl() * kSupersample, area_px.size() * kSupersample);
  cv::resize(bgr, image_(area), area.size(), 0, 0, cv::INTER_LINEAR);
}

void PlotCanvas::fill(cv::Rect2d area_px, const cv::Vec3b& bgr) {
  image_(cv::Rect(area_px.tl() * kSupersample, area_px.br() * kSupersample)).setTo(bgr);
}

double PlotCanvas::textWidth(const std::string& text, double height_px) {
  int baseline = 0;
  return cv::getTextSize(text, kFont, height_px * kSupersample / kFontHeightPx, 2, &baseline).width /
         static_cast<double>(kSupersample);
}

cv::Mat3b PlotCanvas::picture() const {
  cv::Mat3b small;
  cv::resize(image_, small, image_.size() / kSupersample, 0, 0, cv::INTER_AREA);
  return small;
}

AxisRange AxisRange::around(const std::vector<double>& values, double margin) {
  if (values.empty()) return {0.0, 1.0};
  const auto [low, high] = std::minmax_element(values.begin(), values.end());
  const double pad = std::max(margin * (*high - *low), 1e-3);
  return {*low - pad, *high + pad};
}

PlotPanel::PlotPanel(PlotCanvas& canvas, cv::Rect area_px, const PanelText& text, AxisRange x, AxisRange y,
                     bool same_scale)
    : image_(canvas.image_),
      canvas_(canvas),
      box_px_(area_px.x + 72, area_px.y + 34, area_px.width - 90, area_px.height - 82),
      x_(x),
      y_(y) {
  if (same_scale) {
    const double unit_per_px = std::max((x.high - x.low) / box_px_.width, (y.high - y.low) / box_px_.height);
    widenTo(x_, unit_per_px * box_px_.width);
    widenTo(y_, unit_per_px * box_px_.height);
  }
  drawTicks(x_, true);
  drawTicks(y_, false);
  drawLabels(text);
  cv::rectangle(image_, cv::Rect(box_px_.tl() * kSupersample, box_px_.br() * kSupersample), kInk, thickness(1.0),
                cv::LINE_AA);
}

void PlotPanel::drawTicks(AxisRange range, bool along_x) {
  const double step = tickStep(range, along_x ? ticksWanted(box_px_.width, 90.0) : ticksWanted(box_px_.height, 55.0));
  for (const double tick : ticksOf(range, step)) {
    const std::string text = tickText(tick, step);
    const double width_px = PlotCanvas::textWidth(text, kTextPx);
    if (along_x) {
      segment({tick, y_.low}, {tick, y_.high}, kGridColor, 1.0);
      const double u_px = toPixel({tick, y_.low}).x / kSupersample;
      canvas_.text(text, {u_px - width_px / 2, box_px_.br().y + 18}, kTextPx, kInk);
    } else {
      segment({x_.low, tick}, {x_.high, tick}, kGridColor, 1.0);
      const double v_px = toPixel({x_.low, tick}).y / kSupersample;
      canvas_.text(text, {box_px_.x - width_px - 7, v_px + kTextPx / 2}, kTextPx, kInk);
    }
  }
}

void PlotPanel::drawLabels(const PanelText& text) {
  const cv::Point2d middle = 0.5 * (box_px_.tl() + box_px_.br());
  canvas_.text(text.title, {box_px_.x, box_px_.y - 11}, kTitlePx, kInk, true);
  const double x_width_px = PlotCanvas::textWidth(text.x_label, kTextPx);
  canvas_.text(text.x_label, {middle.x - x_width_px / 2, box_px_.br().y + 40}, kTextPx, kInk);

  // The y label is written level on a strip of its own and turned.
  const double y_width_px = PlotCanvas::textWidth(text.y_label, kTextPx);
  PlotCanvas strip(cv::Size(static_cast<int>(y_width_px) + 8, 20));
  strip.text(text.y_label, {4, 14}, kTextPx, kInk);
  cv::Mat3b turned;
  cv::rotate(strip.image_, turned, cv::ROTATE_90_COUNTERCLOCKWISE);
  const cv::Point2d corner(box_px_.x - 70, middle.y - y_width_px / 2);
  const cv::Rect place = cv::Rect(cv::Point(corner * kSupersample), turned.size()) & cv::Rect({0, 0}, image_.size());
  turned(cv::Rect({0, 0}, place.size())).copyTo(image_(place));
}

cv::Point2d PlotPanel::toPixel(cv::Point2d value) const {
  const double u = (value.x - x_.low) / (x_.high - x_.low), v = (y_.high - value.y) / (y_.high - y_.low);
  return cv::Point2d(box_px_.x + u * box_px_.width, box_px_.y + v * box_px_.height) * kSupersample;
}

void PlotPanel::line(const std::vector<cv::Point2d>& points, const cv::Scalar& bgr, double width_px) {
  std::vector<cv::Point> pixels;
  for (const auto& point : points) pixels.push_back(fixedPoint(toPixel(point)));
  cv::polylines(image_, pixels, false, bgr, thickness(width_px), cv::LINE_AA, kSubpixelBits);
}

void PlotPanel::segment(cv::Point2d from, cv::Point2d to, const cv::Scalar& bgr, double width_px) {
  cv::line(image_, fixedPoint(toPixel(from)), fixedPoint(toPixel(to)), bgr, thickness(width_px), cv::LINE_AA,
           kSubpixelBits);
}

void PlotPanel::disc(cv::Point2d center, double radius_px, const cv::Scalar& bgr) {
  const int radius = static_cast<int>(std::lround(radius_px * kSupersample * (1 << kSubpixelBits)));
  cv::circle(image_, fixedPoint(toPixel(center)), radius, bgr, cv::FILLED, cv::LINE_AA, kSubpixelBits);
}

void PlotPanel::dot(cv::Point2d at, double size_px, const cv::Vec3b& bgr) {
  const cv::Rect axes(cv::Point(box_px_.tl() * kSupersample), cv::Point(box_px_.br() * kSupersample));
  const int side = thickness(size_px);
  const cv::Point2d center = toPixel(at);
  const cv::Point corner(cvRound(center.x) - side / 2, cvRound(center.y) - side / 2);
  const cv::Rect square = cv::Rect(corner, cv::Size(side, side)) & axes;
  if (!square.empty()) image_(square).setTo(bgr);
}

void PlotPanel::legend(const std::string& name, const cv::Scalar& bgr) {
  const double width_px = 46 + PlotCanvas::textWidth(name, kTextPx);
  const cv::Point2d corner(box_px_.br().x - width_px - 8, box_px_.y + 8 + 20.0 * legend_lines_++);
  cv::Mat3b patch = image_(cv::Rect(cv::Point(corner * kSupersample),
                                    cv::Size(static_cast<int>(width_px * kSupersample), 20 * kSupersample)));
  cv::addWeighted(patch, 0.2, cv::Mat3b(patch.size(), cv::Vec3b(255, 255, 255)), 0.8, 0.0, patch);
  const cv::Point2d begin = (corner + cv::Point2d(6, 10)) * kSupersample;
  cv::line(image_, fixedPoint(begin), fixedPoint(begin + cv::Point2d(26 * kSupersample, 0)), bgr, thickness(2.5),
           cv::LINE_AA, kSubpixelBits);
  canvas_.text(name, corner + cv::Point2d(39, 15), kTextPx, kInk);
}

}  // namespace semantic_vslam
