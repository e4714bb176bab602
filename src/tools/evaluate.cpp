// SPDX-License-Identifier: BSD-3-Clause
// How good a trajectory, a run, its coverage, masks, reported covariances, the surface of a map, or
// loops are.
#include "evaluate.hpp"

#include "posefusion/io/run_folder.hpp"
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

CommandLine* addRunCommand(CommandLine& app, RunQuestion& run) {
  auto* command = app.addCommand("run", "the map of a run against its input");
  command->addOption("run", run.run, "output folder of posefusion_run")
      ->required()
      ->check(newest());
  command->addOption("input", run.input, "TUM folder or bag it was made from")->required();
  command->addOption("--truth", run.truth, "true trajectory, TUM format");
  command->addOption("--camera", run.camera, "camera file, instead of the input's own");
  command->addOption("--masks", run.masks, "true masks of people; default: INPUT/mask");
  command->addOption("--first-frame", run.first_frame, "depth: first frame of the input");
  command->addOption("--last-frame", run.last_frame, "depth: frame to stop before");
  command->addFlag("--json", run.json, "print JSON");
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
  return command;
}

CommandLine* addMasksCommand(CommandLine& app, PairQuestion& question) {
  auto* command = app.addCommand("masks", "masks of people against true ones");
  command->addOption("truth", question.truth, "sequence with mask/ (without: nobody is in it)")
      ->required();
  command->addOption("masks", question.checked, "output folder of posefusion_run --save-masks")
      ->required()
      ->check(newest());
  command->addFlag("--json", question.json, "print JSON");
  return command;
}

CommandLine* addCovarianceCommand(CommandLine& app, PairQuestion& question) {
  auto* command = app.addCommand(
      "covariance", "whether the true errors of motions are as large as the reported covariance");
  command->addOption("truth", question.truth, "sequence, or true trajectory")->required();
  command->addOption("status", question.checked, "table of posefusion_run --save-status")
      ->required();
  command->addFlag("--json", question.json, "print JSON");
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

CommandLine* addLoopsCommand(CommandLine& app, PairQuestion& question) {
  auto* command =
      app.addCommand("loops", "the loops that a map was corrected by against true poses");
  command->addOption("map", question.checked, "map file (map.pfdb)")->required();
  command->addOption("truth", question.truth, "sequence, or true trajectory")->required();
  command->addFlag("--json", question.json, "print JSON");
  return command;
}

}  // namespace
}  // namespace pf

int main(int argc, char** argv) {
  using namespace pf;
  CommandLine app{"Errors of an estimated trajectory by the definitions of the TUM benchmark.",
                  "posefusion_evaluate"};
  TrajectoryQuestion trajectory;
  RunQuestion run;
  KnownQuestion known;
  SurfaceQuestion mesh, grid;
  PairQuestion masks, covariance, surface, loops;
  const Option* estimate = addTrajectoryOptions(app, trajectory);
  const CommandLine* run_command = addRunCommand(app, run);
  const CommandLine* known_command = addKnownCommand(app, known);
  const CommandLine* masks_command = addMasksCommand(app, masks);
  const CommandLine* covariance_command = addCovarianceCommand(app, covariance);
  const CommandLine* surface_command = addSurfaceCommand(app, surface);
  const CommandLine* mesh_command =
      addMadeCommand(app, "mesh", "*.ply of posefusion_map mesh",
                     "a mesh of a run's map against the true surface of a simulated room", mesh);
  const CommandLine* grid_command =
      addMadeCommand(app, "grid", "*.yaml of posefusion_map grid",
                     "a grid of a run's map against the true plan of a simulated room", grid);
  const CommandLine* loops_command = addLoopsCommand(app, loops);
  return runTool(app, argc, argv, [&] {
    if (*run_command) {
      evaluateRun(run);
    } else if (*known_command) {
      evaluateKnown(known);
    } else if (*masks_command) {
      evaluateMasks(masks.truth, masks.checked, masks.json);
    } else if (*covariance_command) {
      evaluateCovariance(covariance.truth, covariance.checked, covariance.json);
    } else if (*surface_command) {
      evaluateSurface(surface.checked, surface.truth, surface.json);
    } else if (*mesh_command) {
      evaluateMesh(mesh);
    } else if (*grid_command) {
      evaluateGrid(grid);
    } else if (*loops_command) {
      evaluateLoops(loops.checked, loops.truth, loops.json);
    } else if (*estimate) {
      evaluateTrajectory(trajectory);
    } else {
      throw CommandError(CommandFault::missing, "TRUTH and ESTIMATE are missing: two trajectories");
    }
    return 0;
  });
}
