// SPDX-FileCopyrightText: 2026 The semantic_vslam authors
// SPDX-License-Identifier: BSD-3-Clause
#include "core/labels/dynamic_objects.h"

#include <cassert>

#include "core/labels/connected_regions.h"

namespace semantic_vslam {
namespace {

constexpr std::uint8_t kMovingFrom = 128;

bool isRemoved(Mobility mobility, bool moving) {
  switch (mobility) {
    case Mobility::kPerson: return true;
    case Mobility::kMovable: return moving;
    case Mobility::kStatic: return false;
  }
  return false;
}

}  // namespace

std::vector<DynamicObject> decideDynamic(const cv::Mat1b& labels, const LabelSet& label_set, const cv::Mat1b& moving,
                                         double phi, cv::Mat1b* removal_mask) {
  assert(moving.empty() || moving.size() == labels.size());
  const std::uint8_t* label = labels.ptr<std::uint8_t>();
  std::vector<cv::Point> pixels;
  cv::findNonZero(labels, pixels);
  ConnectedRegions masks;
  connectRegions<true>(
      labels.size(), pixels, [label](int a, int b) { return label[a] == label[b]; }, masks);

  std::vector<DynamicObject> objects(masks.count);
  std::vector<int> moving_px(masks.count, 0);
  for (const cv::Point& p : pixels) {
    const int m = masks.id(p);
    DynamicObject& object = objects[m];
    object.label = labels(p);
    object.box |= cv::Rect(p, cv::Size(1, 1));
    ++object.mask_px;
    if (!moving.empty() && moving(p) >= kMovingFrom) ++moving_px[m];
  }
  for (int m = 0; m < masks.count; ++m) {
    DynamicObject& object = objects[m];
    object.dynamic_share = static_cast<double>(moving_px[m]) / object.mask_px;  // rho_i, eq. (5)
    object.moving = object.dynamic_share > phi;
    object.removed = isRemoved(label_set.mobility(object.label), object.moving);
  }
  if (removal_mask != nullptr) {
    removal_mask->create(labels.size());
    removal_mask->setTo(0);
    for (const cv::Point& p : pixels) {
      if (objects[masks.id(p)].removed) (*removal_mask)(p) = 255;
    }
  }
  return objects;
}

cv::Mat1b maskOfPeople(const cv::Mat1b& labels, const LabelSet& label_set) {
  cv::Mat1b is_person(1, 256, std::uint8_t{0}), people;
  for (int label = 0; label < 256; ++label) {
    if (label_set.mobility(static_cast<std::uint8_t>(label)) == Mobility::kPerson) is_person(0, label) = 255;
  }
  cv::LUT(labels, is_person, people);
  return people;
}

}  // namespace semantic_vslam
