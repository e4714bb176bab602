// SPDX-License-Identifier: BSD-3-Clause
#include <cstdio>
#include <filesystem>
#include <iostream>
#include <nlohmann/json.hpp>
#include <optional>

#include "evaluate.hpp"
#include "posefusion/core/error.hpp"
#include "posefusion/evaluation/metrics.hpp"
#include "posefusion/evaluation/track_check.hpp"
#include "posefusion/io/files.hpp"
#include "posefusion/io/images.hpp"
#include "posefusion/io/ply.hpp"
#include "posefusion/io/trajectory_file.hpp"
#include "posefusion/run/plan_picture.hpp"
#include "posefusion/run/plot.hpp"
#include "posefusion/run/sequence_facts.hpp"

namespace pf {
namespace {

namespace fs = std::filesystem;

struct Answer {
  Alignment alignment;
  ErrorStatistics absolute;
  RelativeError per_frame, per_second;
  std::optional<PoseCoverage> coverage;  ///< where the frames of the sequence are known
  std::optional<ErrorStatistics> held;
  std::optional<std::size_t> gated;  ///< frames that the run's blur gate dropped
  std::vector<std::size_t> wrong;
  PlaceErrors places;
  double last_m = 0;
};

/// The trajectory of a run's folder, or the file itself.
std::string trajectoryFile(const std::string& estimate) {
  return fs::is_directory(estimate) ? (fs::path(estimate) / "trajectory.txt").string() : estimate;
}

/// Frames that the blur gate of the run dropped, where its summary lies beside the trajectory.
std::optional<std::size_t> gatedFrames(const fs::path& trajectory) {
  const fs::path path = trajectory.parent_path() / "summary.json";
  if (!fs::exists(path)) return std::nullopt;
  try {
    const auto summary = nlohmann::json::parse(readFile(path));
    return summary.at("frames").at("blurred").get<std::size_t>();
  } catch (const nlohmann::json::exception& error) {
    throw InputError(path.string() + ": " + error.what());
  }
}

Answer check(const SequenceTruth& truth, const Trajectory& estimate,
             const TrajectoryQuestion& question) {
  const auto pairs = matchPoses(truth.trajectory, estimate);
  Answer answer;
  answer.alignment = align(pairs, question.with_scale);
  const double scale = answer.alignment.scale;
  answer.absolute = absoluteError(pairs, answer.alignment);
  answer.per_frame = relativeErrorPerFrame(truth.trajectory, estimate, scale);
  answer.per_second = relativeErrorPerSecond(truth.trajectory, estimate, scale);
  answer.last_m = lastError(truth.trajectory, estimate, answer.alignment);
  Trajectory scaled = estimate;
  for (auto& pose : scaled) pose.T_world_camera.translation() *= scale;
  answer.wrong = wrongPoses(truth.trajectory, scaled);
  answer.places = placeErrors(truth.trajectory, scaled, truth.facts);
  if (truth.facts.frames_ns.empty()) return answer;
  answer.coverage = coverageOf(estimate, truth.facts);
  answer.held = heldError(truth.trajectory, estimate, truth.facts.frames_ns, answer.alignment);
  answer.gated = gatedFrames(trajectoryFile(question.estimate));
  return answer;
}

/// Share of the frames with a pose, of those that the run's gate let pass.
double gatedShare(const Answer& a) {
  const std::size_t passed = a.coverage->frames - std::min(*a.gated, a.coverage->frames);
  return passed > 0 ? static_cast<double>(a.coverage->posed) / static_cast<double>(passed) : 1.0;
}

nlohmann::ordered_json toJson(const ErrorStatistics& e) {
  return {
      {"rmse", e.rmse}, {"mean", e.mean}, {"median", e.median}, {"max", e.max}, {"count", e.count}};
}

void printJson(const Answer& a) {
  nlohmann::ordered_json out;
  out["scale"] = a.alignment.scale;
  out["ate_m"] = toJson(a.absolute);
  if (a.held) out["ate_held_m"] = toJson(*a.held);
  out["rpe_trans_m_per_frame"] = toJson(a.per_frame.translation_m);
  out["rpe_rot_deg_per_frame"] = toJson(a.per_frame.rotation_deg);
  out["rpe_trans_m_per_s"] = toJson(a.per_second.translation_m);
  out["rpe_rot_deg_per_s"] = toJson(a.per_second.rotation_deg);
  if (a.coverage) {
    out["coverage"] = {{"frames", a.coverage->frames},
                       {"share", a.coverage->share()},
                       {"share_of_sharp", a.coverage->sharpShare()}};
    if (a.gated) out["coverage"]["share_of_passed"] = gatedShare(a);
  }
  out["wrong_poses"] = a.wrong.size();
  out["false_poses"] = a.places.false_count;
  out["worst_m"] = a.places.worst_m;
  out["last_m"] = a.last_m;
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
  if (a.held) printLine("ATE m, last pose held", *a.held);
  printLine("RPE m/frame", a.per_frame.translation_m);
  printLine("RPE deg/frame", a.per_frame.rotation_deg);
  printLine("RPE m/s", a.per_second.translation_m);
  printLine("RPE deg/s", a.per_second.rotation_deg);
  if (with_scale) std::printf("%-24s %10.6f\n", "scale", a.alignment.scale);
  if (a.coverage) {
    std::printf("frames with a pose       %.2f %% of %zu", 100 * a.coverage->share(),
                a.coverage->frames);
    if (a.coverage->sharp_frames < a.coverage->frames) {
      std::printf(", %.2f %% of those not blurred", 100 * a.coverage->sharpShare());
    }
    if (a.gated) std::printf(", %.2f %% of those the gate let pass", 100 * gatedShare(a));
    std::printf("\n");
  }
  std::printf(
      "wrong poses              %zu (motion over a second off by more than 0.10 m or 5 deg)\n",
      a.wrong.size());
  std::printf(
      "false poses              %zu (more than 0.10 m off, aligned before the fall or at the "
      "start); worst %.3f m\n",
      a.places.false_count, a.places.worst_m);
  std::printf("last pose                %.4f m\n", a.last_m);
}

/// The surface for the plan and the motion that brings it into the frame of the truth.
std::vector<SurfacePoint> surfaceFor(const TrajectoryQuestion& question,
                                     const Eigen::Isometry3d& T_truth_map) {
  const fs::path map = fs::path(trajectoryFile(question.estimate)).parent_path() / "map.ply";
  const fs::path scene = fs::path(question.truth) / "scene_points.ply";
  if (question.scene || !fs::exists(map)) {
    return fs::exists(scene) ? loadPoints(scene) : std::vector<SurfacePoint>{};
  }
  std::vector<SurfacePoint> points = loadPoints(map);
  const Eigen::Isometry3f T = T_truth_map.cast<float>();
  for (SurfacePoint& point : points) {
    point.position = T * point.position;
    point.normal = T.linear() * point.normal;
  }
  return points;
}

void savePlan(const TrajectoryQuestion& question, const Trajectory& truth,
              const Trajectory& estimate, const Answer& answer) {
  const auto pairs = matchPoses(truth, estimate);
  const Eigen::Isometry3d& T_truth_map = answer.places.T_truth_estimate;
  Plan plan;
  plan.surface = surfaceFor(question, T_truth_map);
  const std::int64_t from = pairs.front().truth.stamp_ns, to = pairs.back().truth.stamp_ns;
  for (const auto& pose : truth) {
    const bool inside = question.scene || (pose.stamp_ns >= from && pose.stamp_ns <= to);
    if (inside) plan.truth.push_back(pose);
  }
  for (const auto& pose : estimate) {
    plan.estimate.push_back({pose.stamp_ns, T_truth_map * pose.T_world_camera});
  }
  plan.wrong = answer.wrong;
  char title[160];
  std::snprintf(title, sizeof(title),
                "ATE %.3f m RMSE, %zu poses, %zu wrong, last pose %.3f m off; aligned at the start",
                answer.absolute.rmse, estimate.size(), answer.wrong.size(), answer.last_m);
  plan.title = title;
  savePng(question.plan, drawPlan(plan));
}

}  // namespace

void evaluateTrajectory(const TrajectoryQuestion& question) {
  const SequenceTruth truth = loadSequenceTruth(question.truth);
  const Trajectory estimate = loadTrajectory(trajectoryFile(question.estimate));
  const Answer answer = check(truth, estimate, question);
  if (question.json) {
    printJson(answer);
  } else {
    printTable(answer, question.with_scale);
  }
  if (!question.plot.empty()) {
    const auto pairs = matchPoses(truth.trajectory, estimate);
    savePng(question.plot, plotTrajectories(truth.trajectory, pairs, answer.alignment));
  }
  if (!question.plan.empty()) savePlan(question, truth.trajectory, estimate, answer);
}

}  // namespace pf
