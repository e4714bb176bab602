// SPDX-License-Identifier: BSD-3-Clause
#include <cstdio>
#include <filesystem>
#include <nlohmann/json.hpp>
#include <optional>

#include "evaluate.hpp"
#include "posefusion/core/error.hpp"
#include "posefusion/evaluation/metrics.hpp"
#include "posefusion/io/files.hpp"
#include "posefusion/io/images.hpp"
#include "posefusion/io/ply.hpp"
#include "posefusion/io/trajectory_file.hpp"
#include "posefusion/run/plan_picture.hpp"
#include "posefusion/run/plot.hpp"
#include "posefusion/run/sequence_facts.hpp"
#include "track_answer.hpp"

namespace pf {
namespace {

namespace fs = std::filesystem;

/// The trajectory of a run's folder, or the file itself.
std::string trajectoryFile(const std::string& estimate) {
  return fs::is_directory(estimate) ? (fs::path(estimate) / "trajectory.txt").string() : estimate;
}

/// What the run of a folder reported at the time; nothing for a file, or where it was not kept.
std::optional<Trajectory> liveTrajectory(const std::string& estimate) {
  const fs::path file = fs::path(estimate) / "trajectory_live.txt";
  if (!fs::exists(file)) return std::nullopt;
  return loadTrajectory(file);
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

TrackAnswer check(const SequenceTruth& truth, const Trajectory& estimate,
                  const TrajectoryQuestion& question) {
  TrackAnswer answer;
  answer.errors = trackErrors(truth.trajectory, estimate, question.with_scale);
  if (const auto live = liveTrajectory(question.estimate)) {
    answer.live = trackErrors(truth.trajectory, *live, question.with_scale);
  }
  if (truth.facts.frames_ns.empty()) return answer;
  answer.coverage = coverageOf(estimate, truth.facts);
  answer.held_m =
      heldError(truth.trajectory, estimate, truth.facts.frames_ns, answer.errors.alignment);
  answer.gated = gatedFrames(trajectoryFile(question.estimate));
  return answer;
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
              const Trajectory& estimate, const TrackErrors& errors) {
  const auto pairs = matchPoses(truth, estimate);
  const Eigen::Isometry3d& T_truth_map = errors.places.T_truth_estimate;
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
  plan.wrong = errors.wrong;
  char title[160];
  std::snprintf(title, sizeof(title),
                "ATE %.3f m RMSE, %zu poses, %zu wrong, last pose %.3f m off; aligned at the start",
                errors.absolute_m.rmse, estimate.size(), errors.wrong.size(), errors.last_m);
  plan.title = title;
  savePng(question.plan, drawPlan(plan));
}

}  // namespace

void evaluateTrajectory(const TrajectoryQuestion& question) {
  const SequenceTruth truth = loadSequenceTruth(question.truth);
  const Trajectory estimate = loadTrajectory(trajectoryFile(question.estimate));
  const TrackAnswer answer = check(truth, estimate, question);
  if (question.json) {
    printTrackJson(answer);
  } else {
    printTrackTable(answer, question.with_scale);
  }
  if (!question.plot.empty()) {
    const auto pairs = matchPoses(truth.trajectory, estimate);
    savePng(question.plot, plotTrajectories(truth.trajectory, pairs, answer.errors.alignment));
  }
  if (!question.plan.empty()) savePlan(question, truth.trajectory, estimate, answer.errors);
}

}  // namespace pf
