// SPDX-FileCopyrightText: 2026 The semantic_vslam authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string>

#include "core/segmentation/depth_refinement.h"
#include "semantic_vslam/core/common/stamp.h"

namespace semantic_vslam {

/// Stage 3: the network and the refinement of its masks on depth.
struct SegmentationConfig {
  std::string model;
  std::string sidecar;
  std::string provider = "auto";
  int threads = 1;
  int arena_mb = 512;
  double longest_gap_s = 0.5;
  double weak_person = 0.1;
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
