// SPDX-FileCopyrightText: 2026 The semantic_vslam authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string>

#include "semantic_vslam/core/common/stamp.h"

namespace semantic_vslam {

/// Largest edge of the blocks that masks are refined in, px.
constexpr int kMaxBlockStride = 8;

/// Cutting of the network's masks to the objects' edges in depth, eq. (2) to (4).
struct RefinementConfig {
  bool enabled = true;
  double epsilon = 2.0;
  int samples = 100;
  std::string average = "median";
  int seed = 1;
  int stride_px = 3;
  int min_mask_px = 40;
  int band_px = 12;
  double min_region_share = 0.02;
  double min_thickness_px = 12.0;
  double object_depth_m = 0.5;
  double weak_share = 0.4;

  template <class Visitor>
  void visit(Visitor& v) {
    v.flag("enabled", enabled, "false: the network's masks are used as they are");
    v.field("weak_share", weak_share, 0.0, 1.0,
            "a surface of which this share is a person, and the rest may be one (weak_person), is a person as a whole");
    v.field("epsilon", epsilon, 0.1, 100.0, "eq. (4): growth crosses steps below epsilon times the mask's mean step");
    v.field("samples", samples, 1, 10000, "eq. (3): random pixels of a mask that its mean step is taken from");
    v.choice("average", average, {"mean", "median"},
             "eq. (3) over the samples; the mean is as published, the median ignores samples on the object's edge");
    v.field("seed", seed, 0, 1000000000, "of the random samples");
    v.field("stride_px", stride_px, 1, kMaxBlockStride,
            "regions grow over every so many-th pixel of row and column, and the pixels between go with the one they "
            "are level with; 1: over all, as published, at five times the cost of 3");
    v.field("min_mask_px", min_mask_px, 0, 100000, "smaller connected masks are dropped as noise of the network, px");
    v.field("band_px", band_px, 0, 100,
            "background inside the mask's border is cut up to this width, px: what lies behind a depth edge or in the "
            "plane "
            "outside; 0: only what growth does not reach, as published");
    v.field("min_region_share", min_region_share, 0.0, 1.0,
            "regions of a mask beside the seed's are grown too if they hold this share of it; 1: never, as published");
    v.field("min_thickness_px", min_thickness_px, 0.0, 1000.0,
            "and are this thick on average, px: a mask that is too large leaves a thin band of what lies behind");
    v.field("object_depth_m", object_depth_m, 0.0, 10.0,
            "and if their mean depth lies within this of the seed region's, m: an arm before a body, not the wall; "
            "people stay at any depth, since two who overlap make one mask");
  }
};

/// Stage 3: the network and the refinement of its masks on depth.
struct SegmentationConfig {
  std::string model = "bisenetv2_indoor.onnx";
  std::string sidecar;
  std::string provider = "auto";
  int threads = 1;
  int arena_mb = 512;
  double longest_gap_s = 0.5;
  double weak_person = 0.25;
  RefinementConfig refinement;

  template <class Visitor>
  void visit(Visitor& v) {
    v.text(
        "model", model,
        "semantic network: an .onnx file, or its name in this package's folder models; empty: motion detection alone");
    v.text("sidecar", sidecar,
           "YAML that describes the network; empty: the .yaml of the same stem beside it, else in models/sidecars");
    v.choice("provider", provider, {"auto", "cpu", "cuda", "tensorrt"},
             "where the network runs; auto: TensorRT, else CUDA, where the library and the machine have it, else CPU");
    v.field("threads", threads, 1, 64,
            "threads of the network on the CPU; 1 leaves a two-core robot its tracking core");
    v.field("arena_mb", arena_mb, 16, 16384, "upper bound of the network's working memory, MiB");
    v.field(
        "longest_gap_s", longest_gap_s, 0.1, 3600.0,
        "a frame is segmented this long after the last one although it is no keyframe, s: a robot that stands still "
        "makes none, and who then stops in front of it must not be forgotten. With the network's own time it should "
        "stay below 0.9 s, after which a mask gives way to a surface at rest");
    v.field("weak_person", weak_person, 0.001, 1.0,
            "what is this likely to be a person, although something else is likelier, becomes one where depth puts it "
            "on a person's surface (refinement.weak_share); 1: never");
    v.group("refinement", refinement);
  }

  /// Whether a frame is to be segmented although it is no keyframe. @param last  frame that was segmented last
  bool labelsAreDue(Stamp last, Stamp now) const {
    const double gap_s = secondsBetween(last, now);
    return gap_s < 0.0 || gap_s >= longest_gap_s;  // below 0: the recording began again
  }
};

}  // namespace semantic_vslam
