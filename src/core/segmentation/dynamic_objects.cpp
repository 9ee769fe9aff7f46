// SPDX-FileCopyrightText: 2026 The semantic_vslam authors
// SPDX-License-Identifier: BSD-3-Clause
#include "semantic_vslam/core/segmentation/dynamic_objects.h"

#include <cassert>

#include "semantic_vslam/core/segmentation/connected_regions.h"

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
  const ConnectedRegions masks = connectRegions(
      labels.size(), [label](int i) { return label[i] != 0; }, [label](int a, int b) { return label[a] == label[b]; });

  std::vector<DynamicObject> objects(masks.count);
  std::vector<int> moving_px(masks.count, 0);
  for (int v = 0; v < labels.rows; ++v) {
    for (int u = 0; u < labels.cols; ++u) {
      const int m = masks.id(v, u);
      if (m < 0) continue;
      DynamicObject& object = objects[m];
      object.label = labels(v, u);
      object.box |= cv::Rect(u, v, 1, 1);
      ++object.mask_px;
      if (!moving.empty() && moving(v, u) >= kMovingFrom) ++moving_px[m];
    }
  }
  for (int m = 0; m < masks.count; ++m) {
    DynamicObject& object = objects[m];
    object.dynamic_share = static_cast<double>(moving_px[m]) / object.mask_px;  // rho_i, eq. (5)
    object.moving = object.dynamic_share > phi;
    object.removed = isRemoved(label_set.mobility(object.label), object.moving);
  }
  if (removal_mask != nullptr) {
    removal_mask->create(labels.size());
    for (int v = 0; v < labels.rows; ++v) {
      for (int u = 0; u < labels.cols; ++u) {
        const int m = masks.id(v, u);
        (*removal_mask)(v, u) = m >= 0 && objects[m].removed ? 255 : 0;
      }
    }
  }
  return objects;
}

}  // namespace semantic_vslam
