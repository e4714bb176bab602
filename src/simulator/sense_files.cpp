// SPDX-License-Identifier: BSD-3-Clause
#include "simulator/sense_files.hpp"

#include <filesystem>
#include <iomanip>

#include "posefusion/core/stamps.hpp"
#include "posefusion/io/files.hpp"
#include "posefusion/io/trajectory_file.hpp"

namespace pf::simulator {
namespace {

namespace fs = std::filesystem;

void putVector(std::ostream& out, const Eigen::Vector3d& v) {
  out << ',' << v.x() << ',' << v.y() << ',' << v.z();
}

void saveImu(const std::string& path, const std::vector<ImuSample>& samples,
             const Simulation& simulation) {
  AtomicFile file(path);
  file.stream() << "#timestamp [ns],w_RS_S_x [rad s^-1],w_RS_S_y [rad s^-1],w_RS_S_z [rad s^-1],"
                   "a_RS_S_x [m s^-2],a_RS_S_y [m s^-2],a_RS_S_z [m s^-2]\n"
                << std::setprecision(9);
  for (const ImuSample& sample : samples) {
    file.stream() << simulation.stampOf(sample.time_s);
    putVector(file.stream(), sample.rate_rad_s);
    putVector(file.stream(), sample.force_m_s2);
    file.stream() << '\n';
  }
  file.commit();
}

/// Noise has the names and units that EuRoC gives it.
void saveImuYaml(const std::string& path, const ImuConfig& c) {
  const Eigen::Isometry3d T = imuFromCamera(c);
  const Eigen::Quaterniond q(T.linear());
  AtomicFile file(path);
  file.stream() << std::setprecision(9)
                << "# An inertial sensor: camera coordinates to its own, noise, full scale.\n"
                << "T_imu_camera: {position_m: [" << T.translation().x() << ", "
                << T.translation().y() << ", " << T.translation().z() << "], quaternion: [" << q.x()
                << ", " << q.y() << ", " << q.z() << ", " << q.w() << "]}\n"
                << "rate_hz: " << c.rate_hz
                << "\ngyroscope_noise_density: " << c.gyro_noise_rad_s_rthz
                << "  # rad/s/sqrt(Hz)\ngyroscope_random_walk: " << c.gyro_walk_rad_s2_rthz
                << "  # rad/s^2/sqrt(Hz)\naccelerometer_noise_density: " << c.accel_noise_m_s2_rthz
                << "  # m/s^2/sqrt(Hz)\naccelerometer_random_walk: " << c.accel_walk_m_s3_rthz
                << "  # m/s^3/sqrt(Hz)\ngyroscope_full_scale_rad_s: "
                << c.gyro_full_scale_deg_s * M_PI / 180.0
                << "\naccelerometer_full_scale_m_s2: " << c.accel_full_scale_g * kGravity_m_s2
                << "\n";
  file.commit();
}

void saveLegs(const fs::path& folder, const std::vector<LegSample>& samples,
              const Simulation& simulation) {
  Trajectory odometry, neck;
  AtomicFile joints(folder / "head_joints.csv");
  joints.stream() << "#stamp [s],yaw_rad,pitch_rad\n" << std::setprecision(9);
  for (const LegSample& sample : samples) {
    const std::int64_t stamp_ns = simulation.stampOf(sample.time_s);
    odometry.push_back({stamp_ns, sample.T_odom_base});
    neck.push_back({stamp_ns, sample.T_base_camera});
    joints.stream() << formatStamp(stamp_ns) << ',' << sample.neck.yaw_rad << ','
                    << sample.neck.pitch_rad << '\n';
  }
  joints.commit();
  saveTrajectory(folder / "odometry.txt", odometry, "base_link to odom, as the legs tell it");
  saveTrajectory(folder / "base_camera.txt", neck,
                 "camera to base_link, by the joints of the neck");
}

}  // namespace

void saveSenses(const std::string& folder, const Simulation& simulation, int frames) {
  const Senses senses = simulation.senses(frames);
  saveImu(fs::path(folder) / "imu.csv", senses.imu, simulation);
  saveImuYaml(fs::path(folder) / "imu.yaml", simulation.scenario().imu);
  saveLegs(folder, senses.legs, simulation);
}

}  // namespace pf::simulator
