// SPDX-License-Identifier: BSD-3-Clause
#include "posefusion/io/trajectory_format.hpp"

#include <gtest/gtest.h>

#include "posefusion/core/error.hpp"
#include "temporary_folder.hpp"

namespace pf {
namespace {

class TrajectoryFormatTest : public testing::Test {
 protected:
  ReadTrajectory read(const std::string& text,
                      TrajectoryFormat format = TrajectoryFormat::automatic) {
    root.write("file", text);
    return readTrajectory(root / "file", format);
  }
  std::string error(const std::string& text,
                    TrajectoryFormat format = TrajectoryFormat::automatic) {
    return errorOf([&] { read(text, format); });
  }

  TemporaryFolder root;
};

/// The same pose, turned by 90 degrees about z, in three formats.
const char kTum[] = "# head\n2.5 1 2 3 0 0 0.70710678 0.70710678\n";
const char kKitti[] = "0 -1 0 1 1 0 0 2 0 0 1 3\n";
const char kEuroc[] =
    "#timestamp, p_RS_R_x [m]\n"
    "1403636579758555392, 1, 2, 3, 0.70710678, 0, 0, 0.70710678, 0.1, 0.2\n";

TEST_F(TrajectoryFormatTest, IsRecognisedByTheFirstLine) {
  for (const char* text : {kTum, kKitti, kEuroc}) {
    const auto [poses, has_stamps] = read(text);
    ASSERT_EQ(poses.size(), 1U) << text;
    EXPECT_EQ(poses[0].T_world_camera.translation(), Eigen::Vector3d(1, 2, 3)) << text;
    const Eigen::Vector3d turned = poses[0].T_world_camera.linear() * Eigen::Vector3d::UnitX();
    EXPECT_LT((turned - Eigen::Vector3d::UnitY()).norm(), 1e-7) << text;
    EXPECT_EQ(has_stamps, text != kKitti);
  }
  EXPECT_EQ(read(kTum).poses[0].stamp_ns, 2'500'000'000);
  EXPECT_EQ(read(kEuroc).poses[0].stamp_ns, 1403636579758555392) << "not a digit is lost";
}

TEST_F(TrajectoryFormatTest, KittisPosesAreNumbered) {
  const auto poses = read(std::string(kKitti) + "\n" + kKitti + kKitti).poses;
  ASSERT_EQ(poses.size(), 3U);
  EXPECT_EQ(poses[2].stamp_ns, 2'000'000'000);
}

TEST_F(TrajectoryFormatTest, CommasAloneMakeNoEuroc) {
  EXPECT_EQ(read("2.5,1,2,3,0,0,0,1\n").poses[0].stamp_ns, 2'500'000'000);
}

TEST_F(TrajectoryFormatTest, PosesComeInTheOrderOfTheirStamps) {
  const auto poses =
      read("2000000000000000000,0,0,0,1,0,0,0\n1000000000000000000,1,0,0,1,0,0,0\n").poses;
  EXPECT_EQ(poses[0].T_world_camera.translation().x(), 1);
}

TEST_F(TrajectoryFormatTest, ErrorsNameLineAndWhatWasExpected) {
  const auto has = [](const std::string& text, const std::string& part) {
    return text.find(part) != std::string::npos;
  };
  EXPECT_TRUE(has(error(std::string(kKitti) + "1 2 3\n"), "file:2: 3 numbers, expected 12"));
  EXPECT_TRUE(has(error("1 1 0 1 1 0 0 2 0 0 1 3\n"), "file:1: the first three columns"));
  EXPECT_TRUE(has(error("-1 0 0 0 0 1 0 0 0 0 1 0\n"), "no rotation")) << "a mirror";
  EXPECT_TRUE(has(error("0 -1 0 1 1 0 0 2 0 0 1 nan\n"), "'nan' is no number"));
  EXPECT_TRUE(has(error("1.5,0,0,0,1,0,0,0\n", TrajectoryFormat::euroc), "'1.5' is no stamp"));
  EXPECT_TRUE(has(error("1,0,0,0,1,0\n", TrajectoryFormat::euroc), "6 columns, expected 8"));
  EXPECT_TRUE(has(error("1,0,0,0,2,0,0,0\n", TrajectoryFormat::euroc), "unit length"));
  EXPECT_TRUE(has(error("1 2\n"), "expected 8 numbers"));
  EXPECT_TRUE(has(errorOf([&] { readTrajectory(root / "none"); }), "none: cannot be opened"));
}

TEST_F(TrajectoryFormatTest, AnEmptyFileHasNoPoses) {
  for (const auto& name : trajectoryFormats()) {
    EXPECT_TRUE(read("# nothing\n", trajectoryFormatNamed(name)).poses.empty()) << name;
  }
  EXPECT_EQ(errorOf([] { trajectoryFormatNamed("csv"); }),
            "format is 'csv', expected one of auto, tum, kitti, euroc");
}

}  // namespace
}  // namespace pf
