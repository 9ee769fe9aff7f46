// SPDX-FileCopyrightText: 2026 The semantic_vslam authors
// SPDX-License-Identifier: BSD-3-Clause
#include "core/segmentation/onnx_segmenter.h"

#include <onnxruntime_cxx_api.h>

#include <algorithm>
#include <cmath>
#include <string>
#include <utility>
#include <vector>

#include "core/segmentation/label_upsampling.h"
#include "core/segmentation/model_sidecar.h"
#include "core/segmentation/network_input.h"
#include "semantic_vslam/core/common/config_fields.h"
#include "semantic_vslam/core/common/error.h"
#include "semantic_vslam/core/common/log.h"

namespace semantic_vslam {
namespace {

using Shape = std::vector<std::int64_t>;

std::string shapeText(const Shape& shape) {
  std::string text;
  for (const std::int64_t side : shape) text += (text.empty() ? "" : "x") + (side < 0 ? "?" : std::to_string(side));
  return text;
}

/// Whether a network's shape, in which a free side is negative, allows the wanted one.
bool fits(const Shape& shape, const Shape& wanted) {
  bool same = shape.size() == wanted.size();
  for (std::size_t i = 0; same && i < shape.size(); ++i) same = shape[i] < 0 || shape[i] == wanted[i];
  return same;
}

/// An error message of the runtime, on one line.
std::string reason(const Ort::Exception& error) {
  std::string text = error.what();
  std::replace(text.begin(), text.end(), '\n', ' ');
  return text;
}

const char* typeName(ONNXTensorElementDataType type) {
  switch (type) {
    case ONNX_TENSOR_ELEMENT_DATA_TYPE_FLOAT: return "float32";
    case ONNX_TENSOR_ELEMENT_DATA_TYPE_UINT8: return "uint8";
    case ONNX_TENSOR_ELEMENT_DATA_TYPE_INT8: return "int8";
    case ONNX_TENSOR_ELEMENT_DATA_TYPE_INT32: return "int32";
    case ONNX_TENSOR_ELEMENT_DATA_TYPE_INT64: return "int64";
    case ONNX_TENSOR_ELEMENT_DATA_TYPE_FLOAT16: return "float16";
    default: return "another type";
  }
}

bool isLabelType(ONNXTensorElementDataType type) {
  return type == ONNX_TENSOR_ELEMENT_DATA_TYPE_UINT8 || type == ONNX_TENSOR_ELEMENT_DATA_TYPE_INT32 ||
         type == ONNX_TENSOR_ELEMENT_DATA_TYPE_INT64;
}

/// One for the process: ONNX Runtime keeps its logger and its arenas there.
Ort::Env& environment() {
  static Ort::Env env(ORT_LOGGING_LEVEL_ERROR, "semantic_vslam");
  return env;
}

bool tryProvider(Ort::SessionOptions& options, const std::string& name) {
  const std::vector<std::string> available = Ort::GetAvailableProviders();
  const std::string full = name == "cuda" ? "CUDAExecutionProvider" : "TensorrtExecutionProvider";
  if (std::find(available.begin(), available.end(), full) == available.end()) return false;
  try {
    if (name == "cuda") {
      options.AppendExecutionProvider_CUDA(OrtCUDAProviderOptions{});
    } else {
      options.AppendExecutionProvider_TensorRT(OrtTensorRTProviderOptions{});
    }
    return true;
  } catch (const Ort::Exception& error) {  // the library has the provider, the machine lacks driver or GPU
    logWarning("segmentation: " + full + " cannot be used (" + reason(error) + ")");
    return false;
  }
}

void chooseProvider(Ort::SessionOptions& options, const std::string& wanted) {
  if (wanted == "cpu") return;
  const std::vector<std::string> order =
      wanted == "auto" ? std::vector<std::string>{"tensorrt", "cuda"} : std::vector<std::string>{wanted};
  for (const auto& name : order) {
    if (tryProvider(options, name)) {
      logInfo("segmentation runs on " + name);
      return;
    }
  }
  if (wanted != "auto") logWarning("segmentation.provider '" + wanted + "' is not available here; the CPU is used");
}

/// @param integer  compute quantised layers in integers; false: in float, with the same weights
Ort::SessionOptions sessionOptions(const SegmentationConfig& config, bool integer) {
  Ort::SessionOptions options;
  options.SetIntraOpNumThreads(config.threads);
  options.SetInterOpNumThreads(1);
  options.SetExecutionMode(ORT_SEQUENTIAL);
  options.SetGraphOptimizationLevel(ORT_ENABLE_ALL);
  options.AddConfigEntry("session.intra_op.allow_spinning", "0");  // a waiting thread must not take tracking's core
  options.AddConfigEntry("session.use_env_allocators", "1");
  if (!integer) options.AddConfigEntry("session.disable_quant_qdq", "1");
  chooseProvider(options, config.provider);
  return options;
}

/// Bounds the arena that every session of the process shares. The first network's bound holds.
void registerArena(int arena_mb) {
  static const bool done = [arena_mb] {
    constexpr int kExtendAsRequested = 1;
    const Ort::MemoryInfo cpu = Ort::MemoryInfo::CreateCpu(OrtArenaAllocator, OrtMemTypeDefault);
    const Ort::ArenaCfg arena(static_cast<std::size_t>(arena_mb) << 20, kExtendAsRequested, -1, -1);
    environment().CreateAndRegisterAllocator(cpu, arena);
    return true;
  }();
  static_cast<void>(done);
}

class OnnxSegmenter final : public Segmenter {
 public:
  OnnxSegmenter(const SegmentationConfig& config, ModelSidecar sidecar);

  const LabelSet& labels() const override { return sidecar_.labels; }
  Segmentation segment(const cv::Mat3b& bgr) override;

 private:
  void openSession(const SegmentationConfig& config);
  void checkInput();
  void checkOutput();
  std::size_t findOutput();
  Shape expectedOutput(std::size_t rank) const;
  void bindTensors();
  cv::Mat1b networkLabels() const;
  template <class Element>
  cv::Mat1b mapLabels() const;
  LogitGrid logits() const;
  cv::Size outputSize() const;
  [[noreturn]] void misfit(const std::string& what) const;

  const std::string model_;
  const float weak_person_;
  const ModelSidecar sidecar_;
  NetworkInput input_;
  Ort::Session session_{nullptr};
  std::string input_name_, output_name_;
  ONNXTensorElementDataType output_type_ = ONNX_TENSOR_ELEMENT_DATA_TYPE_UNDEFINED;
  Shape output_shape_;
  Ort::Value input_tensor_{nullptr}, output_tensor_{nullptr};
  Ort::IoBinding binding_{nullptr};
};

OnnxSegmenter::OnnxSegmenter(const SegmentationConfig& config, ModelSidecar sidecar)
    : model_(config.model),
      weak_person_(static_cast<float>(config.weak_person)),
      sidecar_(std::move(sidecar)),
      input_(sidecar_.input) {
  openSession(config);
  checkInput();
  checkOutput();
  bindTensors();
  segment(cv::Mat3b(sidecar_.input.size, cv::Vec3b(114, 114, 114)));  // the first run allocates and is slow
}

void OnnxSegmenter::misfit(const std::string& what) const {
  throw ModelError("network '" + model_ + "' " + what + " (sidecar '" + sidecar_.path + "')");
}

void OnnxSegmenter::openSession(const SegmentationConfig& config) {
  try {
    registerArena(config.arena_mb);
    try {
      session_ = Ort::Session(environment(), model_.c_str(), sessionOptions(config, true));
    } catch (const Ort::Exception&) {
      // ONNX Runtime 1.21 and 1.22 break some valid quantised networks while they fuse their layers ("two nodes with
      // same node name"). Computed in float they are right, and slower.
      session_ = Ort::Session(environment(), model_.c_str(), sessionOptions(config, false));
      logInfo("segmentation: this ONNX Runtime cannot fuse the quantised layers of '" + model_ +
              "'; computing in float");
    }
  } catch (const Ort::Exception& error) {
    throw ModelError("network '" + model_ + "' cannot be loaded: " + reason(error) + "; fetch or export it again");
  }
}

void OnnxSegmenter::checkInput() {
  if (session_.GetInputCount() != 1) {
    misfit("has " + std::to_string(session_.GetInputCount()) + " inputs, must have one, the image");
  }
  input_name_ = session_.GetInputNameAllocated(0, Ort::AllocatorWithDefaultOptions()).get();
  const Ort::TypeInfo type = session_.GetInputTypeInfo(0);
  const auto info = type.GetTensorTypeAndShapeInfo();
  const auto wanted = sidecar_.input.type == TensorType::kUint8 ? ONNX_TENSOR_ELEMENT_DATA_TYPE_UINT8
                                                                : ONNX_TENSOR_ELEMENT_DATA_TYPE_FLOAT;
  if (info.GetElementType() != wanted) {
    misfit(std::string("takes ") + typeName(info.GetElementType()) + " but the sidecar's input.type says " +
           typeName(wanted));
  }
  if (!fits(info.GetShape(), input_.shape())) {
    misfit("takes an input of " + shapeText(info.GetShape()) + " but the sidecar's input says " +
           shapeText(input_.shape()));
  }
}

std::size_t OnnxSegmenter::findOutput() {
  std::string names;
  for (std::size_t i = 0; i < session_.GetOutputCount(); ++i) {
    output_name_ = session_.GetOutputNameAllocated(i, Ort::AllocatorWithDefaultOptions()).get();
    if (sidecar_.output.name.empty() || sidecar_.output.name == output_name_) return i;
    names += (names.empty() ? "" : ", ") + output_name_;
  }
  misfit("has no output '" + sidecar_.output.name + "', it has " + names);
}

void OnnxSegmenter::checkOutput() {
  const Ort::TypeInfo type = session_.GetOutputTypeInfo(findOutput());
  const auto info = type.GetTensorTypeAndShapeInfo();
  output_type_ = info.GetElementType();
  const bool logits = sidecar_.output.kind == OutputKind::kLogits;
  if (logits ? output_type_ != ONNX_TENSOR_ELEMENT_DATA_TYPE_FLOAT : !isLabelType(output_type_)) {
    misfit(std::string("gives ") + typeName(output_type_) + " but the sidecar's output.kind wants " +
           (logits ? "float32 logits" : "uint8, int32 or int64 labels"));
  }
  const Shape shape = info.GetShape();
  output_shape_ = expectedOutput(shape.size());
  const std::size_t class_axis = sidecar_.output.layout == TensorLayout::kNchw ? 1 : 3;
  if (logits && shape.size() == 4 && shape[class_axis] >= 0 && shape[class_axis] != output_shape_[class_axis]) {
    misfit("gives " + std::to_string(shape[class_axis]) + " classes but the sidecar lists " +
           std::to_string(output_shape_[class_axis]));
  }
  if (!fits(shape, output_shape_)) {
    misfit("gives an output of " + shapeText(shape) + " but the sidecar's input size, output and classes make " +
           shapeText(output_shape_));
  }
}

/// The output shape that the sidecar says. Labels come as 1xHxW or 1x1xHxW.
Shape OnnxSegmenter::expectedOutput(std::size_t rank) const {
  const std::int64_t height = outputSize().height, width = outputSize().width;
  const auto classes = static_cast<std::int64_t>(sidecar_.network_classes.size());
  if (sidecar_.output.kind == OutputKind::kLabels)
    return rank == 4 ? Shape{1, 1, height, width} : Shape{1, height, width};
  return sidecar_.output.layout == TensorLayout::kNchw ? Shape{1, classes, height, width}
                                                       : Shape{1, height, width, classes};
}

cv::Size OnnxSegmenter::outputSize() const {
  const int stride = sidecar_.output.stride;
  return {(sidecar_.input.size.width + stride - 1) / stride, (sidecar_.input.size.height + stride - 1) / stride};
}

/// Both tensors are bound once and for good: the network reads and writes our memory in place.
void OnnxSegmenter::bindTensors() {
  const auto memory = Ort::MemoryInfo::CreateCpu(OrtDeviceAllocator, OrtMemTypeDefault);
  const Shape& shape = input_.shape();
  input_tensor_ =
      sidecar_.input.type == TensorType::kUint8
          ? Ort::Value::CreateTensor(memory, input_.bytes(), input_.elements(), shape.data(), shape.size())
          : Ort::Value::CreateTensor(memory, input_.floats(), input_.elements(), shape.data(), shape.size());
  Ort::AllocatorWithDefaultOptions allocator;
  output_tensor_ = Ort::Value::CreateTensor(allocator, output_shape_.data(), output_shape_.size(), output_type_);
  binding_ = Ort::IoBinding(session_);
  binding_.BindInput(input_name_.c_str(), input_tensor_);
  binding_.BindOutput(output_name_.c_str(), output_tensor_);
}

Segmentation OnnxSegmenter::segment(const cv::Mat3b& bgr) {
  const cv::Size content = input_.fill(bgr);
  try {
    session_.Run(Ort::RunOptions{nullptr}, binding_);
    binding_.SynchronizeOutputs();
  } catch (const Ort::Exception& error) {
    misfit("fails: " + reason(error));
  }
  const double stride = sidecar_.output.stride;
  const cv::Rect2d region(0.0, 0.0, content.width / stride, content.height / stride);
  if (sidecar_.output.kind == OutputKind::kLabels) return {upsampleLabels(networkLabels(), region, bgr.size())};
  const std::vector<std::uint8_t>& lut = sidecar_.label_of_class;
  const LogitGrid scores = logits();
  const float* end = scores.data + static_cast<std::size_t>(scores.size.area()) * scores.classes;
  if (!std::all_of(scores.data, end, [](float score) { return std::isfinite(score); })) {
    misfit("gives scores that are not finite: wrong weights, or wrong scale, mean or std");
  }
  Segmentation result{upsampleBestLabels(scores, region, bgr.size(), lut)};
  const std::uint8_t person = sidecar_.labels.person();
  if (person > 0 && weak_person_ < 1.0F) {
    result.weak_people = upsampleLikely(scores, region, bgr.size(), lut, person, weak_person_);
  }
  return result;
}

LogitGrid OnnxSegmenter::logits() const {
  LogitGrid grid;
  grid.data = output_tensor_.GetTensorData<float>();
  grid.classes = static_cast<int>(sidecar_.network_classes.size());
  grid.size = outputSize();
  const bool nchw = sidecar_.output.layout == TensorLayout::kNchw;
  grid.class_step = nchw ? grid.size.area() : 1;
  grid.cell_step = nchw ? 1 : grid.classes;
  return grid;
}

cv::Mat1b OnnxSegmenter::networkLabels() const {
  switch (output_type_) {
    case ONNX_TENSOR_ELEMENT_DATA_TYPE_UINT8: return mapLabels<std::uint8_t>();
    case ONNX_TENSOR_ELEMENT_DATA_TYPE_INT32: return mapLabels<std::int32_t>();
    default: return mapLabels<std::int64_t>();
  }
}

template <class Element>
cv::Mat1b OnnxSegmenter::mapLabels() const {
  cv::Mat1b labels(outputSize());
  const Element* classes = output_tensor_.GetTensorData<Element>();
  const auto count = static_cast<std::int64_t>(sidecar_.label_of_class.size());
  for (std::uint8_t& label : labels) {
    const std::int64_t k = *classes++;
    if (k < 0 || k >= count) {
      misfit("gives class " + std::to_string(k) + " but the sidecar lists " + std::to_string(count) + " classes");
    }
    label = sidecar_.label_of_class[k];
  }
  return labels;
}

}  // namespace

bool canRunNetworks() { return true; }

std::unique_ptr<Segmenter> makeOnnxSegmenter(const SegmentationConfig& config) {
  validateConfig(config);
  SegmentationConfig found = config;
  found.model = findModel(config.model);
  found.sidecar = findModelSidecar(found.model, config.sidecar);
  return std::make_unique<OnnxSegmenter>(found, loadModelSidecar(found.sidecar));
}

}  // namespace semantic_vslam
