// SPDX-FileCopyrightText: 2026 The semantic_vslam authors
// SPDX-License-Identifier: BSD-3-Clause
//
// Converts a folder in the format of the TUM RGB-D benchmark to a bag like the benchmark's own.
#include <algorithm>
#include <cstdio>
#include <opencv2/imgcodecs.hpp>
#include <string>

#include "core/common/arguments.h"
#include "core/common/progress.h"
#include "core/io/image_file.h"
#include "core/io/tum_sequence.h"
#include "ros/recording_bag.h"
#include "semantic_vslam/core/common/error.h"
#include "semantic_vslam/core/common/log.h"

namespace {

using namespace semantic_vslam;

constexpr const char* kUsage =
    "usage: tum_to_bag SEQUENCE_DIR OUT.bag [options]\n"
    "Writes the paired images of a TUM RGB-D folder with the topics, encodings and frames of the benchmark's own "
    "bags:\n"
    "/camera/rgb/image_color rgb8, /camera/depth/image 32FC1 in metres, camera_info for both, ground truth on /tf.\n"
    "  --camera FILE   cfg/cameras/*.yaml for camera_info; without it the driver's default of 525 px, as in TUM's "
    "bags\n"
    "  --no-tf         leave the ground truth out\n"
    "  --mask          also write mask/ to /groundtruth/mask (mono8, 255 = moving)\n"
    "  --lz4           compress\n"
    "  --start N       first pair to write, from 0\n"
    "  --frames N      pairs to write at most\n";

/// What the Kinect driver says of an uncalibrated camera of this size.
CameraIntrinsics driverDefault(const std::string& folder) {
  const cv::Mat image = readImageFile(folder + "/" + readTumPairs(folder).front().rgb_file, cv::IMREAD_COLOR);
  CameraIntrinsics k;
  const double scale = image.cols / 640.0;
  k.width = image.cols;
  k.height = image.rows;
  k.fx = k.fy = 525.0 * scale;
  k.cx = (image.cols - 1) / 2.0;
  k.cy = (image.rows - 1) / 2.0;
  return k;
}

struct Options {
  bool tf, mask, lz4;
  std::size_t start, frames;
};

/// Writes the true poses up to a time and remembers where it stopped.
class PoseWriter {
 public:
  PoseWriter(RecordingBag& bag, const std::vector<TimedPose>& poses, bool enabled)
      : bag_(bag), poses_(poses), next_(enabled ? 0 : poses.size()) {}

  void writeUpTo(Stamp stamp) {
    for (; next_ < poses_.size() && poses_[next_].stamp <= stamp; ++next_) {
      bag_.writeTruePose(poses_[next_].stamp, poses_[next_].T_world_camera);
    }
  }
  void skipBefore(Stamp stamp) {
    while (next_ < poses_.size() && poses_[next_].stamp < stamp) ++next_;
  }

 private:
  RecordingBag& bag_;
  const std::vector<TimedPose>& poses_;
  std::size_t next_;
};

void convert(TumSequence& sequence, const std::string& path, const Options& options) {
  // Poses just outside the images let a reader interpolate at the first and the last one.
  constexpr std::int64_t kPoseMarginNs = 200'000'000;
  RecordingBag bag(path, sequence.camera()->intrinsics(),
                   options.lz4 ? rosbag::compression::LZ4 : rosbag::compression::Uncompressed);
  PoseWriter poses(bag, sequence.groundTruth(), options.tf);
  sequence.skip(options.start);
  std::size_t written = 0, masks = 0;
  Stamp last;
  Progress progress(std::min(options.frames, sequence.size()), "frames");
  while (written < options.frames) {
    const std::optional<RgbdFrame> frame = sequence.next();
    if (!frame) break;
    if (written == 0) poses.skipBefore(Stamp{frame->stamp.ns - kPoseMarginNs});
    poses.writeUpTo(frame->stamp);
    bag.writeColour(frame->stamp, frame->bgr);
    bag.writeDepth(sequence.pairs()[frame->index].depth_stamp, frame->depth_m);
    const cv::Mat1b mask = options.mask ? sequence.groundTruthMask() : cv::Mat1b();
    if (!mask.empty()) {
      bag.writeMask(frame->stamp, mask);
      ++masks;
    }
    last = frame->stamp;
    progress.show(++written);
  }
  progress.end();
  if (written == 0) throw FileError("nothing to write: no frame from " + std::to_string(options.start) + " on");
  poses.writeUpTo(Stamp{last.ns + kPoseMarginNs});
  bag.close();
  std::fprintf(stderr, "%zu frames, %zu masks, %zu left out\n", written, masks, sequence.skippedBroken());
  if (options.mask && masks == 0) logWarning("the sequence has no mask/ beside its images");
}

int run(const Arguments& arguments) {
  const std::string folder = arguments.positional()[0], out = arguments.positional()[1];
  const auto camera_file = arguments.value("--camera");
  if (!camera_file) logWarning("no --camera: camera_info gets the driver's default of an uncalibrated camera");
  const CameraIntrinsics intrinsics = camera_file ? loadCameraFile(*camera_file) : driverDefault(folder);
  TumSequence sequence(folder, std::make_shared<CameraModel>(intrinsics));
  const Options options{!arguments.has("--no-tf"), arguments.has("--mask"), arguments.has("--lz4"),
                        arguments.count("--start", 0), arguments.count("--frames", sequence.size())};
  if (options.tf && sequence.groundTruth().empty()) logWarning("no groundtruth.txt: /tf is left out");
  convert(sequence, out, options);
  std::printf("%s\n", out.c_str());
  return 0;
}

}  // namespace

int main(int argc, char** argv) {
  return runTool(argc, argv, kUsage, [&] {
    return run(Arguments(argc, argv, {"--camera", "--start", "--frames"}, {"--no-tf", "--mask", "--lz4"}, {2, 2}));
  });
}
