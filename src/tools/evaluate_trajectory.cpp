// SPDX-License-Identifier: BSD-3-Clause
#include <cstdio>
#include <iostream>
#include <nlohmann/json.hpp>

#include "evaluate.hpp"
#include "posefusion/evaluation/metrics.hpp"
#include "posefusion/io/images.hpp"
#include "posefusion/io/trajectory_file.hpp"
#include "posefusion/run/plot.hpp"

namespace pf {
namespace {

struct Answer {
  Alignment alignment;
  ErrorStatistics absolute;
  RelativeError per_frame, per_second;
};

nlohmann::ordered_json toJson(const ErrorStatistics& e) {
  return {
      {"rmse", e.rmse}, {"mean", e.mean}, {"median", e.median}, {"max", e.max}, {"count", e.count}};
}

void printJson(const Answer& a) {
  nlohmann::ordered_json out;
  out["scale"] = a.alignment.scale;
  out["ate_m"] = toJson(a.absolute);
  out["rpe_trans_m_per_frame"] = toJson(a.per_frame.translation_m);
  out["rpe_rot_deg_per_frame"] = toJson(a.per_frame.rotation_deg);
  out["rpe_trans_m_per_s"] = toJson(a.per_second.translation_m);
  out["rpe_rot_deg_per_s"] = toJson(a.per_second.rotation_deg);
  std::cout << out.dump(2) << "\n";
}

void printLine(const char* name, const ErrorStatistics& e) {
  if (e.count == 0) {
    std::printf("%-24s no pairs\n", name);
  } else {
    std::printf("%-24s %10.6f %10.6f %10.6f %10.6f %8zu\n", name, e.rmse, e.mean, e.median, e.max,
                e.count);
  }
}

void printTable(const Answer& a, bool with_scale) {
  std::printf("%-24s %10s %10s %10s %10s %8s\n", "", "rmse", "mean", "median", "max", "count");
  printLine("ATE m", a.absolute);
  printLine("RPE m/frame", a.per_frame.translation_m);
  printLine("RPE deg/frame", a.per_frame.rotation_deg);
  printLine("RPE m/s", a.per_second.translation_m);
  printLine("RPE deg/s", a.per_second.rotation_deg);
  if (with_scale) std::printf("%-24s %10.6f\n", "scale", a.alignment.scale);
}

}  // namespace

void evaluateTrajectory(const TrajectoryQuestion& question) {
  const Trajectory truth = loadTrajectory(question.truth);
  const Trajectory estimate = loadTrajectory(question.estimate);
  const auto pairs = matchPoses(truth, estimate);
  Answer answer;
  answer.alignment = align(pairs, question.with_scale);
  answer.absolute = absoluteError(pairs, answer.alignment);
  answer.per_frame = relativeErrorPerFrame(truth, estimate, answer.alignment.scale);
  answer.per_second = relativeErrorPerSecond(truth, estimate, answer.alignment.scale);
  if (question.json) {
    printJson(answer);
  } else {
    printTable(answer, question.with_scale);
  }
  if (!question.plot.empty()) {
    savePng(question.plot, plotTrajectories(truth, pairs, answer.alignment));
  }
}

}  // namespace pf
