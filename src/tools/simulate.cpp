// SPDX-License-Identifier: BSD-3-Clause
// posefusion_simulate: makes a recording of a simulated room with people.
#include <algorithm>
#include <csignal>
#include <filesystem>
#include <future>
#include <iostream>

#include "posefusion/core/error.hpp"
#include "posefusion/io/files.hpp"
#include "posefusion/io/images.hpp"
#include "posefusion/io/trajectory_file.hpp"
#include "progress.hpp"
#include "simulate_bag.hpp"
#include "simulator/contact_sheet.hpp"
#include "simulator/output.hpp"
#include "simulator/scenario.hpp"
#include "simulator/sense_files.hpp"
#include "simulator/simulation.hpp"
#include "tool.hpp"

namespace {

using namespace pf;
using namespace pf::simulator;

volatile std::sig_atomic_t stop_asked = 0;
void askStop(int signal) { stop_asked = signal; }

struct Options {
  std::string scenario;
  std::string output;
  std::string sheet;
  int sheet_frames = 8;
  int sheet_width = 400;
  bool list = false;
  bool no_images = false;
  ScenarioChanges changes;
};

void addOptions(CommandLine& app, Options& o) {
  app.addOption("scenario", o.scenario, "name (see --list) or scene file (.yaml)");
  app.addOption("-o,--output", o.output, "new TUM folder, or a new bag when it ends in .bag");
  app.addOption("--seed", o.changes.seed, "everything random; same seed, same bytes");
  app.addOption("--duration", o.changes.duration_s, "seconds")->check(positive());
  app.addOption("--start", o.changes.start_s, "begin so many seconds into the scenario")
      ->check(nonNegative());
  app.addOption("--set", o.changes.assignments, "KEY=VALUE: any value of the scene file");
  app.addOption("--contact-sheet", o.sheet, "PNG with frames spread over the duration");
  app.addOption("--sheet-frames", o.sheet_frames, "frames of the contact sheet")
      ->check(range(1, 200));
  app.addOption("--sheet-width", o.sheet_width, "width of a picture of it")->check(range(40, 2000));
  app.addFlag("--no-images", o.no_images,
              "into the folder, which may be there, only the true poses and what the other sensors "
              "say: nothing is drawn");
  app.addFlag("--list", o.list, "names of the scenarios");
}

void makeSheet(Simulation& simulation, const Options& o) {
  const int count = std::min(o.sheet_frames, simulation.frameCount());
  Progress progress(static_cast<std::size_t>(count));
  cv::Mat sheet;
  for (int i = 0; i < count; ++i) {
    simulation.jump();
    const int index = static_cast<int>((i + 0.5) * simulation.frameCount() / count);
    const SimulatedFrame frame = simulation.frame(index);
    if (!frame.dropped) sheet.push_back(drawFrame(frame, simulation, o.sheet_width));
    progress.update(static_cast<std::size_t>(i + 1));
  }
  savePng(o.sheet, sheet);
}

bool isBag(const Options& o) { return std::filesystem::path(o.output).extension() == ".bag"; }

/// Throws InputError where a folder has the truth of another recording.
void expectSameTruth(const std::string& path, const Trajectory& truth) {
  if (!std::filesystem::exists(path)) return;
  const Trajectory there = loadTrajectory(path);
  const bool same = std::equal(
      there.begin(), there.end(), truth.begin(), truth.end(), [](const auto& a, const auto& b) {
        return a.stamp_ns == b.stamp_ns && a.T_world_camera.isApprox(b.T_world_camera, 1e-6);
      });
  if (!same) {
    throw InputError(path + ": is of another recording, expected one of this scenario and seed");
  }
}

/// What needs no picture; beside the pictures too, where they are there.
int recordWithoutImages(const Simulation& simulation, const Options& o) {
  const int frames = simulation.frameCount();
  const Trajectory truth = simulation.truth(frames);
  const std::string path = std::filesystem::path(o.output) / "groundtruth.txt";
  expectSameTruth(path, truth);
  makeFolder(o.output);
  saveTrajectory(path, truth, "camera to world");
  saveSenses(o.output, simulation, frames);
  return 0;
}

int record(Simulation& simulation, const Options& o) {
  const auto output = isBag(o) ? openBagOutput(o.output) : openTumOutput(o.output, simulation);
  std::signal(SIGINT, askStop);
  std::signal(SIGTERM, askStop);
  int made = 0;
  {
    Progress progress(static_cast<std::size_t>(simulation.frameCount()));
    std::future<void> writing;  // one frame is stored while the next is drawn
    for (; made < simulation.frameCount() && stop_asked == 0; ++made) {
      SimulatedFrame frame = simulation.frame(made);
      if (writing.valid()) writing.get();
      writing =
          std::async(std::launch::async, [&output, kept = std::move(frame)] { output->add(kept); });
      progress.update(static_cast<std::size_t>(made + 1));
    }
    if (writing.valid()) writing.get();
  }
  output->finish(simulation);
  if (stop_asked == 0) return 0;
  std::cerr << "posefusion_simulate: stopped; " << made << " frames are in " << o.output << "\n";
  return 128 + stop_asked;
}

int simulate(const Options& options) {
  if (options.list) {
    for (const auto& name : scenarioNames()) std::cout << name << "\n";
    return 0;
  }
  if (options.scenario.empty())
    throw CommandError(CommandFault::missing,
                       "SCENARIO is missing: a name (see --list) or a scene file");
  if (options.output.empty() && options.sheet.empty()) {
    throw CommandError(CommandFault::missing,
                       "--output is missing: what to write (or --contact-sheet)");
  }
  if (options.no_images && isBag(options)) {
    throw InputError(options.output + ": is a bag, --no-images expects a folder");
  }
  Simulation simulation(loadScenario(options.scenario, options.changes));
  if (!options.sheet.empty()) makeSheet(simulation, options);
  if (options.output.empty()) return 0;
  return options.no_images ? recordWithoutImages(simulation, options) : record(simulation, options);
}

}  // namespace

int main(int argc, char** argv) {
  CommandLine app{
      "Makes a recording of a simulated room: colour, depth, and the truth of camera and people.",
      "posefusion_simulate"};
  Options options;
  addOptions(app, options);
  return runTool(app, argc, argv, [&] { return simulate(options); });
}
