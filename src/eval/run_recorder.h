// SPDX-FileCopyrightText: 2026 The semantic_vslam authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <opencv2/core.hpp>
#include <string>

#include "core/dense/dense_mapper.h"
#include "core/io/frame_source.h"
#include "eval/run_report.h"
#include "semantic_vslam/core/camera/rgbd_frame.h"
#include "semantic_vslam/core/dense/dense_result.h"
#include "semantic_vslam/core/geometry/timed_pose.h"
#include "semantic_vslam/core/pipeline/messages.h"

namespace semantic_vslam {

class SparseSlam;

/// Takes in what a run over a recording gives, frame by frame, and leaves the results in a folder.
class RunRecorder {
 public:
  explicit RunRecorder(std::string sequence) { report_.sequence = std::move(sequence); }

  /// Counts one frame's result, scores its mask, and keeps it if it is the best picture of what moves so far.
  /// @param truth  height x width, 255 = moving; empty = not known
  void add(const RgbdFrame& frame, const StepResult& step, const cv::Mat1b& truth);
  RunReport& report() { return report_; }

  /// What a finished run holds.
  struct Results {
    const SparseSlam& slam;
    const DenseMapper& dense;
    const StageTimes& times;
  };
  /// Removes what an earlier run left in a folder, so that all in it is of one run. @throws FileError
  static void clearFolder(const std::string& folder);
  /// Writes trajectory.txt and keyframes.txt as they stand. @throws FileError
  static void writePoses(const std::string& folder, const SparseSlam& slam);
  /// Writes these, timing.csv, cloud.pcd, map.ot and, at the end, overview.png; completes the report by what they hold
  /// and writes it, last, to summary.json: where that is, the files that it names are whole and of one moment.
  /// @param at_end  false: the run goes on  @throws FileError
  void writeResults(const std::string& folder, const Results& results, const DenseConfig& dense,
                    const FrameSource& source, bool at_end);

 private:
  /// The posed frame with most motion in it, for the overview.
  struct Sample {
    double dynamic_share = -1.0;
    Stamp stamp;
    cv::Mat3b bgr;
    cv::Mat1b dynamic;
  };

  void writeOverview(const std::string& path, const LabelSet& labels, const DenseConfig& dense,
                     const FrameSource& source, const std::vector<TimedPose>& trajectory,
                     const std::vector<LabelledPoint>& cloud) const;

  RunReport report_;
  Sample sample_;
};

}  // namespace semantic_vslam
