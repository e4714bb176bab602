// SPDX-License-Identifier: BSD-3-Clause
#include "posefusion/segmentation/expected_motion.hpp"

#include <gtest/gtest.h>

#include <random>

#include "posefusion/core/se3.hpp"
#include "small_camera.hpp"

namespace pf {
namespace {

constexpr std::int64_t kPeriod_ns = 33'333'333;
constexpr double kWall_m = 2.5, kSlope = 0.3;

/// A leaning wall with corners on it, before a camera whose place is known.
class LeaningWall {
 public:
  LeaningWall() {
    std::mt19937 random(3);
    std::uniform_real_distribution<double> across(-1.2, 1.2), down(-0.8, 0.8);
    for (int i = 0; i < 120; ++i) {
      const double x = across(random);
      points_m_.emplace_back(x, down(random), kWall_m + kSlope * x);
    }
  }

  RgbdFrame frameAt(int number) const {
    RgbdFrame frame;
    frame.stamp_ns = number * kPeriod_ns;
    frame.camera = camera_;
    return frame;
  }

  cv::Mat depthFrom(const Eigen::Isometry3d& T) const {
    cv::Mat depth_m(camera_.height, camera_.width, CV_32FC1);
    for (int v = 0; v < depth_m.rows; ++v) {
      for (int u = 0; u < depth_m.cols; ++u) {
        const Eigen::Vector3d o = T.translation(), d = T.linear() * camera_.unproject(u, v, 1.0);
        const double z = (kWall_m + kSlope * o.x() - o.z()) / (d.z() - kSlope * d.x());
        depth_m.at<float>(v, u) = static_cast<float>(z);
      }
    }
    return depth_m;
  }

  ModelView viewFrom(int number, const Eigen::Isometry3d& T) const {
    ModelView view;
    view.stamp_ns = number * kPeriod_ns;
    view.camera = camera_;
    view.T_map_camera = T;
    view.depth_m = depthFrom(T);
    return view;
  }

  SparseFlow cornersBetween(int before, const Eigen::Isometry3d& T_before, int after,
                            const Eigen::Isometry3d& T_after) const {
    SparseFlow flow;
    flow.from_ns = before * kPeriod_ns;
    flow.to_ns = after * kPeriod_ns;
    for (std::size_t i = 0; i < points_m_.size(); ++i) {
      const Eigen::Vector2d a = camera_.project(T_before.inverse() * points_m_[i]);
      const Eigen::Vector2d b = camera_.project(T_after.inverse() * points_m_[i]);
      flow.before.emplace_back(a.x(), a.y());
      flow.after.emplace_back(b.x(), b.y());
      flow.ids.push_back(static_cast<std::uint32_t>(i));
    }
    return flow;
  }

 private:
  PinholeCamera camera_ = smallCamera();
  std::vector<Eigen::Vector3d> points_m_;
};

/// Steady, but for a jerk with the last frame.
std::vector<Eigen::Isometry3d> jerkyPath() {
  Vector6d steady = Vector6d::Zero(), jerk;
  steady.x() = 0.005;
  jerk << 0.02, -0.02, 0.01, 0.02, -0.03, 0.01;
  std::vector<Eigen::Isometry3d> path{Eigen::Isometry3d::Identity()};
  for (int i = 1; i < 6; ++i) path.push_back(path.back() * expSe3(steady));
  path.push_back(path.back() * expSe3(jerk));
  return path;
}

/// How far (m, rad) the last motion is from the expected one, where views are `late` frames old,
/// and what moves is masked by `mask`.
Vector6d errorAtJerk(int late, const cv::Mat& mask, bool with_corners) {
  const LeaningWall wall;
  const std::vector<Eigen::Isometry3d> path = jerkyPath();
  ExpectedMotion motion{DepthSensor()};
  Eigen::Isometry3d T_view_camera;
  int seen = 0;
  for (int i = 1; i < static_cast<int>(path.size()); ++i) {
    seen = std::max(0, i - late);
    cv::Mat depth_m = wall.depthFrom(path[i]);
    SparseFlow flow;
    if (with_corners) flow = wall.cornersBetween(i - 1, path[i - 1], i, path[i]);
    T_view_camera = motion.expect(wall.viewFrom(seen, path[seen]), wall.frameAt(i), flow, depth_m);
    motion.keep(i * kPeriod_ns, mask, depth_m);
  }
  return logSe3(T_view_camera.inverse() * path[seen].inverse() * path.back());
}

TEST(MotionPredictor, StartsFromTheViewsOwnStamp) {
  // The camera moves steadily; the views come some frames late, now and then one is missing.
  const auto poseAt = [](std::int64_t frame) {
    Eigen::Isometry3d T = Eigen::Isometry3d::Identity();
    T.linear() =
        Eigen::AngleAxisd(0.02 * static_cast<double>(frame), Eigen::Vector3d::UnitY()).matrix();
    T.translation() = T.linear() * Eigen::Vector3d(0.3, 0, 0);  // about a fixed centre
    return T;
  };
  for (const int late : {1, 2, 3}) {
    MotionPredictor predictor;
    for (std::int64_t frame = 10; frame < 30; ++frame) {
      const std::int64_t seen = (frame % 7 == 0 ? frame - 1 : frame) - late;
      ModelView view;
      view.stamp_ns = seen * kPeriod_ns;
      view.T_map_camera = poseAt(seen);
      const Eigen::Isometry3d T = predictor.predict(view, frame * kPeriod_ns);
      if (frame < 12) continue;
      const Eigen::Isometry3d truth = poseAt(seen).inverse() * poseAt(frame);
      EXPECT_LT((T.matrix() - truth.matrix()).norm(), 2e-3) << late << " " << frame;
    }
  }
}

TEST(MotionPredictor, NoMotionLeadsFromOneFragmentToAnother) {
  MotionPredictor predictor;
  ModelView view;
  for (const int fragment : {0, 1, 1}) {
    view.fragment = fragment;
    view.stamp_ns += 33;
    view.T_map_camera.translation().x() += 0.1;
    const double step = predictor.predict(view, view.stamp_ns + 33).translation().x();
    const bool is_known = view.stamp_ns == 99;
    EXPECT_NEAR(step, is_known ? 0.1 : 0.0, 1e-12) << view.stamp_ns;
  }
}

TEST(MotionPredictor, KeepsThePoseWhereNoMotionIsKnown) {
  MotionPredictor predictor;
  ModelView view;
  view.stamp_ns = 5;
  view.T_map_camera.translation() = Eigen::Vector3d(1, 2, 3);
  EXPECT_TRUE(predictor.predict(view, 6).isApprox(Eigen::Isometry3d::Identity()));
  EXPECT_TRUE(predictor.predict(view, 7).isApprox(Eigen::Isometry3d::Identity()));
}

TEST(ExpectedMotion, CornersShowAJerkHoweverOldTheViewIs) {
  for (const int late : {1, 2, 3}) {
    EXPECT_LT(errorAtJerk(late, {}, true).norm(), 2e-3) << late;
    EXPECT_GT(errorAtJerk(late, {}, false).norm(), 0.03) << late;
  }
}

TEST(ExpectedMotion, CornersOnWhatMovesDoNotCount) {
  const PinholeCamera camera = smallCamera();
  const cv::Mat all(camera.height, camera.width, CV_8UC1, cv::Scalar(255));
  EXPECT_EQ(errorAtJerk(1, all, true), errorAtJerk(1, all, false));
}

}  // namespace
}  // namespace pf
