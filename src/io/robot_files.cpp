// SPDX-License-Identifier: BSD-3-Clause
#include "posefusion/io/robot_files.hpp"

#include <algorithm>
#include <array>
#include <charconv>
#include <filesystem>
#include <sstream>

#include "posefusion/config/yaml_map.hpp"
#include "posefusion/core/error.hpp"
#include "posefusion/core/se3.hpp"
#include "posefusion/io/files.hpp"
#include "posefusion/io/trajectory_file.hpp"

namespace pf {
namespace {

constexpr const char* kShape = "expected 7 numbers: stamp_ns,wx,wy,wz,ax,ay,az";

std::string beside(const std::string& path, const char* name) {
  return (std::filesystem::path(path).parent_path() / name).string();
}

/// Turns vectors of the sensor into the axes of the camera.
Eigen::Matrix3d mountOf(const std::string& imu_file) {
  const std::string path = beside(imu_file, "imu.yaml");
  if (!std::filesystem::exists(path)) return Eigen::Matrix3d::Identity();
  YamlMap file(parseYaml(readFile(path), path), path + ": ");
  YamlMap mount = file.map("T_imu_camera");
  const std::vector<double> q = mount.numbers("quaternion", 4);
  const auto R_imu_camera = rotationOf({q[3], q[0], q[1], q[2]});
  if (!R_imu_camera) mount.fail("quaternion", "is not of unit length, expected x, y, z, w");
  return R_imu_camera->transpose();
}

ImuSample sampleOf(std::string line, const Eigen::Matrix3d& R_camera_imu) {
  std::replace(line.begin(), line.end(), ',', ' ');
  std::istringstream fields(line);
  ImuSample sample;
  std::array<double, 6> values{};
  if (!(fields >> sample.stamp_ns)) throw InputError(kShape);
  for (double& value : values) {
    if (!(fields >> value)) throw InputError(kShape);
  }
  std::string rest;
  if (fields >> rest) throw InputError(kShape);
  sample.rate_rad_s = R_camera_imu * Eigen::Map<const Eigen::Vector3d>(values.data());
  sample.acceleration_m_s2 = R_camera_imu * Eigen::Map<const Eigen::Vector3d>(values.data() + 3);
  return sample;
}

}  // namespace

std::vector<ImuSample> loadImu(const std::string& path) {
  std::istringstream in(readFile(path));
  const Eigen::Matrix3d R_camera_imu = mountOf(path);
  std::vector<ImuSample> samples;
  std::string line;
  for (int number = 1; std::getline(in, line); ++number) {
    if (line.find_first_not_of(" \t\r") == std::string::npos || line[0] == '#') continue;
    try {
      samples.push_back(sampleOf(line, R_camera_imu));
    } catch (const InputError& error) {
      throw InputError(path + ":" + std::to_string(number) + ": " + error.what());
    }
  }
  if (samples.empty()) throw InputError(path + ": has no sample, " + kShape);
  return samples;
}

Trajectory loadOdometry(const std::string& path) {
  Trajectory odometry = loadTrajectory(path);
  const std::string mount_file = beside(path, "base_camera.txt");
  if (!std::filesystem::exists(mount_file)) return odometry;
  const Trajectory mounts = loadTrajectory(mount_file);
  Trajectory of_camera;
  for (StampedPose& pose : odometry) {
    const auto T_base_camera =
        poseAt(mounts, mounts.size() == 1 ? mounts.front().stamp_ns : pose.stamp_ns);
    if (!T_base_camera) continue;
    pose.T_world_camera = orthonormalised(pose.T_world_camera * *T_base_camera);
    of_camera.push_back(pose);
  }
  return of_camera;
}

}  // namespace pf
