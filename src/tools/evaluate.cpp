// SPDX-License-Identifier: BSD-3-Clause
// How good a trajectory, a run, its coverage, masks, reported covariances, the surface of a map, or
// loops are.
#include "evaluate.hpp"

#include <algorithm>
#include <vector>

#include "posefusion/evaluation/pose_comparison.hpp"
#include "posefusion/io/run_folder.hpp"
#include "posefusion/io/trajectory_format.hpp"
#include "tool.hpp"

namespace pf {
namespace {

/// What most of the commands ask: something true, something to be checked.
struct PairQuestion {
  std::string truth, checked;
  bool json = false;
};

/// Takes the newest run where a folder of runs is named.
ValueCheck newest() {
  return {"", [](std::string& path) {
            path = newestRun(path);
            return true;
          }};
}

Option* addTrajectoryOptions(CommandLine& app, TrajectoryQuestion& question) {
  app.addOption("truth", question.truth,
                "sequence (TUM folder with groundtruth.txt), or true trajectory");
  auto* estimate = app.addOption("estimate", question.estimate,
                                 "estimated trajectory, or output folder of posefusion_run")
                       ->check(newest());
  app.addFlag("--scale", question.with_scale, "align with a scale too");
  app.addOption("--plot", question.plot, "picture of the differences to write, PNG");
  app.addOption("--plan", question.plan,
                "picture to write, PNG: the map from above with both paths and wrong poses");
  app.addFlag("--scene", question.scene,
              "plan: over the whole simulated room, not over the run's map");
  app.addFlag("--json", question.json, "print JSON");
  return estimate;
}

CommandLine* addComparisonCommand(CommandLine& app, ComparisonQuestion& question) {
  auto* command = app.addCommand(
      "trajectory", "ATE and RPE of trajectory files as evo computes them; TUM, KITTI, EuRoC");
  const auto word = oneOf(trajectoryFormats());
  command->addOption("truth", question.truth, "true trajectory")->required();
  command->addOption("estimate", question.estimate, "estimated trajectory")->required();
  command->addOption("--truth-format", question.truth_format)->check(word);
  command->addOption("--estimate-format", question.estimate_format)->check(word);
  command->addOption("--align", question.align, "what is fitted before ATE is measured")
      ->check(oneOf(alignments()));
  command
      ->addOption("--max-difference-s", question.max_difference_s, "between stamps that are a pair")
      ->check(positive());
  command->addOption("--offset-s", question.offset_s, "added to the stamps of the estimate");
  command->addOption("--step", question.step, "RPE: length of the motions compared")
      ->check(positive());
  command->addOption("--step-unit", question.step_unit)->check(oneOf(stepUnits()));
  command->addFlag("--overlapping", question.overlapping,
                   "RPE: motions from every pose on, not end to end");
  command->addFlag("--json", question.json, "print JSON");
  command->does([&question] { evaluateComparison(question); });
  return command;
}

CommandLine* addRunCommand(CommandLine& app, RunQuestion& question) {
  auto* command = app.addCommand("run", "the map of a run against its input");
  command->addOption("run", question.run, "output folder of posefusion_run")
      ->required()
      ->check(newest());
  command->addOption("input", question.input, "TUM folder or bag it was made from")->required();
  command->addOption("--truth", question.truth, "true trajectory, TUM format");
  command->addOption("--camera", question.camera, "camera file, instead of the input's own");
  command->addOption("--masks", question.masks, "true masks of people; default: INPUT/mask");
  command->addOption("--first-frame", question.first_frame, "depth: first frame of the input");
  command->addOption("--last-frame", question.last_frame, "depth: frame to stop before");
  command->addFlag("--json", question.json, "print JSON");
  command->does([&question] { evaluateRun(question); });
  return command;
}

CommandLine* addKnownCommand(CommandLine& app, KnownQuestion& question) {
  auto* command = app.addCommand(
      "known", "how many of the frames that truly see what was mapped before have a pose");
  command->addOption("run", question.run, "output folder of posefusion_run")
      ->required()
      ->check(newest());
  command->addOption("sequence", question.sequence, "sequence with groundtruth.txt")->required();
  command->addOption("--status", question.status, "table of posefusion_run --save-status")
      ->required();
  command->addFlag("--json", question.json, "print JSON");
  command->does([&question] { evaluateKnown(question); });
  return command;
}

CommandLine* addMasksCommand(CommandLine& app, PairQuestion& question) {
  auto* command = app.addCommand("masks", "masks of people against true ones");
  command->addOption("truth", question.truth, "sequence with mask/ (without: no person is in it)")
      ->required();
  command->addOption("masks", question.checked, "output folder of posefusion_run --save-masks")
      ->required()
      ->check(newest());
  command->addFlag("--json", question.json, "print JSON");
  command->does([&question] { evaluateMasks(question.truth, question.checked, question.json); });
  return command;
}

CommandLine* addCovarianceCommand(CommandLine& app, PairQuestion& question) {
  auto* command = app.addCommand(
      "covariance", "whether the true errors of motions are as large as the reported covariance");
  command->addOption("truth", question.truth, "sequence, or true trajectory")->required();
  command->addOption("status", question.checked, "table of posefusion_run --save-status")
      ->required();
  command->addFlag("--json", question.json, "print JSON");
  command->does(
      [&question] { evaluateCovariance(question.truth, question.checked, question.json); });
  return command;
}

/// The first of the two is the run, which is checked.
CommandLine* addSurfaceCommand(CommandLine& app, PairQuestion& question) {
  auto* command =
      app.addCommand("surface", "the map of a run against the true surface of a simulated room");
  command->addOption("run", question.checked, "output folder of posefusion_run")
      ->required()
      ->check(newest());
  command->addOption("sequence", question.truth, "sequence with scene_points.ply")->required();
  command->addFlag("--json", question.json, "print JSON");
  command->does([&question] { evaluateSurface(question.checked, question.truth, question.json); });
  return command;
}

CommandLine* addThingsCommand(CommandLine& app, PairQuestion& question) {
  auto* command = app.addCommand(
      "things", "what a run's map and masks have of the things that moved in a simulated room");
  command->addOption("run", question.checked, "output folder of posefusion_run")
      ->required()
      ->check(newest());
  command->addOption("sequence", question.truth, "sequence with things/")->required();
  command->addFlag("--json", question.json, "print JSON");
  command->does([&question] { evaluateThings(question.checked, question.truth, question.json); });
  return command;
}

/// `of`: words for what the first file is.
CommandLine* addMadeCommand(CommandLine& app, const char* name, const char* of, const char* help,
                            SurfaceQuestion& question) {
  auto* command = app.addCommand(name, help);
  command->addOption(name, question.surface, of)->required();
  command->addOption("run", question.run, "output folder of posefusion_run")
      ->required()
      ->check(newest());
  command->addOption("sequence", question.sequence, "sequence with scene_points.ply")->required();
  command->addFlag("--json", question.json, "print JSON");
  return command;
}

CommandLine* addMeshCommand(CommandLine& app, SurfaceQuestion& question) {
  auto* command = addMadeCommand(
      app, "mesh", "*.ply of posefusion_map mesh",
      "a mesh of a run's map against the true surface of a simulated room", question);
  command->does([&question] { evaluateMesh(question); });
  return command;
}

CommandLine* addGridCommand(CommandLine& app, SurfaceQuestion& question) {
  auto* command =
      addMadeCommand(app, "grid", "*.yaml of posefusion_map grid",
                     "a grid of a run's map against the true plan of a simulated room", question);
  command->does([&question] { evaluateGrid(question); });
  return command;
}

CommandLine* addLoopsCommand(CommandLine& app, PairQuestion& question) {
  auto* command =
      app.addCommand("loops", "the loops that a map was corrected by against true poses");
  command->addOption("map", question.checked, "map file (map.pfdb)")->required();
  command->addOption("truth", question.truth, "sequence, or true trajectory")->required();
  command->addFlag("--json", question.json, "print JSON");
  command->does([&question] { evaluateLoops(question.checked, question.truth, question.json); });
  return command;
}

}  // namespace
}  // namespace pf

int main(int argc, char** argv) {
  using namespace pf;
  CommandLine app{"Errors of an estimated trajectory by the definitions of the TUM benchmark.",
                  "posefusion_evaluate"};
  TrajectoryQuestion trajectory;
  ComparisonQuestion comparison;
  RunQuestion run;
  KnownQuestion known;
  SurfaceQuestion mesh, grid;
  PairQuestion masks, covariance, surface, things, loops;
  const Option* estimate = addTrajectoryOptions(app, trajectory);
  const std::vector<const CommandLine*> commands = {addComparisonCommand(app, comparison),
                                                    addRunCommand(app, run),
                                                    addKnownCommand(app, known),
                                                    addMasksCommand(app, masks),
                                                    addCovarianceCommand(app, covariance),
                                                    addSurfaceCommand(app, surface),
                                                    addThingsCommand(app, things),
                                                    addMeshCommand(app, mesh),
                                                    addGridCommand(app, grid),
                                                    addLoopsCommand(app, loops)};
  return runTool(app, argc, argv, [&] {
    if (std::any_of(commands.begin(), commands.end(), [](const auto* c) { return bool(*c); })) {
      app.act();
    } else if (*estimate) {
      evaluateTrajectory(trajectory);
    } else {
      throw CommandError(CommandFault::missing, "TRUTH and ESTIMATE are missing: two trajectories");
    }
    return 0;
  });
}
