// SPDX-FileCopyrightText: 2026 The semantic_vslam authors
// SPDX-License-Identifier: BSD-3-Clause
//
// Gives damaged files of every kind that the package reads to the code that reads them. Each must end in one Error or
// be read; a crash, a report of a sanitizer, another exception, more than kPatienceS or kMostMemoryMb is a finding, and
// the file that did it is kept. Inputs follow from the seed.
#include <sys/mman.h>
#include <sys/resource.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <chrono>
#include <csignal>
#include <cstdio>
#include <cstring>
#include <exception>
#include <filesystem>
#include <fstream>
#include <functional>
#include <memory>
#include <opencv2/core.hpp>
#include <opencv2/imgcodecs.hpp>
#include <optional>
#include <sstream>
#include <string>
#include <vector>

#include "core/common/arguments.h"
#include "core/common/binary_file.h"
#include "core/dense/dense_map_file.h"
#include "core/dense/dense_mapper.h"
#include "core/io/image_file.h"
#include "core/io/trajectory.h"
#include "core/io/tum_sequence.h"
#include "core/map/map_file.h"
#include "core/pipeline/sparse_slam.h"
#include "core/segmentation/model_sidecar.h"
#include "eval/scenario_source.h"
#include "fuzz/mutator.h"
#include "ros/bag_source.h"
#include "ros/recording_bag.h"
#include "semantic_vslam/core/common/config_fields.h"
#include "semantic_vslam/core/common/error.h"
#include "semantic_vslam/core/pipeline/config.h"
#include "semantic_vslam/core/pipeline/pipeline.h"

namespace semantic_vslam {
namespace {

namespace fs = std::filesystem;

constexpr const char* kUsage =
    "usage: fuzz [options]\n"
    "Gives damaged files of every kind to the code that reads them; what breaks it is kept.\n"
    "  --minutes M     (1) over all formats\n"
    "  --format NAME   one of them: map dense config camera sidecar list trajectory image bag\n"
    "  --seed N        (1)\n"
    "  --out DIR       (out/fuzz) for the files that broke something\n"
    "  --replay FILE   reads one such file with --format, and nothing else\n";

constexpr int kPatienceS = 20;
constexpr std::uint64_t kBatch = 250;  // inputs a child process

struct Format {
  std::string name;
  std::string ending;
  bool checksum = false;  ///< the payload is damaged, and a right checksum written before it
  std::vector<std::string> seeds;
  std::function<void(const std::string& path)> read;
};

std::string contentOf(const fs::path& path) {
  std::ifstream file(path, std::ios::binary);
  std::ostringstream content;
  content << file.rdbuf();
  return content.str();
}

void write(const fs::path& path, const std::string& content) {
  std::ofstream(path, std::ios::binary | std::ios::trunc) << content;
}

// ---- good files, from the package's own writers

/// Writes what a short run of the system leaves: map.slam, map.dense, test.bag.
void recordSeeds(const fs::path& folder) {
  const CameraIntrinsics camera = syntheticCamera("160x120");
  ScenarioSource source(makeScenario("walking", 1, 1.0), camera);
  SystemConfig config;
  config.segmentation.model.clear();
  Pipeline system(config);
  DenseMapContent dense;
  RecordingBag bag((folder / "seed.bag").string(), camera, rosbag::compression::LZ4);
  DenseMapper mapper(config.dense, syntheticLabels());
  std::uint64_t keyframe = 0;
  while (std::optional<RgbdFrame> frame = source.next()) {
    system.step(*frame);
    if (frame->index % 15 != 0) continue;  // small files are read often
    mapper.add(KeyframeId(keyframe++), *frame, source.rendered().labels, source.rendered().person_mask,
               source.rendered().T_world_camera);
    bag.writeColour(frame->stamp, frame->bgr);
    bag.writeDepth(frame->stamp, frame->depth_m);
    bag.writeTruePose(frame->stamp, source.rendered().T_world_camera);
  }
  bag.close();
  system.slam().saveMap((folder / "seed.slam").string());
  write(folder / "seed.dense", serializeDenseMap(mapper.content(1)));
}

/// All keys, each group in its own block.
std::string configText() {
  std::string text;
  std::string group;
  std::vector<ConfigEntry> entries = listConfig(SystemConfig());
  std::sort(entries.begin(), entries.end(), [](const auto& a, const auto& b) { return a.key < b.key; });
  for (const ConfigEntry& entry : entries) {
    std::string indent;
    std::size_t begin = 0;
    for (std::size_t dot; (dot = entry.key.find('.', begin)) != std::string::npos; begin = dot + 1) {
      if (group.compare(0, dot + 1, entry.key, 0, dot + 1) != 0)
        text += indent + entry.key.substr(begin, dot - begin) + ":\n";
      indent += "  ";
    }
    group = entry.key.substr(0, begin);
    text += indent + entry.key.substr(begin) + ": " + (entry.value.empty() ? "''" : entry.value) + "\n";
  }
  return text;
}

std::vector<std::string> imageSeeds() {
  cv::Mat3b colour(24, 32);
  cv::randu(colour, 0, 255);
  cv::Mat_<std::uint16_t> depth(24, 32, std::uint16_t{5000});
  std::vector<std::string> seeds;
  const auto add = [&](const std::string& ending, const cv::Mat& image) {
    std::vector<std::uint8_t> bytes;
    cv::imencode(ending, image, bytes);
    seeds.emplace_back(bytes.begin(), bytes.end());
  };
  add(".png", colour);
  add(".png", depth);
  add(".jpg", colour);
  return seeds;
}

// ---- the code that reads

void readMapFile(const std::string& path) {
  const SparseSlam slam((SparseSlamConfig()));
  Map again;
  parseMap(serializeMap(slam.readMap(path).map), path, again);  // what is read can be saved and read again
}

void readDenseFile(const std::string& path) {
  DenseMapContent content = readDenseMap(path);
  DenseConfig config;
  DenseMapper mapper(config, content.labels);
  mapper.restore(std::move(content.keyframes));
  mapper.cloud();
  mapper.projectedMap(SE3::Identity());
  mapper.fullOctree();
}

void readBag(const std::string& path) {
  BagSource bag(path, nullptr);
  while (bag.next()) {
  }
}

/// A list needs the other one beside it.
void readList(const std::string& path) {
  const fs::path folder = fs::path(path).parent_path();
  write(folder / "depth.txt", "1.0 depth/1.png\n1.03 depth/2.png\n2 depth/3.png\n");
  fs::copy_file(path, folder / "rgb.txt", fs::copy_options::overwrite_existing);
  readTumPairs(folder.string());
}

std::vector<Format> formats(const fs::path& work) {
  recordSeeds(work);
  const std::string camera =
      "width: 160\nheight: 120\nfx: 131.25\nfy: 131.25\ncx: 79.5\ncy: 59.5\ndistortion: [0, 0.1, 0, 0, 0]\n";
  std::vector<std::string> sidecars;
  for (const auto& entry : fs::directory_iterator("models/sidecars")) {
    if (entry.path().extension() == ".yaml") sidecars.push_back(contentOf(entry.path()));
  }
  if (sidecars.empty()) throw UsageError("run it in the package's folder, where models/sidecars is");
  const std::string trajectory =
      "# stamp tx ty tz qx qy qz qw\n1.5 0 0.1 2 0 0 0 1\n1.6 0,0,0,0,0,0.7071,0.7071\n3e2 1 1 1 0.5 0.5 0.5 0.5\n";
  return {{"map", ".slam", true, {contentOf(work / "seed.slam")}, readMapFile},
          {"dense", ".dense", true, {contentOf(work / "seed.dense")}, readDenseFile},
          {"config",
           ".yaml",
           false,
           {configText()},
           [](const std::string& path) {
             SystemConfig config;
             loadConfigFile(config, path);
           }},
          {"camera", ".yaml", false, {camera}, [](const std::string& path) { CameraModel(loadCameraFile(path)); }},
          {"sidecar", ".yaml", false, sidecars, [](const std::string& path) { loadModelSidecar(path); }},
          {"list", ".txt", false, {"# colour\n1.0 rgb/1.png\n1.033333 rgb/2.png\n1.066 rgb/3.png\n"}, readList},
          {"trajectory", ".txt", false, {trajectory}, [](const std::string& path) { readTumTrajectory(path); }},
          {"image", ".png", false, imageSeeds(),
           [](const std::string& path) { readImageFile(path, cv::IMREAD_UNCHANGED); }},
          {"bag", ".bag", false, {contentOf(work / "seed.bag")}, readBag}};
}

// ---- damaging and reading

std::string withChecksum(const std::string& seed, const std::string& payload) {
  BinaryFormat format{"", 0, ""};
  std::memcpy(format.magic, seed.data(), 8);
  std::memcpy(&format.version, seed.data() + 8, sizeof(format.version));
  BinaryWriter writer;
  writer.putBytes(payload.data(), payload.size());
  return writer.file(format);
}

std::string inputOf(const Format& format, std::uint64_t number) {
  constexpr std::size_t kHeaderBytes = 24;
  Mutator mutator(number);
  const std::string& seed = format.seeds[mutator.rng().below(format.seeds.size())];
  const bool payload_only = format.checksum && mutator.rng().below(10) != 0;
  if (!payload_only) return mutator.damaged(seed, format.seeds);
  return withChecksum(seed, mutator.damaged(seed.substr(kHeaderBytes), format.seeds));
}

/// @return 0, or 1 if it ended as no reader may
int readOne(const Format& format, const std::string& path) {
  alarm(kPatienceS);
  try {
    format.read(path);
  } catch (const Error&) {
  } catch (const std::exception& error) {
    std::fprintf(stderr, "%s: not an Error: %s\n", path.c_str(), error.what());
    return 1;
  }
  alarm(0);
  return 0;
}

/// A seed that is refused as it is would find little.
void requireGoodSeeds(const Format& format, const fs::path& work) {
  for (const std::string& seed : format.seeds) {
    const std::string path = (work / ("input" + format.ending)).string();
    write(path, seed);
    format.read(path);
  }
}

/// Reads inputs from `first` on in a process of its own.
/// @return the input that broke it, if one did
std::optional<std::uint64_t> runBatch(const Format& format, std::uint64_t first, const std::string& path,
                                      std::uint64_t* at) {
  const pid_t child = fork();
  if (child == 0) {
    for (*at = first; *at < first + kBatch; ++*at) {
      write(path, inputOf(format, *at));
      if (readOne(format, path) != 0) _exit(1);
    }
    _exit(0);
  }
  int status = 0;
  waitpid(child, &status, 0);
  if (WIFEXITED(status) && WEXITSTATUS(status) == 0) return std::nullopt;
  return *at;
}

int fuzz(const Arguments& arguments, std::vector<Format> all, const fs::path& work) {
  for (const Format& format : all) requireGoodSeeds(format, work);
  const fs::path out = arguments.value("--out").value_or("out/fuzz");
  const double minutes = arguments.positiveNumber("--minutes", 1.0);
  const std::uint64_t seed = arguments.count("--seed", 1);
  auto* at = static_cast<std::uint64_t*>(
      mmap(nullptr, sizeof(std::uint64_t), PROT_READ | PROT_WRITE, MAP_SHARED | MAP_ANONYMOUS, -1, 0));
  std::uint64_t inputs = 0, findings = 0;
  for (std::size_t i = 0; i < all.size(); ++i) {
    const Format& format = all[i];
    const auto begin = std::chrono::steady_clock::now();
    const std::chrono::duration<double> share(60.0 * minutes / static_cast<double>(all.size()));
    std::uint64_t next = seed << 32, broken = 0;
    while (std::chrono::steady_clock::now() - begin < share) {
      const std::string path = (work / ("input" + format.ending)).string();
      const std::optional<std::uint64_t> found = runBatch(format, next, path, at);
      if (found) {
        ++broken;
        fs::create_directories(out);
        const fs::path kept = out / (format.name + "-" + std::to_string(*found) + format.ending);
        fs::copy_file(path, kept, fs::copy_options::overwrite_existing);
        std::printf("%s: broken by %s\n", format.name.c_str(), kept.c_str());
        std::fflush(stdout);  // a child would write it again
      }
      inputs += (found ? *found + 1 : next + kBatch) - next;
      next = found ? *found + 1 : next + kBatch;
    }
    std::printf("%-10s %8llu inputs, %llu broke it\n", format.name.c_str(),
                static_cast<unsigned long long>(next - (seed << 32)), static_cast<unsigned long long>(broken));
    std::fflush(stdout);
    findings += broken;
  }
  std::printf("%llu inputs, %llu findings\n", static_cast<unsigned long long>(inputs),
              static_cast<unsigned long long>(findings));
  return findings == 0 ? 0 : 1;
}

/// A folder that goes when it goes out of scope.
class Scratch {
 public:
  Scratch() : path_(fs::temp_directory_path() / ("semantic_vslam_fuzz-" + std::to_string(getpid()))) {
    fs::create_directories(path_);
  }
  ~Scratch() {
    std::error_code error;
    fs::remove_all(path_, error);
  }
  const fs::path& path() const { return path_; }

 private:
  fs::path path_;
};

int run(const Arguments& arguments) {
  cv::setNumThreads(1);  // a child of a fork has no threads of a pool
  const Scratch scratch;
  std::vector<Format> all = formats(scratch.path());
  if (const auto name = arguments.value("--format")) {
    all.erase(std::remove_if(all.begin(), all.end(), [&](const Format& f) { return f.name != *name; }), all.end());
    if (all.empty()) throw UsageError("--format " + *name + " is none of those that --help lists");
  }
  if (const auto file = arguments.value("--replay")) {
    if (all.size() != 1) throw UsageError("--replay needs --format");
    const fs::path copy = scratch.path() / ("input" + all[0].ending);
    fs::copy_file(*file, copy);
    return readOne(all[0], copy.string());
  }
  return fuzz(arguments, std::move(all), scratch.path());
}

}  // namespace
}  // namespace semantic_vslam

int main(int argc, char** argv) {
  using namespace semantic_vslam;
  return runTool(argc, argv, kUsage, [&] {
    return run(Arguments(argc, argv, {"--minutes", "--format", "--seed", "--out", "--replay"}, {}, {0, 0}));
  });
}
