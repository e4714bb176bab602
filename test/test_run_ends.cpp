// SPDX-License-Identifier: BSD-3-Clause
// How runs end, in order and not, and what is left of them.
#include <algorithm>
#include <csignal>

#include "posefusion/io/images.hpp"
#include "posefusion/io/map_file.hpp"
#include "posefusion/io/trajectory_file.hpp"
#include "tools_scene.hpp"

namespace pf {
namespace {

namespace fs = std::filesystem;

TEST_F(ToolsTest, CtrlCEndsItInOrderWithEverythingWritten) {
  const std::string input = longSequence();
  for (const int signal : {SIGINT, SIGTERM, SIGHUP}) {
    const std::string output = own / ("out" + std::to_string(signal));
    const Program program("posefusion_run",
                          {input, "--detector", "none", "--output", output, "--save-masks"},
                          own / "log.txt");
    // Once some masks are there, frames are being processed.
    waitUntil([&] {
      const std::string masks = partialFolder(output) + "/mask";
      return fs::is_directory(masks) && filesIn(masks).size() > 5;
    });
    program.send(signal);
    EXPECT_EQ(program.exitCode(), 128 + signal);
    EXPECT_NE(program.said().find("interrupted"), std::string::npos) << program.said();
    const auto frames = summaryOf(output).at("frames");
    EXPECT_GT(frames.at("tracked").get<int>(), 3);
    EXPECT_LT(frames.at("read").get<int>(), 20000);
    EXPECT_EQ(loadTrajectory(output + "/latest/trajectory.txt").size(), frames.at("tracked"));
    EXPECT_NO_THROW(loadMap(output + "/latest/map.ply"));
    EXPECT_TRUE(fs::exists(output + "/latest/people.png"));
    EXPECT_TRUE(fs::exists(output + "/latest/people.json"));
  }
}

TEST_F(ToolsTest, AKilledRunLeavesTheTrajectorySoFarAndAFinishedOneOnlyTheWholeOne) {
  const std::string output = own / "out";
  const auto journal = [&] { return partialFolder(output) + "/trajectory.partial.txt"; };
  const Program program("posefusion_run",
                        {longSequence(), "--detector", "none", "--output", output},
                        own / "log.txt");
  waitUntil([&] {
    const std::string text = fs::exists(journal()) ? readFile(journal()) : "";
    return std::count(text.begin(), text.end(), '\n') >= 10;
  });
  program.send(SIGKILL);
  EXPECT_EQ(program.exitCode(), -SIGKILL);
  EXPECT_GE(loadTrajectory(journal()).size(), 8U);
  EXPECT_FALSE(fs::exists(output + "/latest")) << "it is no result";
  ASSERT_EQ(run({sequence(), "--detector", "none", "--output", output}), 0) << said;
  EXPECT_TRUE(fs::exists(output + "/latest/trajectory.txt"));
  EXPECT_FALSE(fs::exists(output + "/latest/trajectory.partial.txt"));
  EXPECT_GE(loadTrajectory(journal()).size(), 8U) << "what the killed run left stays";
}

TEST_F(ToolsTest, NoRunWritesOverTheResultsOfAnother) {
  const std::string output = own / "out";
  const std::vector<std::string> twelve = {sequence(), "--detector", "none", "--output", output};
  ASSERT_EQ(run(twelve), 0) << said;
  const std::string first = fs::canonical(output + "/latest");
  const std::string trajectory = readFile(first + "/trajectory.txt");
  // Two at once.
  const Program second("posefusion_run", twelve, own / "second.txt");
  const Program third("posefusion_run", twelve, own / "third.txt");
  EXPECT_EQ(second.exitCode(), 0) << second.said();
  EXPECT_EQ(third.exitCode(), 0) << third.said();
  // One that fails after it has begun.
  fs::remove_all(copy("cut") + "/rgb");
  EXPECT_EQ(run({own / "cut", "--detector", "none", "--output", output}), 1);
  int whole = 0;
  for (const auto& path : filesIn(output)) {
    if (fs::is_symlink(path)) continue;
    const fs::path map = path / "map.pfdb";
    if (!fs::exists(map)) continue;
    ++whole;
    EXPECT_EQ(readFile(path / "trajectory.txt"), trajectory) << path;
    EXPECT_EQ(run({"check", map.string()}, "posefusion_map"), 0) << said;
  }
  EXPECT_EQ(whole, 3);
  EXPECT_EQ(partialFolder(output), "");
  EXPECT_EQ(readFile(output + "/latest/trajectory.txt"), trajectory) << "not of the failed run";
}

TEST_F(ToolsTest, ARunWithoutAPoseFails) {
  const std::string input = copy("black");
  for (const auto& depth : filesIn(input + "/depth")) {
    savePng(depth, cv::Mat::zeros(240, 320, CV_16UC1));
  }
  EXPECT_EQ(run({input, "--detector", "none", "--output", own / "out"}), 1);
  EXPECT_TRUE(hasSaid(input + ": no frame has a pose: 12 read, 12 no_depth")) << said;
  EXPECT_FALSE(fs::exists(own / "out/latest"));
}

}  // namespace
}  // namespace pf
