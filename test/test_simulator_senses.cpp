// SPDX-License-Identifier: BSD-3-Clause
// The files of the robot's other sensors: readable, of the recording's time, and no other file's
// bytes depend on them.
#include <gtest/gtest.h>

#include <algorithm>
#include <filesystem>
#include <map>
#include <sstream>

#include "posefusion/config/yaml_map.hpp"
#include "posefusion/io/files.hpp"
#include "posefusion/io/trajectory_file.hpp"
#include "simulator/output.hpp"
#include "simulator/sense_files.hpp"
#include "simulator_scene.hpp"

namespace pf::simulator {
namespace {

constexpr const char* kFiles[] = {"imu.csv", "imu.yaml", "odometry.txt", "base_camera.txt",
                                  "head_joints.csv"};

TEST(SimulatorSenses, FilesHaveTheShapesThatAreDocumented) {
  const TemporaryFolder folder;
  const Simulation simulation(smallScenario());
  saveSenses(folder.str(), simulation, 30);
  std::istringstream imu(readFile(folder / "imu.csv"));
  std::string line;
  std::getline(imu, line);
  EXPECT_EQ(line,
            "#timestamp [ns],w_RS_S_x [rad s^-1],w_RS_S_y [rad s^-1],w_RS_S_z [rad s^-1],"
            "a_RS_S_x [m s^-2],a_RS_S_y [m s^-2],a_RS_S_z [m s^-2]");
  std::int64_t stamp_ns = 1000000000000;
  int samples = 0;
  for (; std::getline(imu, line); ++samples, stamp_ns += 5'000'000) {
    EXPECT_EQ(line.substr(0, 14), std::to_string(stamp_ns) + ",");
    EXPECT_EQ(std::count(line.begin(), line.end(), ','), 6);
  }
  EXPECT_EQ(samples, 211);  // 1.05 s, both ends
  const Trajectory odometry = loadTrajectory(folder / "odometry.txt"),
                   neck = loadTrajectory(folder / "base_camera.txt");
  ASSERT_EQ(odometry.size(), 53U);
  ASSERT_EQ(neck.size(), odometry.size());
  std::istringstream joints(readFile(folder / "head_joints.csv"));
  std::getline(joints, line);
  EXPECT_EQ(line, "#stamp [s],yaw_rad,pitch_rad");
  for (std::size_t i = 0; i < neck.size(); ++i) {
    EXPECT_EQ(neck[i].stamp_ns, odometry[i].stamp_ns);
    NeckAngles angles;
    char comma = 0;
    double stamp_s = 0.0;
    joints >> stamp_s >> comma >> angles.yaw_rad >> comma >> angles.pitch_rad;
    EXPECT_NEAR(stamp_s, 1e-9 * static_cast<double>(neck[i].stamp_ns), 1e-6);
    EXPECT_TRUE(neck[i].T_world_camera.isApprox(baseFromCamera(LegsConfig(), angles), 1e-6));
  }
}

TEST(SimulatorSenses, TheImusFileHasItsMountingAndItsNoise) {
  const TemporaryFolder folder;
  const Simulation simulation(
      smallScenario({"imu.camera_m=[0.1, 0.2, 0.3]", "imu.camera_rpy_deg=[0, 0, 90]",
                     "imu.accel_full_scale_g=4", "imu.rate_hz=100"}));
  saveSenses(folder.str(), simulation, 3);
  YamlMap map(parseYaml(readFile(folder / "imu.yaml"), "imu.yaml"), "imu.yaml: ");
  YamlMap pose = map.map("T_imu_camera");
  EXPECT_LT((pose.vector3("position_m", {}) - Eigen::Vector3d(0.1, 0.2, 0.3)).norm(), 1e-9);
  const auto q = pose.numbers("quaternion", 4);
  // The camera looks along the IMU's y axis, with its y axis downwards.
  const Eigen::Quaterniond R(q[3], q[0], q[1], q[2]);
  EXPECT_LT((R * Eigen::Vector3d::UnitZ() - Eigen::Vector3d::UnitY()).norm(), 1e-6);
  EXPECT_LT((R * Eigen::Vector3d::UnitY() + Eigen::Vector3d::UnitZ()).norm(), 1e-6);
  EXPECT_EQ(map.number("rate_hz", 0, 0, 1e4), 100.0);
  EXPECT_NEAR(map.number("accelerometer_full_scale_m_s2", 0, 0, 1e4), 39.24, 1e-6);
  EXPECT_NEAR(map.number("gyroscope_full_scale_rad_s", 0, 0, 1e4), 34.9066, 1e-3);
  EXPECT_EQ(map.number("gyroscope_noise_density", 0, 0, 1), ImuConfig().gyro_noise_rad_s_rthz);
  EXPECT_EQ(map.number("gyroscope_random_walk", 0, 0, 1), ImuConfig().gyro_walk_rad_s2_rthz);
  EXPECT_EQ(map.number("accelerometer_noise_density", 0, 0, 1), ImuConfig().accel_noise_m_s2_rthz);
  EXPECT_EQ(map.number("accelerometer_random_walk", 0, 0, 1), ImuConfig().accel_walk_m_s3_rthz);
  pose.finish();
  map.finish();
}

TEST(SimulatorSenses, SameSeedSameBytes) {
  const TemporaryFolder a, b, c;
  saveSenses(a.str(), Simulation(smallScenario()), 20);
  saveSenses(b.str(), Simulation(smallScenario()), 20);
  ScenarioChanges changes;
  changes.seed = 99;
  saveSenses(c.str(), Simulation(load(smallScene(), changes)), 20);
  for (const char* file : kFiles) EXPECT_EQ(readFile(a / file), readFile(b / file)) << file;
  EXPECT_NE(readFile(a / "imu.csv"), readFile(c / "imu.csv"));
  EXPECT_NE(readFile(a / "odometry.txt"), readFile(c / "odometry.txt"));
}

/// All that a recording of three frames has but the files of the other sensors.
std::map<std::string, std::string> recorded(const std::vector<std::string>& assignments) {
  const TemporaryFolder folder;
  Simulation simulation(smallScenario(assignments));
  const auto output = openTumOutput(folder / "out", simulation);
  for (int i = 0; i < 3; ++i) output->add(simulation.frame(i));
  output->finish(simulation);
  std::map<std::string, std::string> files;
  namespace fs = std::filesystem;
  for (const auto& entry : fs::recursive_directory_iterator(folder / "out")) {
    if (entry.is_regular_file()) files[entry.path().filename()] += readFile(entry.path());
  }
  for (const char* file : kFiles) EXPECT_EQ(files.erase(file), 1U) << file;
  return files;
}

TEST(SimulatorSenses, NothingElseDependsOnThem) {
  const std::vector<std::string> noisy = {"name=small", "truth.noise_m=0.01", "dropped=0.3"};
  auto others = noisy;
  others.insert(others.end(), {"imu.rate_hz=400", "imu.accel_bias_m_s2=1", "legs.rate_hz=10",
                               "legs.slip_every_s=1"});
  const auto files = recorded(noisy), same = recorded(others);
  ASSERT_EQ(files.size(), same.size());
  for (const auto& [name, bytes] : files) EXPECT_TRUE(same.at(name) == bytes) << name;
}

TEST(SimulatorSenses, BadSettingsAreNamed) {
  const auto error = [](const std::string& assignment) {
    return errorOf([&] { smallScenario({assignment}); });
  };
  EXPECT_NE(error("imu.rate_hz=0").find("imu.rate_hz is 0, expected"), std::string::npos);
  EXPECT_NE(error("imu.colour=0").find("imu.colour is unknown"), std::string::npos);
  EXPECT_NE(error("imu.camera_m=[1, 2]").find("imu.camera_m"), std::string::npos);
  EXPECT_NE(error("legs.slip_m=-1").find("legs.slip_m is -1, expected"), std::string::npos);
  EXPECT_NE(error("legs.slips=1").find("legs.slips is unknown"), std::string::npos);
}

}  // namespace
}  // namespace pf::simulator
