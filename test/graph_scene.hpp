// SPDX-License-Identifier: BSD-3-Clause
// Pose graphs with a known truth.
#pragma once

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "posefusion/core/se3.hpp"
#include "posefusion/graph/pose_graph.hpp"

namespace pf {

using Poses = std::vector<Eigen::Isometry3d>;

const Matrix6d kTracking = 1e-6 * Matrix6d::Identity();
constexpr int kFramesApart = 10;

inline Eigen::Isometry3d motion(double x, double y, double z, double yaw, double roll = 0) {
  Vector6d twist;
  twist << x, y, z, roll, yaw, 0;
  return expSe3(twist);
}

inline double distance(const Eigen::Isometry3d& a, const Eigen::Isometry3d& b) {
  return (a.translation() - b.translation()).norm();
}

inline double worstDistance(const PoseGraph& graph, const Poses& truth) {
  double worst = 0;
  for (std::size_t i = 0; i < truth.size(); ++i) {
    worst = std::max(worst, distance(graph.keyframes()[i].T_map_camera, truth[i]));
  }
  return worst;
}

/// Poses as tracked with a drift: each step is the true one and then `drift`.
inline Poses drifted(const Poses& truth, const Eigen::Isometry3d& drift) {
  Poses poses{truth[0]};
  for (std::size_t i = 1; i < truth.size(); ++i) {
    poses.push_back(poses.back() * truth[i - 1].inverse() * truth[i] * drift);
  }
  return poses;
}

inline Keyframe keyframeAt(const Eigen::Isometry3d& T, std::size_t i, int fragment = 0) {
  Keyframe k;
  k.T_map_camera = T;
  k.stamp_ns = static_cast<std::int64_t>(i) * 333'000'000;
  k.map_frame = static_cast<std::int32_t>(i) * kFramesApart;
  k.fragment = fragment;
  return k;
}

inline void addTo(PoseGraph& graph, const Poses& poses, int fragment = 0) {
  for (std::size_t i = 0; i < poses.size(); ++i) {
    const std::size_t at = graph.keyframes().size();
    const Keyframe keyframe = keyframeAt(poses[i], at, fragment);
    if (i == 0) {
      graph.addKeyframe(keyframe);
    } else {
      graph.addKeyframe(keyframe, static_cast<int>(at) - 1, kTracking);
    }
  }
}

inline PoseGraph graphOf(const Poses& poses) {
  PoseGraph graph((GraphConfig()));
  addTo(graph, poses);
  return graph;
}

inline PoseConstraint loopOf(const Poses& truth, int from, int to) {
  PoseConstraint loop;
  loop.from = from;
  loop.to = to;
  loop.T_from_to =
      truth[static_cast<std::size_t>(from)].inverse() * truth[static_cast<std::size_t>(to)];
  loop.covariance = 1e-5 * Matrix6d::Identity();
  return loop;
}

/// Out and back along a straight corridor, looking ahead and then back.
inline Poses corridor() {
  Poses poses;
  for (int i = 0; i < 60; ++i) {
    const bool back = i >= 30;
    poses.push_back(motion(0, 0, 0.2 * (back ? 59 - i : i), 0) * motion(0, 0, 0, back ? 3.0 : 0));
  }
  return poses;
}

/// Two circles that cross each other, each of 40 steps.
inline Poses figureEight() {
  Poses poses;
  for (int i = 0; i <= 80; ++i) {
    const double t = 2 * M_PI * i / 80;
    const double heading = std::atan2(2 * std::cos(t), 4 * std::cos(2 * t));
    poses.push_back(motion(2 * std::sin(t), 0, 2 * std::sin(2 * t), 0) * motion(0, 0, 0, heading));
  }
  return poses;
}

const Eigen::Isometry3d kYawDrift = motion(0, 0, 0.002, 0.004);

inline void expectUnchanged(const PoseGraph& graph, const PoseGraph& before) {
  ASSERT_EQ(graph.keyframes().size(), before.keyframes().size());
  EXPECT_EQ(graph.constraints().size(), before.constraints().size());
  EXPECT_EQ(graph.version(), before.version());
  for (std::size_t i = 0; i < graph.keyframes().size(); ++i) {
    const Keyframe &a = graph.keyframes()[i], &b = before.keyframes()[i];
    EXPECT_EQ(a.T_map_camera.matrix(), b.T_map_camera.matrix()) << i;
    EXPECT_EQ(a.fragment, b.fragment) << i;
  }
}

/// A corridor in fragment 0, and later another piece of the world in fragment 1, anywhere.
inline PoseGraph twoFragments(const Poses& truth) {
  PoseGraph graph = graphOf(Poses(truth.begin(), truth.begin() + 30));
  Poses later(truth.begin() + 30, truth.end());
  for (auto& T : later) T = motion(50, 3, -20, 1.2) * T;
  addTo(graph, later, 1);
  return graph;
}

}  // namespace pf
