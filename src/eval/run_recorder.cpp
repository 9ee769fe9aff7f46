// SPDX-FileCopyrightText: 2026 The semantic_vslam authors
// SPDX-License-Identifier: BSD-3-Clause
#include "eval/run_recorder.h"

#include <algorithm>
#include <array>
#include <cstdint>
#include <filesystem>
#include <map>
#include <vector>

#include "core/common/atomic_file.h"
#include "core/dense/cloud_file.h"
#include "core/dense/dense_mapper.h"
#include "core/io/image_file.h"
#include "core/io/trajectory.h"
#include "core/pipeline/sparse_slam.h"
#include "eval/overview_picture.h"
#include "semantic_vslam/core/common/error.h"
#include "semantic_vslam/core/common/log.h"

namespace semantic_vslam {
namespace {

namespace fs = std::filesystem;

constexpr const char* kSummary = "summary.json";
constexpr std::array kFiles{"trajectory.txt", "keyframes.txt", "timing.csv",  "cloud.pcd",
                            "map.ot",         "mesh.ply",      "overview.png"};
constexpr std::array kPictureFolders{"masks", "removed"};

// More than this share of moving things in a picture leaves no room to be seen.
constexpr double kMostDynamicSample = 0.5;

std::vector<TimedPose> posesOf(const std::vector<KeyframePose>& keyframes) {
  std::vector<TimedPose> poses;
  for (const KeyframePose& keyframe : keyframes) poses.push_back({keyframe.stamp, keyframe.T_world_camera});
  return poses;
}

void removeFile(const fs::path& path) {
  std::error_code failed;
  fs::remove(path, failed);
  if (failed) throw FileError("'" + path.string() + "' of an earlier run cannot be removed: " + failed.message());
}

/// What a run has written, with sizes in bytes; of a folder of pictures their sum.
std::map<std::string, std::uintmax_t> filesIn(const fs::path& folder) {
  std::map<std::string, std::uintmax_t> bytes;
  for (const char* name : kFiles) {
    if (fs::is_regular_file(folder / name)) bytes[name] = fs::file_size(folder / name);
  }
  for (const char* name : kPictureFolders) {
    if (!fs::is_directory(folder / name)) continue;
    for (const fs::directory_entry& entry : fs::directory_iterator(folder / name)) {
      if (entry.is_regular_file()) bytes[name] += entry.file_size();
    }
  }
  return bytes;
}

/// Compares with the ground truth, where that is possible; says why not otherwise.
void scoreTrajectory(const std::vector<TimedPose>& truth, const std::vector<TimedPose>& trajectory, RunReport& report) {
  if (truth.empty()) {
    logInfo("no ground truth beside the images: no trajectory error");
    return;
  }
  try {
    report.absolute = absoluteTrajectoryError(truth, trajectory);
    report.relative = relativePoseError(truth, trajectory);
  } catch (const Error& error) {
    logWarning(std::string("trajectory error: ") + error.what());
  }
}

}  // namespace

void RunRecorder::add(const RgbdFrame& frame, const StepResult& step, const cv::Mat1b& truth) {
  ++report_.frames;
  ++report_.frames_in_state[stateName(step.tracking.state)];
  const MotionResult& motion = step.motion;
  report_.motion.push_back({frame.index, motionModelName(motion.model), motion.inliers, motion.dynamic_share});
  if (truth.size() == frame.bgr.size()) {
    report_.mask.add(step.removed.empty() ? cv::Mat1b(cv::Mat1b::zeros(truth.size())) : step.removed, truth);
  }
  if (step.posed() && motion.dynamic_share > sample_.dynamic_share && motion.dynamic_share < kMostDynamicSample) {
    sample_ = {motion.dynamic_share, frame.stamp, frame.bgr, step.removed.clone()};
  }
}

void RunRecorder::clearFolder(const std::string& folder) {
  removeFile(folder + "/" + kSummary);  // first: without it the rest passes for no result
  for (const char* name : kFiles) removeFile(folder + "/" + name);
  removeLeftOvers(folder);
  for (const char* name : kPictureFolders) {
    const fs::path pictures = fs::path(folder) / name;
    if (!fs::is_directory(pictures)) continue;
    removeLeftOvers(pictures.string());
    for (const fs::directory_entry& entry : fs::directory_iterator(pictures)) {
      if (entry.path().extension() == ".png" && parseStamp(entry.path().stem().string())) removeFile(entry.path());
    }
  }
}

void RunRecorder::writePoses(const std::string& folder, const SparseSlam& slam) {
  writeTumTrajectory(folder + "/trajectory.txt", slam.trajectory());
  writeTumTrajectory(folder + "/keyframes.txt", posesOf(slam.keyframePoses()));
}

void RunRecorder::writeResults(const std::string& folder, const Results& results, const DenseConfig& dense,
                               const FrameSource& source, bool at_end) {
  removeFile(folder + "/" + kSummary);
  const std::vector<TimedPose> trajectory = results.slam.trajectory();
  writePoses(folder, results.slam);
  results.times.writeCsv(folder + "/timing.csv");
  const std::vector<LabelledPoint> cloud = results.dense.cloud();
  if (dense.enabled) {
    writePcd(cloud, results.dense.labels(), folder + "/cloud.pcd");
    results.dense.saveOctomap(folder + "/map.ot");
    results.dense.saveMesh(folder + "/mesh.ply");
  }
  report_.posed = trajectory.size();
  report_.keyframes = results.slam.keyframeCount();
  report_.landmarks = results.slam.landmarkCount();
  report_.cloud_points = cloud.size();
  report_.voxels = results.dense.voxels();
  report_.stages = results.times.summarize();
  scoreTrajectory(source.groundTruth(), trajectory, report_);
  if (at_end) writeOverview(folder + "/overview.png", results.dense.labels(), dense, source, trajectory, cloud);
  report_.peak_memory_mb = peakMemoryMb();
  report_.files = filesIn(folder);
  writeTextAtomically(folder + "/" + kSummary, toJson(report_));
}

void RunRecorder::writeOverview(const std::string& path, const LabelSet& labels, const DenseConfig& dense,
                                const FrameSource& source, const std::vector<TimedPose>& trajectory,
                                const std::vector<LabelledPoint>& cloud) const {
  OverviewContent content;
  content.title = fs::path(report_.sequence).filename().string();
  content.subtitle = headline(report_);
  content.cloud = cloud;
  content.cloud_resolution_m = dense.cloud_resolution_m;
  content.labels = labels;
  content.trajectory = trajectory;
  content.truth = source.groundTruth();
  content.absolute = report_.absolute;
  content.camera = source.camera();
  const auto pose =
      std::find_if(trajectory.begin(), trajectory.end(), [&](const TimedPose& p) { return p.stamp == sample_.stamp; });
  if (pose != trajectory.end() && !sample_.bgr.empty()) {
    content.sample_bgr = sample_.bgr;
    content.sample_dynamic = sample_.dynamic;
    content.sample_T_world_camera = pose->T_world_camera;
  }
  writeImageFile(path, drawOverview(content));
}

}  // namespace semantic_vslam
