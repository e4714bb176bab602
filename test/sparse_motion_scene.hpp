// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <gtest/gtest.h>

#include <optional>
#include <random>

#include "posefusion/tracking/sparse_motion.hpp"
#include "small_camera.hpp"

namespace pf {

/// A wall that leans, with corners on it, seen by two cameras; some corners belong to a walking
/// person.
class SparseMotionTest : public ::testing::Test {
 protected:
  static constexpr double kWall_m = 2.5;

  SparseMotionTest() {
    Vector6d twist;
    twist << 0.02, -0.01, 0.015, 0.01, 0.03, -0.005;
    T_before_after_ = expSe3(twist);
    before_m_ = depthFrom(Eigen::Isometry3d::Identity());
    after_m_ = depthFrom(T_before_after_);
    flow_.from_ns = 1;
    flow_.to_ns = 2;
  }

  /// Depth along a ray (camera at T) of the plane z = kWall_m + 0.3 x.
  static double hit(const Eigen::Isometry3d& T, const Eigen::Vector3d& ray) {
    const Eigen::Vector3d o = T.translation(), d = T.linear() * ray;
    return (kWall_m + 0.3 * o.x() - o.z()) / (d.z() - 0.3 * d.x());
  }

  cv::Mat depthFrom(const Eigen::Isometry3d& T) const {
    cv::Mat depth(camera_.height, camera_.width, CV_32FC1);
    for (int v = 0; v < depth.rows; ++v) {
      for (int u = 0; u < depth.cols; ++u) {
        depth.at<float>(v, u) = static_cast<float>(hit(T, camera_.unproject(u, v, 1.0)));
      }
    }
    return depth;
  }

  /// `count` corners of the wall, and `walking` that move by 6 pixels more than the wall does.
  void addCorners(int count, int walking, double noise_px) {
    std::mt19937 random(3);
    std::uniform_real_distribution<double> column(40, 600), row(40, 440);
    std::normal_distribution<double> noise(0.0, noise_px);
    for (int i = 0; i < count + walking; ++i) {
      const double u = column(random), v = row(random);
      const Eigen::Vector3d ray = camera_.unproject(u, v, 1.0);
      const Eigen::Vector3d point = ray * hit(Eigen::Isometry3d::Identity(), ray);
      const Eigen::Vector2d seen = camera_.project(T_before_after_.inverse() * point);
      const double walk = i < count ? 0.0 : 6.0;
      flow_.before.emplace_back(u, v);
      flow_.after.emplace_back(seen.x() + walk + noise(random), seen.y() + noise(random));
      flow_.ids.push_back(static_cast<std::uint32_t>(i));
    }
  }

  SparseMotion estimate(const ModelView* view = nullptr) const {
    FlowScene scene{before_m_, after_m_, view};
    scene.expected = expected_;
    scene.before_still = still_;
    return estimateMotion(flow_, scene, camera_);
  }

  /// It is expected to go on for 1/30 s as it does, but for this twist.
  void expect(const Vector6d& off) {
    expected_ = steadyStep(T_before_after_ * expSe3(off), 1.0 / 30, 1.0 / 30);
  }

  Vector6d error(const SparseMotion& motion) const {
    return logSe3(motion.T_before_after.inverse() * T_before_after_);
  }

  PinholeCamera camera_ = vga();
  Eigen::Isometry3d T_before_after_;
  cv::Mat before_m_, after_m_;
  cv::Mat still_;
  SparseFlow flow_;
  std::optional<ExpectedStep> expected_;
};

}  // namespace pf
