// SPDX-FileCopyrightText: 2026 The semantic_vslam authors
// SPDX-License-Identifier: BSD-3-Clause
#include "core/segmentation/model_sidecar.h"

#include <dlfcn.h>
#include <yaml-cpp/yaml.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <map>
#include <set>

#include "core/common/input_file.h"
#include "semantic_vslam/core/common/error.h"

namespace semantic_vslam {
namespace {

namespace fs = std::filesystem;

constexpr int kMaxInputSidePx = 4096;
constexpr std::size_t kMaxLabels = 255;  // labels are 8-bit

/// A YAML map whose every key must be asked for: what is left over at the end is a mistake of the writer.
class StrictMap {
 public:
  StrictMap(const YAML::Node& node, std::string file, std::string prefix)
      : node_(node), file_(std::move(file)), prefix_(std::move(prefix)) {
    if (!node_ || !node_.IsMap()) fail(prefix_.empty() ? "(root)" : prefix_, "must be a map");
  }

  bool has(const std::string& key) const { return static_cast<bool>(node_[key]); }

  YAML::Node require(const std::string& key) {
    asked_.insert(key);
    const YAML::Node value = node_[key];
    if (!value) fail(full(key), "is missing");
    return value;
  }

  template <class T>
  T get(const std::string& key, const char* wanted) {
    const YAML::Node value = require(key);
    try {
      return value.as<T>();
    } catch (const YAML::Exception&) {
      fail(full(key), std::string("must be ") + wanted);
    }
  }

  template <class T>
  T get(const std::string& key, const char* wanted, const T& absent) {
    asked_.insert(key);
    return has(key) ? get<T>(key, wanted) : absent;
  }

  int wholeNumber(const std::string& key, int low, int high) {
    return inRange(key, get<int>(key, "a whole number"), low, high);
  }

  int wholeNumber(const std::string& key, int low, int high, int absent) {
    return inRange(key, get<int>(key, "a whole number", absent), low, high);
  }

  template <class Enum>
  Enum word(const std::string& key, const std::map<std::string, Enum>& words) {
    const auto text = get<std::string>(key, "a word");
    const auto found = words.find(text);
    if (found != words.end()) return found->second;
    std::string known;
    for (const auto& [name, unused] : words) known += (known.empty() ? "" : ", ") + name;
    fail(full(key), "is '" + text + "', must be one of " + known);
  }

  std::array<double, 3> triple(const std::string& key, const std::array<double, 3>& absent) {
    const auto values = get<std::vector<double>>(key, "a list of three numbers", {absent[0], absent[1], absent[2]});
    if (values.size() != 3) fail(full(key), "must be a list of three numbers");
    for (const double value : values) {
      if (!std::isfinite(value)) fail(full(key), "must hold finite numbers");
    }
    return {values[0], values[1], values[2]};
  }

  void refuseUnknown() const {
    for (const auto& item : node_) {
      const auto key = item.first.as<std::string>();
      if (asked_.count(key) == 0) fail(full(key), "is unknown");
    }
  }

  [[noreturn]] void fail(const std::string& key, const std::string& what) const {
    throw ModelError("model sidecar '" + file_ + "': '" + key + "' " + what + "; models/README.md describes the form");
  }

  std::string full(const std::string& key) const { return prefix_.empty() ? key : prefix_ + "." + key; }

 private:
  int inRange(const std::string& key, int value, int low, int high) const {
    if (value < low || value > high) {
      fail(full(key),
           "is " + std::to_string(value) + ", must be in [" + std::to_string(low) + ", " + std::to_string(high) + "]");
    }
    return value;
  }

  YAML::Node node_;
  std::string file_, prefix_;
  std::set<std::string> asked_;
};

ModelSidecar::Input readInput(StrictMap map) {
  ModelSidecar::Input input;
  input.size.width = map.wholeNumber("width", 8, kMaxInputSidePx);
  input.size.height = map.wholeNumber("height", 8, kMaxInputSidePx);
  input.layout = map.word<TensorLayout>("layout", {{"nchw", TensorLayout::kNchw}, {"nhwc", TensorLayout::kNhwc}});
  input.type = map.word<TensorType>("type", {{"float32", TensorType::kFloat32}, {"uint8", TensorType::kUint8}});
  input.channels = map.word<ChannelOrder>("channels", {{"rgb", ChannelOrder::kRgb}, {"bgr", ChannelOrder::kBgr}});
  input.resize =
      map.word<ResizeMode>("resize", {{"stretch", ResizeMode::kStretch}, {"letterbox", ResizeMode::kLetterbox}});
  input.scale = map.get<double>("scale", "a number", input.scale);
  input.mean = map.triple("mean", input.mean);
  input.std = map.triple("std", input.std);
  input.pad_value = map.wholeNumber("pad_value", 0, 255, input.pad_value);
  for (const double value : input.std) {
    if (value <= 0.0) map.fail(map.full("std"), "must hold numbers above 0");
  }
  if (input.type == TensorType::kUint8 && (map.has("scale") || map.has("mean") || map.has("std"))) {
    map.fail(map.full("type"), "is uint8, which takes no scale, mean or std");
  }
  map.refuseUnknown();
  return input;
}

ModelSidecar::Output readOutput(StrictMap map) {
  ModelSidecar::Output output;
  output.name = map.get<std::string>("name", "the name of a tensor", "");
  output.kind = map.word<OutputKind>("kind", {{"logits", OutputKind::kLogits}, {"labels", OutputKind::kLabels}});
  if (output.kind == OutputKind::kLogits) {
    output.layout = map.word<TensorLayout>("layout", {{"nchw", TensorLayout::kNchw}, {"nhwc", TensorLayout::kNhwc}});
  }
  output.stride = map.wholeNumber("stride", 1, 64);
  map.refuseUnknown();
  return output;
}

cv::Vec3b readColour(StrictMap& map) {
  const std::array<double, 3> rgb = map.triple("color", {128.0, 128.0, 128.0});
  for (const double value : rgb) {
    if (value < 0.0 || value > 255.0) map.fail(map.full("color"), "must hold red, green, blue in [0, 255]");
  }
  return {cv::saturate_cast<uchar>(rgb[2]), cv::saturate_cast<uchar>(rgb[1]), cv::saturate_cast<uchar>(rgb[0])};
}

/// One entry of `labels`: adds the label and sends the network classes it is made from to it.
void readLabel(StrictMap map, ModelSidecar& sidecar) {
  LabelClass label;
  label.name = map.get<std::string>("name", "a name");
  label.mobility = map.word<Mobility>(
      "mobility", {{"static", Mobility::kStatic}, {"movable", Mobility::kMovable}, {"person", Mobility::kPerson}});
  label.color_bgr = readColour(map);
  const auto from = map.get<std::vector<std::string>>("from", "a list of class names", {label.name});
  map.refuseUnknown();

  for (const auto& known : sidecar.labels.classes) {
    if (known.name == label.name) map.fail(map.full("name"), "'" + label.name + "' is used twice");
  }
  const auto index = static_cast<std::uint8_t>(sidecar.labels.size());
  for (const auto& name : from) {
    bool found = false;
    for (std::size_t i = 0; i < sidecar.network_classes.size(); ++i) {
      if (sidecar.network_classes[i] != name) continue;
      if (sidecar.label_of_class[i] != 0) map.fail(map.full("from"), "takes class '" + name + "' a second time");
      sidecar.label_of_class[i] = index;
      found = true;
    }
    if (!found) map.fail(map.full("from"), "names '" + name + "', which is not in 'classes'");
  }
  sidecar.labels.classes.push_back(label);
}

void readClasses(StrictMap& root, ModelSidecar& sidecar) {
  sidecar.network_classes = root.get<std::vector<std::string>>("classes", "a list of names in the network's order");
  if (sidecar.network_classes.empty()) root.fail("classes", "must not be empty");
  sidecar.label_of_class.assign(sidecar.network_classes.size(), 0);

  const YAML::Node labels = root.require("labels");
  if (!labels.IsSequence() || labels.size() == 0) root.fail("labels", "must be a list of labels");
  if (labels.size() >= kMaxLabels) root.fail("labels", "holds more than 254 labels");
  for (std::size_t i = 0; i < labels.size(); ++i) {
    readLabel(StrictMap(labels[i], sidecar.path, "labels[" + std::to_string(i) + "]"), sidecar);
  }
}

/// The package's share folder in the install space that this code runs from, which may have been copied elsewhere since
/// it was installed: it lies beside a folder lib above the library or program. Empty in a build tree.
fs::path ownShareFolder() {
  std::vector<fs::path> binaries;
  std::error_code error;
  Dl_info module;
  if (dladdr(reinterpret_cast<const void*>(&loadModelSidecar), &module) != 0 && module.dli_fname != nullptr) {
    binaries.push_back(fs::canonical(module.dli_fname, error));
  }
  binaries.push_back(fs::read_symlink("/proc/self/exe", error));
  for (const auto& binary : binaries) {
    for (fs::path folder = binary.parent_path(); folder.has_relative_path(); folder = folder.parent_path()) {
      fs::path share = folder.parent_path() / "share/semantic_vslam";
      if (folder.filename() == "lib" && fs::is_directory(share / "models")) return share;
    }
  }
  return {};
}

/// Where a file of the package may lie: installed with this code, in the sources it was built from, or where a program
/// that links the library statically finds the package's install space.
std::vector<fs::path> placesOf(const fs::path& file) {
  static const fs::path own = ownShareFolder();
  std::vector<fs::path> places = {fs::path(SEMANTIC_VSLAM_SOURCE_DIR) / file,
                                  fs::path(SEMANTIC_VSLAM_SHARE_DIR) / file};
  if (!own.empty()) places.insert(places.begin(), own / file);
  return places;
}

struct Search {
  std::string found;   ///< empty: none of the places has the file
  std::string places;  ///< for the error
};

/// @param first     is looked for before the package's file
Search searchFile(const fs::path& first, const fs::path& packages_file) {
  std::vector<fs::path> places = placesOf(packages_file);
  places.insert(places.begin(), first);
  Search search;
  for (const auto& place : places) {
    if (fs::is_regular_file(place)) {
      search.found = place.string();
      return search;
    }
    search.places += (search.places.empty() ? "'" : ", '") + place.string() + "'";
  }
  return search;
}

}  // namespace

ModelSidecar loadModelSidecar(const std::string& path) {
  ModelSidecar sidecar;
  sidecar.path = path;
  YAML::Node node;
  try {
    node = readYamlFile("model sidecar", path);
  } catch (const FileError& error) {
    throw ModelError(error.what());
  }
  StrictMap root(node, path, "");
  root.get<std::string>("name", "a text", "");
  root.get<std::string>("license", "a text", "");
  sidecar.input = readInput(StrictMap(root.require("input"), path, "input"));
  sidecar.output = readOutput(StrictMap(root.require("output"), path, "output"));
  readClasses(root, sidecar);
  root.refuseUnknown();
  return sidecar;
}

std::string findModel(const std::string& model) {
  const Search search = searchFile(model, "models" / fs::path(model));
  if (!search.found.empty()) return search.found;
  throw ModelError("network '" + model + "' is no file; looked for " + search.places +
                   "; set segmentation.model, or leave it empty to run without");
}

std::string findModelSidecar(const std::string& model, const std::string& sidecar) {
  if (!sidecar.empty()) {
    if (fs::is_regular_file(sidecar)) return sidecar;
    throw ModelError("segmentation.sidecar '" + sidecar + "' is no file");
  }
  const fs::path beside = fs::path(model).replace_extension(".yaml");
  const Search search = searchFile(beside, "models/sidecars" / beside.filename());
  if (!search.found.empty()) return search.found;
  throw ModelError("network '" + model + "' has no sidecar; looked for " + search.places +
                   "; write one (models/README.md) or set segmentation.sidecar");
}

}  // namespace semantic_vslam
