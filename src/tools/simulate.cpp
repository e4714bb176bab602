// SPDX-License-Identifier: BSD-3-Clause
// posefusion_simulate: makes a recording of a simulated room with people.
#include <csignal>
#include <filesystem>
#include <future>
#include <iostream>

#include "posefusion/core/error.hpp"
#include "posefusion/io/images.hpp"
#include "progress.hpp"
#include "simulate_bag.hpp"
#include "simulator/contact_sheet.hpp"
#include "simulator/output.hpp"
#include "simulator/scenario.hpp"
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
  ScenarioChanges changes;
};

void addOptions(CLI::App& app, Options& o) {
  app.add_option("scenario", o.scenario, "name (see --list) or scene file (.yaml)");
  app.add_option("-o,--output", o.output, "new TUM folder, or a new bag when it ends in .bag");
  app.add_option("--seed", o.changes.seed, "everything random; same seed, same bytes");
  app.add_option("--duration", o.changes.duration_s, "seconds")->check(CLI::PositiveNumber);
  app.add_option("--start", o.changes.start_s, "begin so many seconds into the scenario")
      ->check(CLI::NonNegativeNumber);
  app.add_option("--set", o.changes.assignments, "KEY=VALUE: any value of the scene file")
      ->allow_extra_args(false);
  app.add_option("--contact-sheet", o.sheet, "PNG with frames spread over the duration");
  app.add_option("--sheet-frames", o.sheet_frames, "frames of the contact sheet")
      ->check(CLI::Range(1, 200));
  app.add_option("--sheet-width", o.sheet_width, "width of a picture of it")
      ->check(CLI::Range(40, 2000));
  app.add_flag("--list", o.list, "names of the scenarios");
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

int record(Simulation& simulation, const Options& o) {
  const bool bag = std::filesystem::path(o.output).extension() == ".bag";
  const auto output = bag ? openBagOutput(o.output) : openTumOutput(o.output, simulation);
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
  if (options.scenario.empty()) throw CLI::RequiredError("scenario");
  if (options.output.empty() && options.sheet.empty()) {
    throw CLI::RequiredError("--output or --contact-sheet");
  }
  Simulation simulation(loadScenario(options.scenario, options.changes));
  if (!options.sheet.empty()) makeSheet(simulation, options);
  return options.output.empty() ? 0 : record(simulation, options);
}

}  // namespace

int main(int argc, char** argv) {
  CLI::App app{
      "Makes a recording of a simulated room: colour, depth, and the truth of camera and people.",
      "posefusion_simulate"};
  Options options;
  addOptions(app, options);
  return runTool(app, argc, argv, [&] { return simulate(options); });
}
