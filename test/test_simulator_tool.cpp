// SPDX-License-Identifier: BSD-3-Clause
// posefusion_simulate as a user runs it: stopped, short of space, with bad outputs.
#include <gtest/gtest.h>
#include <sys/resource.h>

#include <algorithm>
#include <chrono>
#include <csignal>
#include <filesystem>
#include <nlohmann/json.hpp>
#include <thread>

#include "posefusion/io/frame_source.hpp"
#include "posefusion_ros/bag_source.hpp"
#include "program.hpp"
#include "simulator_scene.hpp"

namespace pf {
namespace {

namespace fs = std::filesystem;

/// Minutes in an empty room with a fall near the beginning and one much later.
constexpr char kScene[] = R"(
duration_s: 400
rooms: [{size_m: [6, 6, 2.6], lamps: [1, 1]}]
camera:
  motion: robot
  waypoints: [[1, 1], [5, 1], [5, 5], [1, 5]]
  width: 64
  falls: [{at_s: 0.3, skip_m: 0.2}, {at_s: 300}]
)";

class SimulatorToolTest : public testing::Test {
 protected:
  std::string scene() const { return own.write("scene.yaml", kScene); }
  std::string log() const { return own / "log.txt"; }

  int run(std::vector<std::string> arguments) {
    const Program program("posefusion_simulate", std::move(arguments), log());
    const int code = program.exitCode();
    said = program.said();
    return code;
  }
  bool hasSaid(const std::string& text) const { return said.find(text) != std::string::npos; }

  /// Starts a recording, and stops it when some frames are made.
  int runAndStop(const std::string& output, int signal) {
    const Program program("posefusion_simulate", {scene(), "--output", output}, log());
    for (int i = 0; i < 1200; ++i) {
      std::this_thread::sleep_for(std::chrono::milliseconds(50));
      // Progress is told every five seconds: frames are made by then.
      if (program.said().find("frames per second") != std::string::npos) break;
    }
    program.send(signal);
    const int code = program.exitCode();
    said = program.said();
    return code;
  }

  /// The truth covers the frames read back, and not much more.
  static void expectTruthOfTheFrames(FrameSource& source) {
    const Trajectory truth = source.truth();
    ASSERT_FALSE(truth.empty());
    std::int64_t first = 0, last = 0;
    while (const auto frame = source.next()) {
      if (first == 0) first = frame->frame.stamp_ns;
      last = frame->frame.stamp_ns;
    }
    EXPECT_LE(truth.front().stamp_ns, first);
    EXPECT_GE(truth.front().stamp_ns, first - 100'000'000);
    EXPECT_GE(truth.back().stamp_ns, last + 33'000'000);  // the depth comes after the colour
    EXPECT_LE(truth.back().stamp_ns, last + 300'000'000);
  }

  /// Nothing but these is in the folder.
  std::vector<std::string> files() const {
    std::vector<std::string> names;
    for (const auto& entry : fs::directory_iterator(own.str())) {
      names.push_back(entry.path().filename());
    }
    std::sort(names.begin(), names.end());
    return names;
  }

  TemporaryFolder own;
  std::string said;
};

TEST_F(SimulatorToolTest, AStoppedFolderHasTheTruthOfItsFrames) {
  EXPECT_EQ(runAndStop(own / "out", SIGINT), 130) << said;
  EXPECT_TRUE(hasSaid("frames are in " + own / "out")) << said;
  const auto source = openTumFolder(own / "out");
  ASSERT_GT(source->frameCount(), 5U);
  expectTruthOfTheFrames(*source);
  const auto events = nlohmann::json::parse(readFile(own / "out/events.json")).at("events");
  int falls = 0;
  for (const auto& event : events) falls += event.at("kind") == "fall" ? 1 : 0;
  EXPECT_EQ(falls, 1);
}

TEST_F(SimulatorToolTest, AStoppedBagIsWholeAndHasTheTruthOfItsFrames) {
  EXPECT_EQ(runAndStop(own / "out.bag", SIGTERM), 143) << said;
  EXPECT_EQ(files(), (std::vector<std::string>{"log.txt", "out.bag", "scene.yaml"}));
  const auto source = posefusion_ros::openBag(own / "out.bag");
  ASSERT_GT(source->frameCount(), 5U);
  expectTruthOfTheFrames(*source);
}

TEST_F(SimulatorToolTest, AFullDiskLeavesNoPartOfABag) {
  const auto before = std::signal(SIGXFSZ, SIG_IGN);
  rlimit limit{};
  getrlimit(RLIMIT_FSIZE, &limit);
  const rlimit small{300'000, limit.rlim_max};
  setrlimit(RLIMIT_FSIZE, &small);
  const int code = run({scene(), "--output", own / "out.bag", "--duration", "20"});
  setrlimit(RLIMIT_FSIZE, &limit);
  std::signal(SIGXFSZ, before);
  EXPECT_EQ(code, 1) << said;
  EXPECT_TRUE(hasSaid("out.bag: cannot be written")) << said;
  EXPECT_EQ(files(), (std::vector<std::string>{"log.txt", "scene.yaml"}));
}

TEST_F(SimulatorToolTest, OutputsThatCannotBeAreRefusedByName) {
  own.write("file", "");
  own.write("old.bag", "old");
  const std::vector<std::string> here = {scene(), "--duration", "0.1", "--output"};
  const auto with = [&](const std::string& output) {
    auto arguments = here;
    arguments.push_back(own / output);
    return arguments;
  };
  EXPECT_EQ(run(with("file")), 1);
  EXPECT_TRUE(hasSaid("file: is there")) << said;
  EXPECT_EQ(run(with("file/out")), 1);
  EXPECT_TRUE(hasSaid("file/out/rgb: the folder cannot be made")) << said;
  EXPECT_EQ(run(with("old.bag")), 1);
  EXPECT_TRUE(hasSaid("old.bag: is there, expected a new bag")) << said;
  EXPECT_EQ(readFile(own / "old.bag"), "old");
  EXPECT_EQ(run(with("nowhere/out.bag")), 1);
  EXPECT_TRUE(hasSaid("nowhere/out.bag: cannot be written")) << said;
}

}  // namespace
}  // namespace pf
