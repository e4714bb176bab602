// SPDX-License-Identifier: BSD-3-Clause
// How good a trajectory, a run, or masks are.
#include "evaluate.hpp"

#include <CLI/CLI.hpp>
#include <exception>
#include <iostream>

namespace pf {
namespace {

int evaluate(int argc, char** argv) {
  CLI::App app{"Errors of an estimated trajectory by the definitions of the TUM benchmark."};
  app.require_subcommand(0, 1);
  TrajectoryQuestion trajectory;
  app.add_option("truth", trajectory.truth, "true trajectory, TUM format");
  auto* estimate = app.add_option("estimate", trajectory.estimate, "estimated trajectory");
  app.add_flag("--scale", trajectory.with_scale, "align with a scale too");
  app.add_option("--plot", trajectory.plot, "picture to write, PNG");
  app.add_flag("--json", trajectory.json, "print JSON");

  RunQuestion run;
  auto* run_command = app.add_subcommand("run", "the map of a run against its input");
  run_command->add_option("run", run.run, "output folder of posefusion_run")->required();
  run_command->add_option("input", run.input, "TUM folder or bag it was made from")->required();
  run_command->add_option("--truth", run.truth, "true trajectory, TUM format");
  run_command->add_option("--camera", run.camera, "camera file, instead of the input's own");
  run_command->add_option("--masks", run.masks, "true masks of people; default: INPUT/mask");
  run_command->add_option("--first-frame", run.first_frame, "depth: first frame of the input")
      ->capture_default_str();
  run_command->add_option("--last-frame", run.last_frame, "depth: frame to stop before")
      ->capture_default_str();
  run_command->add_flag("--json", run.json, "print JSON");

  std::string true_masks, masks;
  bool masks_json = false;
  auto* masks_command = app.add_subcommand("masks", "masks of people against true ones");
  masks_command->add_option("truth", true_masks, "sequence with mask/ (without: nobody is in it)")
      ->required();
  masks_command->add_option("masks", masks, "output folder of posefusion_run --save-masks")
      ->required();
  masks_command->add_flag("--json", masks_json, "print JSON");

  try {
    app.parse(argc, argv);
    if (!*run_command && !*masks_command && !*estimate) {
      throw CLI::RequiredError("true and estimated trajectory");
    }
  } catch (const CLI::ParseError& error) {
    return app.exit(error);
  }
  if (*run_command) {
    evaluateRun(run);
  } else if (*masks_command) {
    evaluateMasks(true_masks, masks, masks_json);
  } else {
    evaluateTrajectory(trajectory);
  }
  return 0;
}

}  // namespace
}  // namespace pf

int main(int argc, char** argv) {
  try {
    return pf::evaluate(argc, argv);
  } catch (const std::exception& error) {
    std::cerr << "posefusion_evaluate: " << error.what() << "\n";
    return 1;
  }
}
