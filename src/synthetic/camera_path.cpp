// SPDX-License-Identifier: BSD-3-Clause
#include "camera_path.hpp"

#include <array>
#include <cmath>

#include "random.hpp"

namespace pf::synthetic {
namespace {

struct Wave {
  double amplitude;  ///< metres or rad
  double hertz;
};
using Waves = std::array<Wave, 3>;  // drift, sway, tremor

constexpr std::array<Waves, 6> kMotion = {{
    {{{0.35, 0.13}, {0.030, 0.71}, {0.0010, 5.3}}},  // x, along the room
    {{{0.18, 0.17}, {0.020, 0.83}, {0.0008, 4.7}}},  // y, towards the far wall
    {{{0.09, 0.23}, {0.020, 0.97}, {0.0008, 5.9}}},  // z, up
    {{{0.34, 0.15}, {0.050, 0.61}, {0.0020, 4.9}}},  // yaw
    {{{0.10, 0.21}, {0.035, 0.79}, {0.0020, 5.6}}},  // pitch
    {{{0.06, 0.26}, {0.025, 0.89}, {0.0015, 5.1}}},  // roll
}};

double motion(std::size_t axis, double time_s, std::uint32_t seed) {
  constexpr double kTurn = 6.283185307179586;
  double sum = 0;
  for (std::size_t i = 0; i < kMotion[axis].size(); ++i) {
    const double phase = uniform(randomBits(std::uint64_t{seed} * 64 + axis * 8 + i), 5);
    const Wave& wave = kMotion[axis][i];
    sum += wave.amplitude * std::sin(kTurn * (wave.hertz * time_s + phase));
  }
  return sum;
}

}  // namespace

Eigen::Isometry3d cameraAt(double time_s, std::uint32_t seed) {
  std::array<double, 6> m{};
  for (std::size_t axis = 0; axis < m.size(); ++axis) m[axis] = motion(axis, time_s, seed);
  Eigen::Matrix3d
      R_room_level;  // columns: right, down, forwards of a level camera looking along +y
  R_room_level << 1, 0, 0, 0, 0, 1, 0, -1, 0;
  Eigen::Isometry3d T_room_camera = Eigen::Isometry3d::Identity();
  T_room_camera.translate(Eigen::Vector3d(2.5 + m[0], 0.75 + m[1], 1.35 + m[2]));
  T_room_camera.rotate(Eigen::AngleAxisd(m[3], Eigen::Vector3d::UnitZ()));
  T_room_camera.rotate(R_room_level);
  T_room_camera.rotate(Eigen::AngleAxisd(-0.13 + m[4], Eigen::Vector3d::UnitX()));
  T_room_camera.rotate(Eigen::AngleAxisd(m[5], Eigen::Vector3d::UnitZ()));
  return T_room_camera;
}

}  // namespace pf::synthetic
