// SPDX-License-Identifier: BSD-3-Clause
// Map files that become one, as a user of the program names them.
#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>

#include "posefusion/config/yaml_map.hpp"
#include "posefusion/io/files.hpp"
#include "posefusion/io/saved_map_file.hpp"
#include "program.hpp"
#include "simulated_sequence.hpp"
#include "temporary_folder.hpp"

namespace pf {
namespace {

namespace fs = std::filesystem;
constexpr int kFrames = 60;

const SimulatedSequence& room() { return exactBox<kFrames>(); }

void save(const SimulatedSequence& seen, int begin, int end, const Config& config,
          const std::string& path) {
  Mapper mapper(config);
  for (int i = begin; i < end; ++i) mapper.process({seen.frame(i).frame, {}, {}});
  MapRecording recording(path, MapWriter::Mode::create, toYaml(config), mapper);
  recording.update(seen.frame(0).frame.camera, mapper);
  ASSERT_TRUE(recording.finish(mapper));
}

class MapMergeTool : public testing::Test {
 protected:
  static void SetUpTestSuite() {
    folder_ = new TemporaryFolder;
    save(room(), 0, 45, config(), first());
    save(room(), 15, kFrames, config(), second());
  }
  static void TearDownTestSuite() { delete folder_; }

  static Config config() {
    Config c;
    c.frame.shrink = 1;                  // the images are small already
    c.graph.keyframe_distance_m = 0.05;  // so that there are some
    c.graph.keyframe_angle_rad = 0.05;
    return c;
  }
  static std::string first() { return *folder_ / "first.pfdb"; }
  static std::string second() { return *folder_ / "second.pfdb"; }
  std::string output() const { return own / "both.pfdb"; }

  int run(const std::vector<std::string>& arguments) {
    const Program program("posefusion_map", arguments, *folder_ / "log.txt");
    const int code = program.exitCode();
    said = program.said();
    return code;
  }
  int merge(const std::string& a, const std::string& b) {
    return run({"merge", a, b, "-o", output()});
  }
  /// A map beside the first.
  static std::string beside(const std::string& name) { return *folder_ / (name + ".pfdb"); }
  bool hasSaid(const std::string& text) const { return said.find(text) != std::string::npos; }
  bool isNothingWritten() const { return fs::is_empty(own.str()); }

  TemporaryFolder own;
  std::string said;

 private:
  inline static TemporaryFolder* folder_ = nullptr;
};

TEST_F(MapMergeTool, TwoFilesBecomeOneAndStayAsTheyAre) {
  const std::string before[] = {readFile(first()), readFile(second())};
  ASSERT_EQ(run({"merge", first(), second(), "--output", output()}), 0) << said;
  EXPECT_TRUE(hasSaid(output() + ": merged: ")) << said;
  EXPECT_TRUE(readFile(first()) == before[0] && readFile(second()) == before[1]);
  EXPECT_EQ(std::distance(fs::directory_iterator(own.str()), fs::directory_iterator{}), 1)
      << "nothing is left beside it";
  ASSERT_EQ(run({"check", output()}), 0) << said;
  const SavedMap a = readSavedMap(first()), b = readSavedMap(second());
  const SavedMap both = readSavedMap(output());
  EXPECT_EQ(both.frames.size(), a.frames.size() + b.frames.size());
  EXPECT_EQ(both.keyframes.size(), a.keyframes.size() + b.keyframes.size());
  EXPECT_EQ(both.views.size(), a.views.size() + b.views.size());
  EXPECT_GT(both.constraints.size(), a.constraints.size() + b.constraints.size());
  EXPECT_LE(surfelsIn(both.surfels), surfelsIn(a.surfels) + surfelsIn(b.surfels));
  EXPECT_EQ(toYaml(settingsOf(MapReader(output()).content(), output())), toYaml(config()));
  Mapper mapper(config());
  mapper.load(both, MapUse::extend);
  EXPECT_EQ(mapper.map().size(), surfelsIn(both.surfels));
}

TEST_F(MapMergeTool, WhatIsThereIsNotWrittenOver) {
  const std::string before = readFile(first());
  EXPECT_EQ(run({"merge", first(), second(), "-o", first()}), 1);
  EXPECT_TRUE(hasSaid(first() + ": is there already")) << said;
  EXPECT_TRUE(readFile(first()) == before);
  // What the new map is called until it is whole may be the name of one of the two.
  const std::string part = output() + ".part";
  fs::copy(second(), part);
  EXPECT_EQ(merge(first(), part), 1);
  EXPECT_TRUE(hasSaid(part)) << said;
  EXPECT_TRUE(readFile(part) == readFile(second()));
}

TEST_F(MapMergeTool, WhatCannotBeReadIsNamed) {
  const std::string bytes = readFile(second());
  const std::string bad = beside("bad");
  std::ofstream(bad, std::ios::binary) << bytes.substr(0, bytes.size() / 2);
  for (const auto& [a, b] : {std::pair{first(), bad}, std::pair{bad, first()}}) {
    EXPECT_EQ(merge(a, b), 1);
    EXPECT_TRUE(hasSaid(bad + ": ")) << said;
    EXPECT_TRUE(isNothingWritten());
  }
  EXPECT_EQ(merge(first(), "none.pfdb"), 1);
  EXPECT_TRUE(hasSaid("none.pfdb: cannot be opened")) << said;
  EXPECT_NE(run({"merge", first(), "-o", output()}), 0);
  EXPECT_TRUE(isNothingWritten());
}

TEST_F(MapMergeTool, OtherRoomsAreRefusedByTheNamesOfBoth) {
  const std::string other = beside("other");
  save(SimulatedSequence(
           "empty_box", 12,
           {"depth.distortion=0", "camera.at_m=[3.2,1.6,1.35]", "camera.look_at_m=[0.2,1.2,1.2]"}),
       0, 12, config(), other);
  EXPECT_EQ(merge(first(), other), 1);
  EXPECT_TRUE(hasSaid(other + " does not become one with " + first() + ": ")) << said;
  EXPECT_TRUE(isNothingWritten());
}

TEST_F(MapMergeTool, DepthCamerasOfOtherKindsAreRefused) {
  Config time_of_flight = config();
  time_of_flight.sensor.kind = "time_of_flight";
  const std::string other = beside("tof");
  save(room(), 0, 10, time_of_flight, other);
  EXPECT_EQ(merge(first(), other), 1);
  EXPECT_TRUE(hasSaid(other + ": is of a depth camera of another kind")) << said;
  EXPECT_TRUE(isNothingWritten());
}

}  // namespace
}  // namespace pf
