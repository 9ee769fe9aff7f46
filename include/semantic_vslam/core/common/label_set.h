// SPDX-FileCopyrightText: 2026 The semantic_vslam authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <opencv2/core.hpp>
#include <string>
#include <vector>

namespace semantic_vslam {

/// How a class behaves. People never enter map or pose; movable things only while they stand still, by eq. (5).
enum class Mobility { kStatic, kMovable, kPerson };

/// One class that a network tells apart.
struct LabelClass {
  std::string name;
  Mobility mobility = Mobility::kStatic;
  cv::Vec3b color_bgr;

  bool operator==(const LabelClass& other) const {
    return name == other.name && mobility == other.mobility && color_bgr == other.color_bgr;
  }
};

/// The classes of a network; the label image holds indices into it. Index 0 is always "background" (unlabelled).
struct LabelSet {
  std::vector<LabelClass> classes{{"background", Mobility::kStatic, cv::Vec3b(90, 90, 90)}};

  std::size_t size() const { return classes.size(); }
  Mobility mobility(std::uint8_t label) const {
    return label < classes.size() ? classes[label].mobility : Mobility::kStatic;
  }
  /// @return the first label that is a person; 0 if none is.
  std::uint8_t person() const {
    for (std::size_t label = 1; label < classes.size(); ++label) {
      if (classes[label].mobility == Mobility::kPerson) return static_cast<std::uint8_t>(label);
    }
    return 0;
  }
};

/// The decision which objects are kept out of pose and map.
struct RemovalConfig {
  double phi = 0.4;

  template <class Visitor>
  void visit(Visitor& v) {
    v.field("phi", phi, 0.0, 1.0, "eq. (5): an object moves when more than this share of its mask moves");
  }
};

}  // namespace semantic_vslam
