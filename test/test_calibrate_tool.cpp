// SPDX-License-Identifier: BSD-3-Clause
// posefusion_calibrate from the command line.
#include <gtest/gtest.h>

#include <filesystem>
#include <opencv2/imgcodecs.hpp>

#include "calibration_room.hpp"
#include "posefusion/io/calibration_file.hpp"
#include "posefusion/io/files.hpp"
#include "posefusion/io/map_database.hpp"
#include "program.hpp"
#include "temporary_folder.hpp"

namespace pf {
namespace {

class CalibrateToolTest : public testing::Test {
 protected:
  /// A map file without surfels: keyframes at half the size of the frames.
  std::string mapOf(int count, const DepthField& field) {
    test::RoomView like;
    like.field = field;
    MapUpdate update;
    update.camera = test::roomCamera(320);
    update.frame = count - 1;
    for (const CalibrationView& view : test::roomViews(count, like)) {
      Keyframe keyframe;
      keyframe.id = view.id;
      keyframe.map_frame = view.id;
      keyframe.stamp_ns = view.id + 1;
      keyframe.T_map_camera = view.T_map_camera;
      update.keyframes.push_back(keyframe);
      update.images.push_back(
          {view.id, cv::Mat(view.depth_mm.size(), CV_8UC1, cv::Scalar(90)), view.depth_mm});
    }
    const std::string file = folder / ("map" + std::to_string(count) + ".pfdb");
    std::filesystem::remove(file);
    MapWriter(file, MapWriter::Mode::create).write(update);
    return file;
  }

  int run(std::vector<std::string> arguments) {
    const Program program("posefusion_calibrate", std::move(arguments), folder / "log.txt");
    const int code = program.exitCode();
    said = program.said();
    return code;
  }

  bool hasSaid(const std::string& text) const { return said.find(text) != std::string::npos; }

  const TemporaryFolder folder;
  const std::string file = folder / "calibration.yaml";
  std::string said;
};

TEST_F(CalibrateToolTest, WritesTheFieldOfTheCameraThatMadeTheMap) {
  saveCalibration(folder / "depth_field.yaml", {"truth", test::roomCamera(320), test::roomField()});
  const std::string map = mapOf(60, test::roomField());
  ASSERT_EQ(run({map, "-o", file, "--name", "seven", "--picture", folder / "field.png", "--truth",
                 folder.str()}),
            0)
      << said;
  EXPECT_TRUE(hasSaid("keyframes    60, ")) << said;
  EXPECT_TRUE(hasSaid("correlation ")) << said;
  const DepthCalibration calibration = loadCalibration(file);
  EXPECT_EQ(calibration.name, "seven");
  EXPECT_EQ(calibration.camera, test::roomCamera(320));
  EXPECT_LT(calibration.after_mm, calibration.before_mm);
  EXPECT_GT(compare(calibration.field, test::roomField()).correlation, 0.95);
  EXPECT_FALSE(cv::imread(folder / "field.png").empty());
  const std::string before = readFile(file);
  ASSERT_EQ(run({map, "-o", file, "--name", "seven"}), 0) << said;
  EXPECT_EQ(readFile(file), before) << "the same bytes";
}

TEST_F(CalibrateToolTest, RefusesWithAReason) {
  EXPECT_EQ(run({mapOf(3, test::roomField()), "-o", file}), 1);
  EXPECT_TRUE(hasSaid("of 3 keyframes")) << said;
  EXPECT_EQ(run({mapOf(60, DepthField()), "-o", file}), 1);
  EXPECT_TRUE(hasSaid("do not agree better")) << said;
  EXPECT_FALSE(std::filesystem::exists(file));
  EXPECT_EQ(run({folder / "missing.pfdb", "-o", file}), 1);
  EXPECT_TRUE(hasSaid("missing.pfdb")) << said;
  EXPECT_EQ(run({folder / "missing.pfdb"}), 106) << "no --output: " << said;
}

}  // namespace
}  // namespace pf
