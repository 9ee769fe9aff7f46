// SPDX-FileCopyrightText: 2026 The semantic_vslam authors
// SPDX-License-Identifier: BSD-3-Clause
#include "core/pipeline/removal.h"

#include <opencv2/imgproc.hpp>

#include "core/labels/dynamic_objects.h"

namespace semantic_vslam {

cv::Mat1b removedPixels(const MotionResult& motion, const cv::Mat1b& labels, const LabelSet& label_set,
                        const RemovalConfig& config) {
  if (labels.empty() || (!motion.dynamic.empty() && motion.dynamic.size() != labels.size())) return motion.dynamic;
  cv::Mat1b moving, removed;
  // Not `dynamic`: what labels of an earlier frame say must not prove that an object moves.
  if (!motion.moving.empty()) cv::resize(motion.moving, moving, labels.size(), 0, 0, cv::INTER_LINEAR);
  decideDynamic(labels, label_set, moving, config.phi, &removed);
  return motion.dynamic.empty() ? removed : cv::Mat1b(cv::max(motion.dynamic, removed));
}

}  // namespace semantic_vslam
