// SPDX-License-Identifier: BSD-3-Clause
// posefusion_map from the command line.
#include <gtest/gtest.h>
#include <sqlite3.h>

#include <filesystem>
#include <opencv2/imgcodecs.hpp>

#include "calibration_room.hpp"
#include "example_map.hpp"
#include "posefusion/io/calibration_file.hpp"
#include "posefusion/io/files.hpp"
#include "posefusion/io/map_file.hpp"
#include "posefusion/io/trajectory_file.hpp"
#include "program.hpp"
#include "temporary_folder.hpp"

namespace pf {
namespace {

namespace fs = std::filesystem;

class MapToolTest : public testing::Test {
 protected:
  MapToolTest() {
    MapWriter(file, MapWriter::Mode::create).write(example.update);
    before = readFile(file);
  }
  ~MapToolTest() override { EXPECT_TRUE(readFile(file) == before); }

  int run(std::vector<std::string> arguments) {
    const Program program("posefusion_map", std::move(arguments), folder / "log.txt");
    const int code = program.exitCode();
    said = program.said();
    return code;
  }

  bool hasSaid(const std::string& text) const { return said.find(text) != std::string::npos; }

  const TemporaryFolder folder;
  const ExampleMap example;
  const std::string file = folder / "map.pfdb";
  std::string before, said;
};

TEST_F(MapToolTest, InfoListsWhatIsInTheFile) {
  EXPECT_EQ(run({"info", file}), 0) << said;
  EXPECT_TRUE(hasSaid("camera       32 x 24, fx 26.00")) << said;
  EXPECT_TRUE(hasSaid("frames       10 with a pose, 10 fused")) << said;
  EXPECT_TRUE(hasSaid("surfels      4000 in")) << said;
  EXPECT_TRUE(hasSaid("keyframes    2 in 1 fragments, 0 retired, 2 with images")) << said;
  EXPECT_TRUE(hasSaid("constraints  2, of them 1 loops")) << said;
  EXPECT_TRUE(hasSaid("blobs        2, 3 bytes")) << said;
}

TEST_F(MapToolTest, CheckReadsItAll) {
  EXPECT_EQ(run({"check", file}), 0) << said;
  EXPECT_TRUE(hasSaid("whole: 4000 surfels, 2 keyframes, 10 frames")) << said;
  const std::string cut = folder.write("cut.pfdb", before.substr(0, before.size() / 2));
  EXPECT_EQ(run({"check", cut}), 1);
  EXPECT_TRUE(hasSaid("posefusion_map: " + cut + ": is damaged")) << said;
}

TEST_F(MapToolTest, CheckReportsWhatAnUnfinishedMapMisses) {
  const std::string copy = folder.write("copy.pfdb", before);
  sqlite3* database = nullptr;
  ASSERT_EQ(sqlite3_open(copy.c_str(), &database), SQLITE_OK);
  sqlite3_exec(database, "DELETE FROM blobs WHERE name = 'closed'", nullptr, nullptr, nullptr);
  sqlite3_close(database);
  std::string open = readFile(copy);
  open[18] = open[19] = 2;  // as its writer leaves it until it is closed
  folder.write("copy.pfdb", open);
  EXPECT_EQ(run({"check", copy}), 1);
  EXPECT_TRUE(hasSaid("was not closed by its writer, and its log " + copy + "-wal is not there"))
      << said;
  EXPECT_TRUE(hasSaid("there are 10 frames, 2 keyframes and 4000 surfels")) << said;
}

TEST_F(MapToolTest, RepairMendsInACopy) {
  std::string damaged = before;
  damaged[damaged.size() / 2] ^= 4;
  const std::string bad = folder.write("bad.pfdb", damaged), good = folder / "good.pfdb";
  EXPECT_EQ(run({"repair", bad, "--output", good}), 0) << said;
  EXPECT_TRUE(hasSaid("lost: ") || hasSaid("nothing is lost")) << said;
  EXPECT_EQ(run({"check", good}), 0) << said;
  EXPECT_TRUE(readFile(bad) == damaged);
  EXPECT_EQ(run({"repair", bad, "--output", good}), 1);
  EXPECT_TRUE(hasSaid("good.pfdb: is there already")) << said;
}

TEST_F(MapToolTest, ExportWritesWhatOthersRead) {
  const std::string out = folder / "out";
  EXPECT_EQ(run({"export", file, "--output", out}), 0) << said;
  EXPECT_EQ(loadMap(out + "/map.ply").size(), 4000U);
  const Trajectory trajectory = loadTrajectory(out + "/trajectory.txt");
  ASSERT_EQ(trajectory.size(), 10U);
  const Eigen::Isometry3d expected =
      example.update.keyframes[1].T_map_camera * example.update.frames[7].pose.T_keyframe_camera;
  EXPECT_TRUE(trajectory[7].T_world_camera.isApprox(bodyFromOptical() * expected, 1e-6));
  EXPECT_EQ(cv::imread(out + "/plan.png").cols, 1200);
  EXPECT_EQ(std::distance(fs::directory_iterator(out + "/keyframes"), fs::directory_iterator{}), 4);
  const cv::Mat depth =
      cv::imread(out + "/keyframes/1000.000000001_depth.png", cv::IMREAD_UNCHANGED);
  ASSERT_EQ(depth.type(), CV_16UC1);
  EXPECT_EQ(depth.at<std::uint16_t>(3, 4), 2001);
}

TEST_F(MapToolTest, TheCalibrationOfAMapIsPrintedAndExported) {
  EXPECT_EQ(run({"info", file}), 0) << said;
  EXPECT_TRUE(hasSaid("calibration  none")) << said;
  const std::string yaml = folder / "calibration.yaml", picture = folder / "field.png";
  EXPECT_EQ(run({"calibration", file, "-o", yaml}), 1);
  EXPECT_TRUE(hasSaid(file + ": has no calibration")) << said;
  EXPECT_FALSE(fs::exists(yaml));

  const DepthCalibration known = {
      "seven", test::roomCamera(640), test::roomField(), 123, 1500, 7.25, 5.5, 0.0004};
  MapUpdate update = example.update;
  update.blobs["calibration"] = calibrationText(known);
  const std::string corrected = folder / "corrected.pfdb";
  MapWriter(corrected, MapWriter::Mode::create).write(update);
  EXPECT_EQ(run({"info", corrected}), 0) << said;
  char rms[80];
  std::snprintf(rms, sizeof rms, "camera seven, RMS %.1f mm at 2 m, %.1f mm at 4 m",
                4000 * known.field.rms(), 16000 * known.field.rms());
  EXPECT_TRUE(hasSaid(rms)) << said;
  EXPECT_TRUE(hasSaid("of 123 keyframes, 1500 pairs: kept-out residual 7.25 to 5.50 mm")) << said;
  EXPECT_EQ(run({"calibration", corrected, "-o", yaml, "--picture", picture}), 0) << said;
  EXPECT_EQ(readFile(yaml), calibrationText(known));
  EXPECT_FALSE(cv::imread(picture).empty());

  update.blobs["calibration"] = "nonsense";
  const std::string bad = folder / "bad.pfdb";
  MapWriter(bad, MapWriter::Mode::create).write(update);
  for (const auto& arguments : {std::vector<std::string>{"calibration", bad, "-o", folder / "x"},
                                std::vector<std::string>{"info", bad}}) {
    EXPECT_EQ(run(arguments), 1);
    EXPECT_TRUE(hasSaid(bad + ": its calibration of depth")) << said;
  }
}

TEST_F(MapToolTest, WrongUseIsReportedAndChangesNothing) {
  EXPECT_NE(run({}), 0);
  EXPECT_NE(run({"export", file}), 0);
  EXPECT_TRUE(hasSaid("--output")) << said;
  EXPECT_EQ(run({"info", folder / "none.pfdb"}), 1);
  EXPECT_TRUE(hasSaid("none.pfdb: cannot be opened")) << said;
  EXPECT_EQ(run({"info", folder.write("x.ply", "ply\n")}), 1);
  EXPECT_TRUE(hasSaid("x.ply: is no map of posefusion")) << said;
}

}  // namespace
}  // namespace pf
