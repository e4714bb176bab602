// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cmath>
#include <limits>
#include <random>
#include <vector>

#include "posefusion/calibration/depth_field.hpp"
#include "posefusion/calibration/view_surface.hpp"
#include "posefusion/core/depth_sensor.hpp"
#include "posefusion/core/se3.hpp"

/// A room of 6 x 5 x 2.6 m with three boxes in it, seen by a camera whose depth is wrong by a known
/// field. No two walls are needed to be seen at once: planes are met exactly by rays.
namespace pf::test {

struct RoomBox {
  Eigen::Vector3d low, high;
};

/// Distance along a ray until a box is entered; infinite where it is missed.
inline double enters(const RoomBox& box, const Eigen::Vector3d& from, const Eigen::Vector3d& ray) {
  double begin = 0, end = std::numeric_limits<double>::infinity();
  for (int k = 0; k < 3; ++k) {
    const double a = (box.low[k] - from[k]) / ray[k], b = (box.high[k] - from[k]) / ray[k];
    begin = std::max(begin, std::min(a, b));
    end = std::min(end, std::max(a, b));
  }
  return begin < end && begin > 0 ? begin : std::numeric_limits<double>::infinity();
}

/// Distance along a ray from inside the room to its walls.
inline double leaves(const RoomBox& room, const Eigen::Vector3d& from, const Eigen::Vector3d& ray) {
  double end = std::numeric_limits<double>::infinity();
  for (int k = 0; k < 3; ++k) {
    end = std::min(end,
                   std::max((room.low[k] - from[k]) / ray[k], (room.high[k] - from[k]) / ray[k]));
  }
  return end;
}

inline PinholeCamera roomCamera(int width = 160) {
  PinholeCamera camera;
  camera.width = width;
  camera.height = width * 3 / 4;
  camera.fx = camera.fy = 0.82 * width;
  camera.cx = 0.5 * (camera.width - 1);
  camera.cy = 0.5 * (camera.height - 1);
  return camera;
}

/// Smooth, mean zero over the nodes, about 0.003 1/m RMS: as an uncalibrated camera has it.
inline DepthField roomField(int columns = 12, int rows = 9) {
  std::vector<double> nodes;
  for (int r = 0; r < rows; ++r) {
    for (int c = 0; c < columns; ++c) {
      const double x = 6.28 * c / (columns - 1), y = 4.7 * r / (rows - 1);
      nodes.push_back(0.005 * std::sin(0.7 * x + 1.0) * std::cos(0.8 * y + 0.4) +
                      0.003 * std::sin(1.9 * x + 0.3) * std::cos(1.6 * y + 2.0));
    }
  }
  return DepthField(columns, rows, nodes).centred();
}

struct RoomView {
  int number = 0;
  PinholeCamera camera = roomCamera();
  DepthField field{};       ///< what a user has to correct the depth by
  double noise = 1.0;       ///< times that of the sensor, windows averaged
  double pose_error_m = 0;  ///< of the pose that the view has
};

/// View `number` of a walk through the room: once around, looking at the walls from 1 to 5 m.
inline Eigen::Isometry3d roomPose(int number) {
  const double turn = 0.35 * number, at = 0.21 * number;
  Eigen::Isometry3d T = Eigen::Isometry3d::Identity();
  T.translation() << 3.0 + 1.4 * std::cos(at), 2.5 + 1.1 * std::sin(at),
      1.3 + 0.2 * std::sin(0.7 * number);
  // Optical axes: z forward, x right, y down, in a world with z up.
  Eigen::Matrix3d upright;
  upright << 0, 0, 1, -1, 0, 0, 0, -1, 0;
  T.linear() = (Eigen::AngleAxisd(turn, Eigen::Vector3d::UnitZ()) *
                Eigen::AngleAxisd(0.25 * std::sin(0.9 * number), Eigen::Vector3d::UnitY()))
                   .toRotationMatrix() *
               upright;
  return T;
}

inline CalibrationView roomView(const RoomView& wanted) {
  static const RoomBox room{{0, 0, 0}, {6, 5, 2.6}};
  static const std::vector<RoomBox> boxes = {{{0.1, 3.4, 0.0}, {1.0, 4.6, 1.2}},
                                             {{4.6, 0.2, 0.0}, {5.7, 1.1, 0.8}},
                                             {{2.7, 2.2, 0.0}, {3.3, 2.8, 0.7}}};
  const PinholeCamera& camera = wanted.camera;
  const Eigen::Isometry3d T = roomPose(wanted.number);
  std::mt19937 luck(static_cast<unsigned>(wanted.number) + 1U);
  std::normal_distribution<double> normal;
  CalibrationView view;
  view.id = wanted.number;
  view.camera = camera;
  view.depth_mm.create(camera.height, camera.width, CV_16UC1);
  for (int v = 0; v < camera.height; ++v) {
    for (int u = 0; u < camera.width; ++u) {
      const Eigen::Vector3d ray = T.linear() * camera.unproject(u, v, 1.0);
      double z = leaves(room, T.translation(), ray);
      for (const RoomBox& box : boxes) z = std::min(z, enters(box, T.translation(), ray));
      z = wanted.field.inverse().corrected(z, (u + 0.5) / camera.width, (v + 0.5) / camera.height);
      z += 0.5 * wanted.noise * DepthSensor{}.sigma(static_cast<float>(z)) * normal(luck);
      view.depth_mm.at<std::uint16_t>(v, u) =
          z < 5.0 ? static_cast<std::uint16_t>(std::lround(1000.0 * z)) : 0;
    }
  }
  Eigen::Vector3d shift(normal(luck), normal(luck), normal(luck));
  view.T_map_camera = T;
  view.T_map_camera.translation() += wanted.pose_error_m * shift;
  return view;
}

inline std::vector<CalibrationView> roomViews(int count, const RoomView& like) {
  std::vector<CalibrationView> views;
  for (int i = 0; i < count; ++i) {
    RoomView wanted = like;
    wanted.number = i;
    views.push_back(roomView(wanted));
  }
  return views;
}

}  // namespace pf::test
