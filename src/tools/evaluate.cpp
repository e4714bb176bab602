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
CLI::Validator newest() {
  return CLI::Validator(
      [](std::string& path) {
        path = newestRun(path);
        return std::string();
      },
      "", "newest run");
}

CLI::Option* addTrajectoryOptions(CLI::App& app, TrajectoryQuestion& question) {
  app.add_option("truth", question.truth,
                 "sequence (TUM folder with groundtruth.txt), or true trajectory");
  auto* estimate = app.add_option("estimate", question.estimate,
                                  "estimated trajectory, or output folder of posefusion_run")
                       ->transform(newest());
  app.add_flag("--scale", question.with_scale, "align with a scale too");
  app.add_option("--plot", question.plot, "picture of the differences to write, PNG");
  app.add_option("--plan", question.plan,
                 "picture to write, PNG: the map from above with both paths and wrong poses");
  app.add_flag("--scene", question.scene,
               "plan: over the whole simulated room, not over the run's map");
  app.add_flag("--json", question.json, "print JSON");
  return estimate;
}

CLI::App* addRunCommand(CLI::App& app, RunQuestion& run) {
  auto* command = app.add_subcommand("run", "the map of a run against its input");
  command->add_option("run", run.run, "output folder of posefusion_run")
      ->required()
      ->transform(newest());
  command->add_option("input", run.input, "TUM folder or bag it was made from")->required();
  command->add_option("--truth", run.truth, "true trajectory, TUM format");
  command->add_option("--camera", run.camera, "camera file, instead of the input's own");
  command->add_option("--masks", run.masks, "true masks of people; default: INPUT/mask");
  command->add_option("--first-frame", run.first_frame, "depth: first frame of the input")
      ->capture_default_str();
  command->add_option("--last-frame", run.last_frame, "depth: frame to stop before")
      ->capture_default_str();
  command->add_flag("--json", run.json, "print JSON");
  return command;
}

CLI::App* addKnownCommand(CLI::App& app, KnownQuestion& question) {
  auto* command = app.add_subcommand(
      "known", "how many of the frames that truly see what was mapped before have a pose");
  command->add_option("run", question.run, "output folder of posefusion_run")
      ->required()
      ->transform(newest());
  command->add_option("sequence", question.sequence, "sequence with groundtruth.txt")->required();
  command->add_option("--status", question.status, "table of posefusion_run --save-status")
      ->required();
  command->add_flag("--json", question.json, "print JSON");
  return command;
}

CLI::App* addMasksCommand(CLI::App& app, PairQuestion& question) {
  auto* command = app.add_subcommand("masks", "masks of people against true ones");
  command->add_option("truth", question.truth, "sequence with mask/ (without: nobody is in it)")
      ->required();
  command->add_option("masks", question.checked, "output folder of posefusion_run --save-masks")
      ->required()
      ->transform(newest());
  command->add_flag("--json", question.json, "print JSON");
  return command;
}

CLI::App* addCovarianceCommand(CLI::App& app, PairQuestion& question) {
  auto* command = app.add_subcommand(
      "covariance", "whether the true errors of motions are as large as the reported covariance");
  command->add_option("truth", question.truth, "sequence, or true trajectory")->required();
  command->add_option("status", question.checked, "table of posefusion_run --save-status")
      ->required();
  command->add_flag("--json", question.json, "print JSON");
  return command;
}

/// The first of the two is the run, which is checked.
CLI::App* addSurfaceCommand(CLI::App& app, PairQuestion& question) {
  auto* command = app.add_subcommand(
      "surface", "the map of a run against the true surface of a simulated room");
  command->add_option("run", question.checked, "output folder of posefusion_run")
      ->required()
      ->transform(newest());
  command->add_option("sequence", question.truth, "sequence with scene_points.ply")->required();
  command->add_flag("--json", question.json, "print JSON");
  return command;
}

/// `of`: words for what the first file is.
CLI::App* addMadeCommand(CLI::App& app, const char* name, const char* of, const char* help,
                         SurfaceQuestion& question) {
  auto* command = app.add_subcommand(name, help);
  command->add_option(name, question.surface, of)->required();
  command->add_option("run", question.run, "output folder of posefusion_run")
      ->required()
      ->transform(newest());
  command->add_option("sequence", question.sequence, "sequence with scene_points.ply")->required();
  command->add_flag("--json", question.json, "print JSON");
  return command;
}

CLI::App* addLoopsCommand(CLI::App& app, PairQuestion& question) {
  auto* command =
      app.add_subcommand("loops", "the loops that a map was corrected by against true poses");
  command->add_option("map", question.checked, "map file (map.pfdb)")->required();
  command->add_option("truth", question.truth, "sequence, or true trajectory")->required();
  command->add_flag("--json", question.json, "print JSON");
  return command;
}

}  // namespace
}  // namespace pf

int main(int argc, char** argv) {
  using namespace pf;
  CLI::App app{"Errors of an estimated trajectory by the definitions of the TUM benchmark.",
               "posefusion_evaluate"};
  app.require_subcommand(0, 1);
  TrajectoryQuestion trajectory;
  RunQuestion run;
  KnownQuestion known;
  SurfaceQuestion mesh, grid;
  PairQuestion masks, covariance, surface, loops;
  const CLI::Option* estimate = addTrajectoryOptions(app, trajectory);
  const CLI::App* run_command = addRunCommand(app, run);
  const CLI::App* known_command = addKnownCommand(app, known);
  const CLI::App* masks_command = addMasksCommand(app, masks);
  const CLI::App* covariance_command = addCovarianceCommand(app, covariance);
  const CLI::App* surface_command = addSurfaceCommand(app, surface);
  const CLI::App* mesh_command =
      addMadeCommand(app, "mesh", "*.ply of posefusion_map mesh",
                     "a mesh of a run's map against the true surface of a simulated room", mesh);
  const CLI::App* grid_command =
      addMadeCommand(app, "grid", "*.yaml of posefusion_map grid",
                     "a grid of a run's map against the true plan of a simulated room", grid);
  const CLI::App* loops_command = addLoopsCommand(app, loops);
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
      throw CLI::RequiredError("true and estimated trajectory");
    }
    return 0;
  });
}
