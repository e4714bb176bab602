// SPDX-License-Identifier: BSD-3-Clause
#include "track_answer.hpp"

#include <algorithm>
#include <cstdio>
#include <iostream>
#include <nlohmann/json.hpp>

namespace pf {
namespace {

/// Share of the frames with a pose, of those that the run's gate let pass.
double gatedShare(const TrackAnswer& a) {
  const std::size_t passed = a.coverage->frames - std::min(*a.gated, a.coverage->frames);
  return passed > 0 ? static_cast<double>(a.coverage->posed) / static_cast<double>(passed) : 1.0;
}

nlohmann::ordered_json toJson(const ErrorStatistics& e) {
  return {
      {"rmse", e.rmse}, {"mean", e.mean}, {"median", e.median}, {"max", e.max}, {"count", e.count}};
}

void addPlaces(const TrackErrors& e, nlohmann::ordered_json& out) {
  out["ate_from_start_m"] = toJson(e.places.distance_m);
  out["wrong_poses"] = e.wrong.size();
  out["false_poses"] = e.places.false_count;
  out["worst_m"] = e.places.distance_m.max;
  out["worst_deg"] = e.places.worst_deg;
  out["last_m"] = e.last_m;
}

void printLine(const char* name, const ErrorStatistics& e) {
  if (e.count == 0) {
    std::printf("%-24s no pairs\n", name);
  } else {
    std::printf("%-24s %10.6f %10.6f %10.6f %10.6f %8zu\n", name, e.rmse, e.mean, e.median, e.max,
                e.count);
  }
}

void printCoverage(const TrackAnswer& a) {
  std::printf("frames with a pose       %.2f %% of %zu", 100 * a.coverage->share(),
              a.coverage->frames);
  if (a.coverage->sharp_frames < a.coverage->frames) {
    std::printf(", %.2f %% of those not blurred", 100 * a.coverage->sharpShare());
  }
  if (a.gated) std::printf(", %.2f %% of those the gate let pass", 100 * gatedShare(a));
  std::printf("\n");
}

void printPlaces(const char* name, const TrackErrors& e) {
  std::printf("%-24s %10.4f %10.4f %10.4f %10.4f %10.2f %8zu %8zu\n", name, e.absolute_m.rmse,
              e.absolute_m.max, e.places.distance_m.rmse, e.places.distance_m.max,
              e.places.worst_deg, e.places.false_count, e.wrong.size());
}

}  // namespace

TrackErrors trackErrors(const Trajectory& truth, const Trajectory& estimate, bool with_scale) {
  const auto pairs = matchPoses(truth, estimate);
  TrackErrors errors;
  errors.alignment = align(pairs, with_scale);
  const double scale = errors.alignment.scale;
  errors.absolute_m = absoluteError(pairs, errors.alignment);
  errors.per_frame = relativeErrorPerFrame(truth, estimate, scale);
  errors.per_second = relativeErrorPerSecond(truth, estimate, scale);
  errors.last_m = lastError(truth, estimate, errors.alignment);
  Trajectory scaled = estimate;
  for (auto& pose : scaled) pose.T_world_camera.translation() *= scale;
  errors.wrong = wrongPoses(truth, scaled);
  errors.places = placeErrors(truth, scaled);
  return errors;
}

void printTrackJson(const TrackAnswer& a) {
  const TrackErrors& e = a.errors;
  nlohmann::ordered_json out;
  out["scale"] = e.alignment.scale;
  out["ate_m"] = toJson(e.absolute_m);
  if (a.held_m) out["ate_held_m"] = toJson(*a.held_m);
  out["rpe_trans_m_per_frame"] = toJson(e.per_frame.translation_m);
  out["rpe_rot_deg_per_frame"] = toJson(e.per_frame.rotation_deg);
  out["rpe_trans_m_per_s"] = toJson(e.per_second.translation_m);
  out["rpe_rot_deg_per_s"] = toJson(e.per_second.rotation_deg);
  if (a.coverage) {
    out["coverage"] = {{"frames", a.coverage->frames},
                       {"share", a.coverage->share()},
                       {"share_of_sharp", a.coverage->sharpShare()}};
    if (a.gated) out["coverage"]["share_of_passed"] = gatedShare(a);
  }
  addPlaces(e, out);
  if (a.live) {
    out["live"]["ate_m"] = toJson(a.live->absolute_m);
    addPlaces(*a.live, out["live"]);
  }
  std::cout << out.dump(2) << "\n";
}

void printTrackTable(const TrackAnswer& a, bool with_scale) {
  const TrackErrors& e = a.errors;
  std::printf("%-24s %10s %10s %10s %10s %8s\n", "", "rmse", "mean", "median", "max", "count");
  printLine("ATE m", e.absolute_m);
  if (a.held_m) printLine("ATE m, last pose held", *a.held_m);
  printLine("RPE m/frame", e.per_frame.translation_m);
  printLine("RPE deg/frame", e.per_frame.rotation_deg);
  printLine("RPE m/s", e.per_second.translation_m);
  printLine("RPE deg/s", e.per_second.rotation_deg);
  if (with_scale) std::printf("%-24s %10.6f\n", "scale", e.alignment.scale);
  if (a.coverage) printCoverage(a);
  std::printf("last pose                %.4f m\n\n", e.last_m);
  std::printf("%-24s %21s %32s\n", "", "ATE m, best fit", "from the start: ATE m, deg");
  std::printf("%-24s %10s %10s %10s %10s %10s %8s %8s\n", "", "rmse", "max", "rmse", "max", "max",
              "false", "wrong");
  printPlaces(a.live ? "final, loops corrected" : "trajectory", e);
  if (a.live) printPlaces("live, as reported", *a.live);
  std::printf(
      "false: poses off by more than 0.10 m or 5 deg, aligned on the first second; drift counts\n"
      "wrong: poses whose motion over the second before is off by as much: jumps and slides "
      "alone\n");
}

}  // namespace pf
