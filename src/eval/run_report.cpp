// SPDX-FileCopyrightText: 2026 The semantic_vslam authors
// SPDX-License-Identifier: BSD-3-Clause
#include "eval/run_report.h"

#include <time.h>
#include <unistd.h>

#include <algorithm>
#include <cstdio>
#include <fstream>
#include <numeric>
#include <sstream>
#include <string>

#include "core/io/json_writer.h"

namespace semantic_vslam {
namespace {

void write(JsonWriter& json, const char* name, const TimeQuantiles& time) {
  json.beginObject(name);
  json.field("median", time.median_ms);
  json.field("p95", time.p95_ms);
  json.field("worst", time.worst_ms);
  json.endObject();
}

void write(JsonWriter& json, const char* name, const std::map<std::string, std::size_t>& counts) {
  json.beginObject(name);
  for (const auto& [key, count] : counts) json.field(key, count);
  json.endObject();
}

void writeErrors(JsonWriter& json, const RunReport& r) {
  if (r.absolute) {
    json.field("ate_rmse_m", r.absolute->translation_m.rmse);
    write(json, "ate_m", r.absolute->translation_m);
  } else {
    json.null("ate_rmse_m");
    json.null("ate_m");
  }
  if (r.relative) {
    write(json, "rpe_1s_translation_m", r.relative->translation_m);
    write(json, "rpe_1s_rotation_deg", r.relative->rotation_deg);
  } else {
    json.null("rpe_1s_translation_m");
    json.null("rpe_1s_rotation_deg");
  }
}

void writeMask(JsonWriter& json, const MaskScore& mask) {
  if (mask.frames() == 0) {
    json.null("mask");
    return;
  }
  json.beginObject("mask");
  json.field("iou", mask.iou());
  json.field("precision", mask.precision());
  json.field("recall", mask.recall());
  json.field("frames", mask.frames());
  json.endObject();
}

void writeMotion(JsonWriter& json, const std::vector<FrameMotion>& motion) {
  std::map<std::string, std::size_t> frames_with_model;
  std::vector<double> frame, inliers, dynamic_share;
  std::vector<std::string> model;
  for (const FrameMotion& m : motion) {
    ++frames_with_model[m.model];
    frame.push_back(static_cast<double>(m.frame));
    model.push_back(m.model);
    inliers.push_back(m.inliers);
    dynamic_share.push_back(m.dynamic_share);
  }
  const double sum = std::accumulate(dynamic_share.begin(), dynamic_share.end(), 0.0);
  json.beginObject("motion");
  json.field("mean_dynamic_share", motion.empty() ? 0.0 : sum / static_cast<double>(motion.size()));
  write(json, "frames_with_model", frames_with_model);
  json.beginObject("per_frame");
  json.field("frame", frame);
  json.field("model", model);
  json.field("inliers", inliers);
  json.field("dynamic_share", dynamic_share);
  json.endObject();
  json.endObject();
}

template <class... Values>
std::string format(const char* form, Values... values) {
  char text[256];
  std::snprintf(text, sizeof text, form, values...);
  return text;
}

/// A line of the process's status, MB; 0 where the system does not tell.
double statusMb(const char* name) {
  std::ifstream status("/proc/self/status");
  for (std::string key; status >> key;) {
    double kilobytes = 0.0;
    if (key == name && status >> kilobytes) return kilobytes / 1024.0;
  }
  return 0.0;
}

}  // namespace

std::string toJson(const RunReport& r) {
  JsonWriter json;
  json.field("sequence", r.sequence);
  json.field("frames", r.frames);
  json.field("posed", r.posed);
  json.field("posed_share", r.posedShare());
  json.field("keyframes", r.keyframes);
  json.field("landmarks", r.landmarks);
  json.field("keyframes_passed_over", r.keyframes_passed_over);
  writeErrors(json, r);
  writeMask(json, r.mask);
  writeMotion(json, r.motion);
  write(json, "frames_in_state", r.frames_in_state);
  json.field("skipped_broken", r.skipped_broken);
  json.field("dropped_late", r.dropped_late);
  if (r.latency_ms.empty()) {
    json.null("latency_ms");
  } else {
    write(json, "latency_ms", quantilesOf(r.latency_ms));
  }
  json.field("decoding_late_ms", r.decoding_late_ms);
  json.field("cloud_points", r.cloud_points);
  json.field("voxels", r.voxels);
  json.field("start_s", r.start_s);
  json.field("wall_s", r.wall_s);
  json.field("peak_memory_mb", r.peak_memory_mb);
  json.field("ended", r.ended);
  json.beginObject("files");
  for (const auto& [name, bytes] : r.files) json.field(name, static_cast<std::size_t>(bytes));
  json.endObject();
  json.beginObject("stages");
  for (const StageSummary& stage : r.stages) {
    json.beginObject(stage.stage);
    json.field("count", stage.count);
    write(json, "wall_ms", stage.wall);
    write(json, "cpu_ms", stage.cpu);
    json.endObject();
  }
  json.endObject();
  return json.finish();
}

std::string headline(const RunReport& r) {
  return format("%zu of %zu frames posed (%.1f %%), %zu keyframes, %zu landmarks, %zu points in the cloud", r.posed,
                r.frames, 100.0 * r.posedShare(), r.keyframes, r.landmarks, r.cloud_points);
}

std::string toText(const RunReport& r) {
  std::string text = headline(r) + "\n";
  if (r.absolute) text += format("ATE RMSE %.4f m\n", r.absolute->translation_m.rmse);
  if (r.relative) {
    text +=
        format("RPE RMSE over 1 s %.4f m, %.3f deg\n", r.relative->translation_m.rmse, r.relative->rotation_deg.rmse);
  }
  if (r.mask.frames() > 0) {
    text += format("mask IoU %.3f, precision %.3f, recall %.3f\n", r.mask.iou(), r.mask.precision(), r.mask.recall());
  }
  if (!r.latency_ms.empty()) {
    const TimeQuantiles latency = quantilesOf(r.latency_ms);
    text += format("real time: %zu frames dropped; pose after %.0f ms (median), %.0f (p95), %.0f (worst)\n",
                   r.dropped_late, latency.median_ms, latency.p95_ms, latency.worst_ms);
    if (r.keyframes_passed_over > 0) {
      text +=
          format("%zu keyframes are not in the dense map: segmentation was too far behind\n", r.keyframes_passed_over);
    }
  }
  text += format("%-20s %7s %12s %9s %9s\n", "stage", "count", "cpu ms: med", "p95", "worst");
  for (const StageSummary& stage : r.stages) {
    text += format("%-20s %7zu %12.2f %9.2f %9.2f\n", stage.stage.c_str(), stage.count, stage.cpu.median_ms,
                   stage.cpu.p95_ms, stage.cpu.worst_ms);
  }
  if (r.ended != "complete") text += "ended early: " + r.ended + "\n";
  return text + format("%.1f s in all, peak memory %.0f MB\n", r.wall_s, r.peak_memory_mb);
}

double peakMemoryMb() { return statusMb("VmHWM:"); }

double residentMemoryMb() { return statusMb("VmRSS:"); }

double secondsSinceProcessStart() {
  std::ifstream stat("/proc/self/stat");
  std::string line;
  std::getline(stat, line);
  // The second field is the name in brackets and may hold anything; the start in clock ticks since boot is the 22nd.
  std::istringstream fields(line.substr(std::min(line.size(), line.rfind(')') + 1)));
  std::string skipped;
  for (int field = 3; field < 22; ++field) fields >> skipped;
  double start_ticks = 0.0;
  timespec now{};
  if (!(fields >> start_ticks) || clock_gettime(CLOCK_BOOTTIME, &now) != 0) return 0.0;
  return static_cast<double>(now.tv_sec) + 1e-9 * static_cast<double>(now.tv_nsec) -
         start_ticks / static_cast<double>(sysconf(_SC_CLK_TCK));
}

}  // namespace semantic_vslam
