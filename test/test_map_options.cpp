// SPDX-License-Identifier: BSD-3-Clause
// Maps of before, as a user of the program names them.
#include <gtest/gtest.h>

#include <csignal>
#include <filesystem>
#include <thread>

#include "posefusion/core/stamps.hpp"
#include "posefusion/io/files.hpp"
#include "posefusion/io/saved_map_file.hpp"
#include "program.hpp"
#include "simulator/output.hpp"
#include "simulator/scenario.hpp"
#include "simulator/simulation.hpp"
#include "temporary_folder.hpp"

namespace pf {
namespace {

namespace fs = std::filesystem;

class MapOptions : public testing::Test {
 protected:
  static void SetUpTestSuite() {
    folder_ = new TemporaryFolder;
    simulator::ScenarioChanges changes;
    changes.duration_s = 1.0;
    simulator::Simulation simulation(simulator::loadScenario("box_walker", changes));
    const auto output = simulator::openTumOutput(*folder_ / "sequence", simulation);
    for (int i = 0; i < simulation.frameCount(); ++i) output->add(simulation.frame(i));
    output->finish(simulation);
  }
  static void TearDownTestSuite() { delete folder_; }

  static std::string sequence() { return *folder_ / "sequence"; }
  std::vector<std::string> with(std::vector<std::string> more) const {
    more.insert(more.begin(), {sequence(), "--detector", "recorded", "--set", "frame.shrink=1"});
    return more;
  }
  int run(const std::vector<std::string>& arguments, const std::string& name = "posefusion_run") {
    const Program program(name, arguments, own / "log.txt");
    const int code = program.exitCode();
    said = program.said();
    return code;
  }

  TemporaryFolder own;
  std::string said;

 private:
  static TemporaryFolder* folder_;
};
TemporaryFolder* MapOptions::folder_ = nullptr;

TEST_F(MapOptions, ARunGoesOnInTheMapOfAnother) {
  const std::string out = own / "out/latest", map = out + "/map.pfdb";
  ASSERT_EQ(run(with({"--output", own / "out"})), 0) << said;
  ASSERT_EQ(run({"check", map}, "posefusion_map"), 0) << said;
  EXPECT_FALSE(fs::exists(out + "/map.partial.pfdb"));
  const std::string before = readFile(map);
  const std::size_t frames = readSavedMap(map).frames.size();

  ASSERT_EQ(run(with({"--output", own / "l", "--map", map, "--localize-only"})), 0) << said;
  EXPECT_TRUE(readFile(map) == before);
  EXPECT_FALSE(fs::exists(own / "l/latest/map.pfdb"));
  EXPECT_NE(said.find("0 bad"), std::string::npos) << said;
  const std::string summary = readFile(own / "l/latest/summary.json");
  EXPECT_NE(summary.find("\"located\""), std::string::npos) << summary;
  EXPECT_EQ(summary.find("\"fused\""), std::string::npos) << "nothing is taken into the map";
  EXPECT_NE(said.find("ATE"), std::string::npos) << said;

  ASSERT_EQ(run(with({"--output", own / "m", "--map", map})), 0) << said;
  EXPECT_TRUE(readFile(map) == before);
  EXPECT_GT(readSavedMap(own / "m/latest/map.pfdb").frames.size(), frames);

  ASSERT_EQ(run(with({"--output", own / "c", "--map", map, "--continue"})), 0) << said;
  EXPECT_FALSE(fs::exists(own / "c/latest/map.pfdb"));
  EXPECT_EQ(readSavedMap(map).frames.size(), readSavedMap(own / "m/latest/map.pfdb").frames.size());
  EXPECT_EQ(surfelsIn(readSavedMap(map).surfels),
            surfelsIn(readSavedMap(own / "m/latest/map.pfdb").surfels));
  EXPECT_TRUE(readFile(own / "c/latest/map.ply") == readFile(own / "m/latest/map.ply"));
}

TEST_F(MapOptions, AKilledRunLeavesAWholeMap) {
  const std::string out = own / "out";
  // The same frames over and over: enough for minutes.
  const std::string input = own / "long";
  fs::copy(sequence(), input, fs::copy_options::recursive);
  const auto first = [&](const std::string& kind) {
    return kind + "/" + fs::directory_iterator(input + "/" + kind)->path().filename().string();
  };
  const std::string color = first("rgb"), depth = first("depth");
  std::string list;
  for (int i = 0; i < 20000; ++i) {
    const std::string stamp = formatStamp(1'000'000'000LL + i * 33'000'000LL);
    list += stamp + " " + color + " " + stamp + " " + depth + "\n";
  }
  own.write("long/associations.txt", list);
  const Program program("posefusion_run", {input, "--detector", "none", "--output", out},
                        own / "run.txt");
  const auto partial = [&] {
    std::error_code none;
    const fs::directory_iterator run(out, none);  // empty for a moment, too
    const fs::path folder = run == fs::directory_iterator() ? fs::path() : run->path();
    return (folder / "map.partial.pfdb").string();
  };
  // SQLite's file is there before the first write, its log grows with it.
  for (int i = 0; i < 600; ++i) {
    std::error_code none;
    if (fs::file_size(partial() + "-wal", none) > 300'000 && !none) break;
    std::this_thread::sleep_for(std::chrono::milliseconds(50));
  }
  std::this_thread::sleep_for(std::chrono::milliseconds(300));
  program.send(SIGKILL);
  EXPECT_EQ(program.exitCode(), -SIGKILL) << program.said();
  ASSERT_EQ(run({"check", partial()}, "posefusion_map"), 0) << said;
  EXPECT_GT(readSavedMap(partial()).frames.size(), 0U);
}

TEST_F(MapOptions, ARunAfterAKilledContinuationHasItsOwnMap) {
  // The log of the killed one was taken into the map of the next run in that folder.
  ASSERT_EQ(run(with({"--output", own / "out"})), 0) << said;
  const std::string first = own / "out/latest/map.pfdb", kept = fs::canonical(first);
  {
    const Program program("posefusion_run",
                          with({"--output", own / "c", "--map", first, "--continue"}),
                          own / "killed.txt");
    for (int i = 0; i < 600 && !fs::exists(first + "-wal"); ++i) {
      std::this_thread::sleep_for(std::chrono::milliseconds(10));
    }
    program.send(SIGKILL);
    program.exitCode();
  }
  ASSERT_EQ(run(with({"--output", own / "out"})), 0) << said;
  EXPECT_NE(fs::canonical(first), kept);
  for (const std::string& map : {first, kept}) {
    EXPECT_EQ(run({"check", map}, "posefusion_map"), 0) << said;
  }
  EXPECT_GE(readSavedMap(kept).frames.size(), readSavedMap(first).frames.size());
}

TEST_F(MapOptions, ABadMapIsRefusedBeforeAnythingRuns) {
  const std::string out = own / "out", bad = own.write("bad.pfdb", std::string(5000, 'x'));
  EXPECT_EQ(run(with({"--output", out, "--map", bad})), 1);
  EXPECT_NE(said.find(bad + ": is no map of posefusion"), std::string::npos) << said;
  EXPECT_EQ(run(with({"--output", out, "--map", own / "none"})), 1);
  EXPECT_NE(said.find("none: cannot be opened"), std::string::npos) << said;
  EXPECT_NE(run(with({"--output", out, "--localize-only"})), 0);
  EXPECT_NE(run(with({"--output", out, "--map", bad, "--localize-only", "--continue"})), 0);
  ASSERT_EQ(run(with({"--output", own / "m", "--max-frames", "3"})), 0) << said;
  const std::string map = own / "m/latest/map.pfdb";
  const std::string camera = own.write(
      "camera.yaml",
      "width: 320\nheight: 240\nfx: 200\nfy: 200\ncx: 160\ncy: 120\ndepth_factor: 5000\n");
  EXPECT_EQ(run(with({"--output", out, "--map", map, "--camera", camera})), 1);
  EXPECT_NE(said.find(map + ": is a map of another camera"), std::string::npos) << said;
  EXPECT_FALSE(fs::exists(out));
}

}  // namespace
}  // namespace pf
