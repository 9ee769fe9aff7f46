// SPDX-FileCopyrightText: 2026 The semantic_vslam authors
// SPDX-License-Identifier: BSD-3-Clause
#include "eval/open_recording.h"

#include "eval/scenario_source.h"

namespace semantic_vslam {

TumSequence openTumFolder(const Arguments& arguments) {
  const auto camera = arguments.value("--camera");
  if (!camera) throw UsageError("a folder of images needs --camera FILE (cfg/cameras/*.yaml)");
  return TumSequence(arguments.positional()[0], std::make_shared<CameraModel>(loadCameraFile(*camera)));
}

std::unique_ptr<FrameSource> openRecording(const Arguments& arguments, double default_fps) {
  const auto name = arguments.value("--scenario");
  if (name.has_value() != arguments.positional().empty()) {
    throw UsageError("give either a TUM folder or --scenario NAME");
  }
  if (!name) return std::make_unique<TumSequence>(openTumFolder(arguments));
  Scenario scenario = makeScenario(*name, arguments.count("--seed", 1));
  scenario.fps = arguments.positiveNumber("--fps", default_fps);
  return std::make_unique<ScenarioSource>(scenario, syntheticCamera(arguments.value("--size").value_or("640x480")));
}

}  // namespace semantic_vslam
