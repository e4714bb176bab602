// SPDX-License-Identifier: BSD-3-Clause
// For the bench: wrong loops, reported while a recording is mapped. Five between two stretches of
// the way, all off by one motion, so that they agree with each other: what is left of them in the
// graph in the end, and what they cost.
#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <iostream>
#include <nlohmann/json.hpp>
#include <random>
#include <string>
#include <vector>

#include "posefusion/core/error.hpp"
#include "posefusion/evaluation/metrics.hpp"
#include "posefusion/io/trajectory_file.hpp"
#include "posefusion/run/run.hpp"
#include "posefusion_ros/bags/bag_source.hpp"
#include "progress.hpp"
#include "tool.hpp"

namespace pf {
namespace {

constexpr double kNearest_m = 0.3, kFarthest_m = 1.0, kMostTurn_rad = 0.2;
const Matrix6d kCovariance = 1e-5 * Matrix6d::Identity();

struct Options {
  std::string sequence, truth;
  std::string detector = "embedded";
  int loops = 5;
  int from = 5, to = 60;  ///< first keyframes of the two stretches
  unsigned seed = 1;
};

/// By what the loops are off.
Eigen::Isometry3d wrongMotion(unsigned seed) {
  std::mt19937 random(seed);
  std::uniform_real_distribution<double> length(kNearest_m, kFarthest_m);
  std::normal_distribution<double> normal;
  const auto direction = [&] {
    return Eigen::Vector3d(normal(random), normal(random), normal(random)).normalized();
  };
  Eigen::Isometry3d T = Eigen::Isometry3d::Identity();
  T.translation() = length(random) * direction();
  std::uniform_real_distribution<double> angle(0, kMostTurn_rad);
  const double turn = angle(random);
  T.linear() = Eigen::AngleAxisd(turn, direction()).toRotationMatrix();
  return T;
}

LoopAnswer wrongAnswer(const Mapper& mapper, const Options& options) {
  const auto& keyframes = mapper.backEnd().graph().keyframes();
  const auto pose = [&](int i) { return keyframes[static_cast<std::size_t>(i)].T_map_camera; };
  const Eigen::Isometry3d off = wrongMotion(options.seed);
  LoopAnswer answer;
  for (int k = 0; k < options.loops; ++k) {
    const int from = options.from + k, to = options.to + k;
    answer.loops.push_back({from, to, pose(from).inverse() * off * pose(to), kCovariance});
  }
  return answer;
}

bool isOneOf(const std::vector<LoopConstraint>& loops, const PoseConstraint& c) {
  return std::any_of(loops.begin(), loops.end(), [&](const LoopConstraint& loop) {
    return c.kind == ConstraintKind::loop && c.from == loop.from && c.to == loop.to &&
           c.T_from_to.matrix() == loop.T_from_to.matrix();
  });
}

int tellWrongLoops(const Options& options) {
  const auto source = posefusion_ros::openInput(options.sequence, {});
  Config config = configFor({}, *source);
  config.pose.detector = options.detector;
  config.loop.refine_at_end = false;  // it measures again what holds: none must be left by then
  Pipeline pipeline(config, makePoseDetector(config.pose, source->people()));
  LoopAnswer told;
  Progress progress(source->frameCount());
  std::size_t frames = 0, held_once = 0;
  const auto held = [&] {
    const auto& all = pipeline.mapper().backEnd().graph().constraints();
    return static_cast<std::size_t>(std::count_if(
        all.begin(), all.end(), [&](const auto& c) { return isOneOf(told.loops, c); }));
  };
  runPipeline(*source, pipeline, [&](const ProcessedFrame&, const std::string&) {
    const auto keyframes = pipeline.mapper().backEnd().graph().keyframes().size();
    const auto needed = static_cast<std::size_t>(options.to + options.loops);
    if (options.loops > 0 && told.loops.empty() && keyframes >= needed) {
      told = wrongAnswer(pipeline.mapper(), options);
      pipeline.take(told);
    }
    held_once = std::max(held_once, held());
    progress.update(++frames);
    return true;
  });
  pipeline.finish();
  if (options.loops > 0 && told.loops.empty()) {
    throw InputError(options.sequence + ": has fewer keyframes than --to asks for");
  }
  const BackEnd& back_end = pipeline.mapper().backEnd();
  const auto truth =
      loadTrajectory(options.truth.empty() ? options.sequence + "/groundtruth.txt" : options.truth);
  const auto pairs = matchPoses(truth, back_end.trajectory());
  const nlohmann::ordered_json out = {
      {"told", told.loops.size()},
      {"held_at_a_time", held_once},
      {"held_in_the_end", held()},
      {"withdrawn", back_end.counts().withdrawn},
      {"refused", back_end.counts().refused},
      {"constraints", back_end.graph().constraints().size()},
      {"ate_rmse_m", absoluteError(pairs, align(pairs, false)).rmse}};
  std::cout << out.dump(2) << "\n";
  return 0;
}

}  // namespace
}  // namespace pf

int main(int argc, char** argv) {
  pf::CommandLine app{
      "Reports wrong loops while a recording is mapped, and shows what becomes of them.",
      "posefusion_wrong_loops"};
  pf::Options options;
  app.addOption("sequence", options.sequence, "TUM folder or bag")->required();
  app.addOption("--truth", options.truth, "trajectory; default: that of the folder");
  app.addOption("--detector", options.detector, "of people");
  app.addOption("--loops", options.loops, "that are wrong; 0: none");
  app.addOption("--from", options.from, "keyframe that the first leads from");
  app.addOption("--to", options.to, "keyframe that the first leads to");
  app.addOption("--seed", options.seed, "of what they are off by");
  return pf::runTool(app, argc, argv, [&] { return pf::tellWrongLoops(options); });
}
