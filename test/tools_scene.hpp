// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <gtest/gtest.h>

#include <algorithm>
#include <chrono>
#include <filesystem>
#include <nlohmann/json.hpp>
#include <string>
#include <thread>
#include <vector>

#include "posefusion/core/stamps.hpp"
#include "posefusion/io/files.hpp"
#include "program.hpp"
#include "simulator/output.hpp"
#include "simulator/scenario.hpp"
#include "simulator/simulation.hpp"
#include "temporary_folder.hpp"

namespace pf {

inline std::vector<std::filesystem::path> filesIn(const std::string& folder) {
  std::vector<std::filesystem::path> files(std::filesystem::directory_iterator(folder),
                                           std::filesystem::directory_iterator{});
  std::sort(files.begin(), files.end());
  return files;
}

/// The programs on a short simulated recording.
class ToolsTest : public testing::Test {
 protected:
  static constexpr int kFrames = 12;

  static void SetUpTestSuite() {
    folder_ = new TemporaryFolder;
    simulator::ScenarioChanges changes;
    changes.duration_s = kFrames / 30.0;
    simulator::Simulation simulation(simulator::loadScenario("box_walker", changes));
    const auto output = simulator::openTumOutput(*folder_ / "sequence", simulation);
    for (int i = 0; i < kFrames; ++i) output->add(simulation.frame(i));
    output->finish(simulation);
  }
  static void TearDownTestSuite() { delete folder_; }

  /// A copy of the sequence that a test may damage.
  std::string copy(const std::string& name) const {
    std::filesystem::copy(sequence(), own / name, std::filesystem::copy_options::recursive);
    return own / name;
  }
  /// The same frames over and over: enough for minutes.
  std::string longSequence() const {
    const std::string input = copy("long");
    const auto images = filesIn(input + "/rgb");
    std::string list;
    for (int i = 0; i < 20000; ++i) {
      const std::string name = formatStamp(1'000'000'000LL + i * 33'000'000LL);
      // There and back, so that the camera never jumps.
      const int phase = i % (2 * kFrames - 2);
      const int at = phase < kFrames ? phase : 2 * kFrames - 2 - phase;
      const std::string image = images[static_cast<std::size_t>(at)].filename().string();
      list += name + " rgb/" + image + " " + name + " depth/" + image + "\n";
    }
    own.write("long/associations.txt", list);
    return input;
  }
  static std::string sequence() { return *folder_ / "sequence"; }

  int run(std::vector<std::string> arguments, const std::string& name = "posefusion_run") {
    const Program program(name, std::move(arguments), own / "log.txt");
    const int code = program.exitCode();
    said = program.said();
    return code;
  }
  bool hasSaid(const std::string& text) const { return said.find(text) != std::string::npos; }

  /// `output`: as named to the program.
  static nlohmann::json summaryOf(const std::string& output) {
    return nlohmann::json::parse(readFile(output + "/latest/summary.json"));
  }

  /// The folder of a run that is not finished; empty where there is none (yet).
  static std::string partialFolder(const std::string& output) {
    if (!std::filesystem::is_directory(output)) return {};
    for (const auto& path : filesIn(output)) {
      if (path.extension() == ".partial") return path.string();
    }
    return {};
  }

  /// Waits until `done` or, which fails, for half a minute.
  template <typename Done>
  static void waitUntil(const Done& done) {
    for (int i = 0; i < 600; ++i) {
      if (done()) return;
      std::this_thread::sleep_for(std::chrono::milliseconds(50));
    }
    FAIL() << "waited in vain";
  }

  TemporaryFolder own;
  std::string said;

 private:
  inline static TemporaryFolder* folder_ = nullptr;
};

}  // namespace pf
