// SPDX-License-Identifier: BSD-3-Clause
#include "posefusion/io/robot_files.hpp"

#include <gtest/gtest.h>

#include <functional>

#include "posefusion/core/error.hpp"
#include "posefusion/io/trajectory_file.hpp"
#include "posefusion/robot/robot_recording.hpp"
#include "temporary_folder.hpp"

namespace pf {
namespace {

class RobotFiles : public ::testing::Test {
 protected:
  std::string write(const char* name, const std::string& text) { return folder_.write(name, text); }

  static std::string complaint(const std::function<void()>& load) {
    try {
      load();
    } catch (const InputError& error) {
      return error.what();
    }
    return {};
  }

  TemporaryFolder folder_;
};

TEST_F(RobotFiles, ImuSamplesAreTurnedIntoTheCamerasAxes) {
  const std::string path =
      write("imu.csv", "#timestamp [ns],w_x\n1000,1,2,3,4,5,6\r\n\n2000,0,0,0,0,0,9.81\n");
  EXPECT_EQ(loadImu(path).at(0).rate_rad_s, Eigen::Vector3d(1, 2, 3));
  // Mounted with x forward, y left and z up, as bodies have it.
  write("imu.yaml", "T_imu_camera: {position_m: [0, 0, 0], quaternion: [-0.5, 0.5, -0.5, 0.5]}\n");
  const auto samples = loadImu(path);
  ASSERT_EQ(samples.size(), 2U);
  EXPECT_EQ(samples[1].stamp_ns, 2000);
  EXPECT_TRUE(samples[1].acceleration_m_s2.isApprox(Eigen::Vector3d(0, -9.81, 0), 1e-9));
  EXPECT_TRUE(samples[0].rate_rad_s.isApprox(Eigen::Vector3d(-2, -3, 1), 1e-9));
}

TEST_F(RobotFiles, BadSamplesAreNamed) {
  const std::string path = write("imu.csv", "1000,1,2,3,4,5,6\n2000,1,2,x,4,5,6\n");
  EXPECT_NE(complaint([&] { loadImu(path); }).find("imu.csv:2: expected 7 numbers"),
            std::string::npos);
  EXPECT_NE(complaint([&] { loadImu(write("a.csv", "1,2,3,4,5,6,7,8\n")); }).find("a.csv:1"),
            std::string::npos);
  EXPECT_NE(complaint([&] { loadImu(write("b.csv", "# nothing\n")); }).find("no sample"),
            std::string::npos);
  write("imu.yaml", "T_imu_camera: {quaternion: [0, 0, 0, 0]}\n");
  EXPECT_NE(complaint([&] { loadImu(path); }).find("unit length"), std::string::npos);
  EXPECT_NE(complaint([&] { loadImu(folder_ / "none.csv"); }).find("none.csv"), std::string::npos);
}

TEST_F(RobotFiles, OdometryOfTheBaseIsCarriedToTheCamera) {
  const std::string path =
      write("odometry.txt", "1 1 0 0 0 0 0 1\n2 2 0 0 0 0 0 1\n3 3 0 0 0 0 0 1\n");
  EXPECT_EQ(loadOdometry(path).at(1).T_world_camera.translation(), Eigen::Vector3d(2, 0, 0));
  write("base_camera.txt", "7 0 0 1.5 0 0 0 1\n");  // fixed
  EXPECT_EQ(loadOdometry(path).at(2).T_world_camera.translation(), Eigen::Vector3d(3, 0, 1.5));
  write("base_camera.txt", "1 0 0 1.0 0 0 0 1\n2 0 0 1.2 0 0 0 1\n");  // a head that rises
  const Trajectory moving = loadOdometry(path);
  ASSERT_EQ(moving.size(), 2U) << "the head is not known at 3 s";
  EXPECT_TRUE(moving[1].T_world_camera.translation().isApprox(Eigen::Vector3d(2, 0, 1.2)));
}

/// What a playback hands out.
struct Heard {
  std::vector<std::int64_t> odometry, imu;
  void addOdometry(const StampedPose& pose) { odometry.push_back(pose.stamp_ns); }
  void addImu(const ImuSample& sample) { imu.push_back(sample.stamp_ns); }
};

TEST(RobotPlayback, GoesOneBeyondEachFrame) {
  RobotRecording recording;
  for (std::int64_t t = 0; t < 10; ++t)
    recording.imu.push_back({10 * t, Eigen::Vector3d::Zero(), Eigen::Vector3d::Zero()});
  recording.odometry = {{0, {}}, {50, {}}, {100, {}}};
  RobotPlayback playback(recording);
  Heard heard;
  playback.playUntil(35, heard);
  EXPECT_EQ(heard.imu, (std::vector<std::int64_t>{0, 10, 20, 30, 40}));
  EXPECT_EQ(heard.odometry, (std::vector<std::int64_t>{0, 50}));
  playback.playUntil(36, heard);
  EXPECT_EQ(heard.imu.size(), 5U);
  playback.playUntil(1000, heard);
  EXPECT_EQ(heard.imu.size(), 10U);
  EXPECT_EQ(heard.odometry.size(), 3U);
}

}  // namespace
}  // namespace pf
