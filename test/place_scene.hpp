// SPDX-License-Identifier: BSD-3-Clause
// A small room, and lost cameras in it.
#pragma once

#include <gtest/gtest.h>

#include "posefusion/core/se3.hpp"
#include "posefusion/loop/map_points.hpp"
#include "posefusion/map/fusion.hpp"
#include "simulated_sequence.hpp"

namespace pf {

/// The small room, mapped at its true poses.
struct MappedRoom {
  SimulatedSequence sequence{"empty_box", 12};
  SurfelMap map{stableAtOnce()};
  PointPyramid points;
  Eigen::Vector3d up;

  static MapConfig stableAtOnce() {
    MapConfig config;
    config.stable_probability = 0.57;  // two frames
    return config;
  }

  MappedRoom() {
    Fuser fuser;
    for (int i = 0; i < sequence.frameCount(); ++i) fuser.fuse(frame(i), sequence.pose(i), map);
    points = pointPyramid(thinnedPoints(map));
    const auto levels = findLevels(orientedPoints(points.front()), -Eigen::Vector3d::UnitY(), 0.9);
    up = levels ? levels->up : Eigen::Vector3d(0, 0, 0);
  }

  WorkingFrame frame(int index) const {
    WorkingFrame working;
    working.assign(sequence.frame(index).frame, cv::Mat(), FrameConfig{});
    return working;
  }
};

inline const MappedRoom& room() {
  static const MappedRoom mapped;
  return mapped;
}

/// `T` turned about the vertical and shifted horizontally, as by a fall.
inline Eigen::Isometry3d afterFall(const Eigen::Isometry3d& T, double turn_rad, double shift_m) {
  Eigen::Isometry3d moved = T;
  const Eigen::Vector3d up = room().up;
  moved.linear() = Eigen::AngleAxisd(turn_rad, up).toRotationMatrix() * T.linear();
  const Eigen::Vector3d ahead = T.linear().col(2);
  moved.translation() += shift_m * (ahead - ahead.dot(up) * up).normalized();
  return moved;
}

inline double metresOff(const Eigen::Isometry3d& a, const Eigen::Isometry3d& b) {
  return (a.translation() - b.translation()).norm();
}

inline double radiansOff(const Eigen::Isometry3d& a, const Eigen::Isometry3d& b) {
  return logSo3(a.linear().transpose() * b.linear()).norm();
}

}  // namespace pf
