// SPDX-License-Identifier: BSD-3-Clause
#include <cmath>
#include <cstdio>
#include <iostream>
#include <nlohmann/json.hpp>

#include "evaluate.hpp"
#include "posefusion/core/error.hpp"
#include "posefusion/evaluation/pose_comparison.hpp"
#include "posefusion/io/trajectory_format.hpp"

namespace pf {
namespace {

std::int64_t nanoseconds(double seconds) { return std::llround(1e9 * seconds); }

/// Files without stamps are matched line by line.
std::vector<PosePair> pairsFor(const ComparisonQuestion& question) {
  const auto truth = readTrajectory(question.truth, trajectoryFormatNamed(question.truth_format));
  auto estimate =
      readTrajectory(question.estimate, trajectoryFormatNamed(question.estimate_format));
  if (truth.has_stamps && estimate.has_stamps) {
    for (auto& pose : estimate.poses) pose.stamp_ns += nanoseconds(question.offset_s);
    return matchPoses(truth.poses, estimate.poses, nanoseconds(question.max_difference_s));
  }
  if (truth.has_stamps != estimate.has_stamps || truth.poses.size() != estimate.poses.size()) {
    throw InputError(question.estimate + ": " + std::to_string(estimate.poses.size()) +
                     " poses, expected as many as " + question.truth +
                     " has, without stamps: " + std::to_string(truth.poses.size()));
  }
  if (question.step_unit == "seconds") {
    throw InputError("--step-unit seconds: " + question.truth + " has no stamps");
  }
  std::vector<PosePair> pairs;
  for (std::size_t i = 0; i < truth.poses.size(); ++i) {
    pairs.push_back({truth.poses[i], estimate.poses[i]});
  }
  return pairs;
}

nlohmann::ordered_json toJson(const ErrorStatistics& e) {
  return {{"rmse", e.rmse}, {"mean", e.mean}, {"median", e.median},   {"std", e.deviation},
          {"min", e.min},   {"max", e.max},   {"sse", e.squares_sum}, {"count", e.count}};
}

void printLine(const char* name, const ErrorStatistics& e) {
  std::printf("%-8s %10.6f %10.6f %10.6f %10.6f %10.6f %10.6f %12.6f %8zu\n", name, e.rmse, e.mean,
              e.median, e.deviation, e.min, e.max, e.squares_sum, e.count);
}

}  // namespace

void evaluateComparison(const ComparisonQuestion& question) {
  const std::vector<PosePair> pairs = pairsFor(question);
  const Alignment alignment = alignmentOf(pairs, alignByNamed(question.align));
  const Step step{question.step, stepUnitNamed(question.step_unit), question.overlapping};
  const PoseErrors absolute = absolutePoseErrors(pairs, alignment);
  const PoseErrors relative = relativePoseErrors(pairs, alignment, step);
  if (question.json) {
    nlohmann::ordered_json out;
    out["align"] = question.align;
    out["scale"] = alignment.scale;
    for (int row = 0; row < 3; ++row) {
      const Eigen::Vector3d axis = alignment.rotation.row(row);
      out["rotation"].push_back({axis.x(), axis.y(), axis.z()});
    }
    const Eigen::Vector3d& shift = alignment.translation;
    out["translation_m"] = {shift.x(), shift.y(), shift.z()};
    out["ate_m"] = toJson(absolute.translation_m);
    out["ate_deg"] = toJson(absolute.rotation_deg);
    out["rpe_m"] = toJson(relative.translation_m);
    out["rpe_deg"] = toJson(relative.rotation_deg);
    std::cout << out.dump(2) << "\n";
    return;
  }
  std::printf("alignment %s, scale %.6f; motions of %g %s%s\n", question.align.c_str(),
              alignment.scale, question.step, question.step_unit.c_str(),
              question.overlapping ? ", overlapping" : "");
  std::printf("%-8s %10s %10s %10s %10s %10s %10s %12s %8s\n", "", "rmse", "mean", "median", "std",
              "min", "max", "sse", "count");
  printLine("ATE m", absolute.translation_m);
  printLine("ATE deg", absolute.rotation_deg);
  printLine("RPE m", relative.translation_m);
  printLine("RPE deg", relative.rotation_deg);
}

}  // namespace pf
