// SPDX-License-Identifier: BSD-3-Clause
#include "posefusion/segmentation/background.hpp"

#include <gtest/gtest.h>

#include "small_camera.hpp"

namespace pf {
namespace {

/// How a frame of a plane at `seen_m` compares with the map, a wall at `wall_m`.
std::vector<Background> beforeWall(float wall_m, float seen_m, const DepthSensor& sensor) {
  RgbdFrame frame;
  frame.camera = smallCamera();
  const cv::Size size(frame.camera.width, frame.camera.height);
  frame.color = cv::Mat(size, CV_8UC3, cv::Scalar::all(100));
  const cv::Mat depth_m(size, CV_32FC1, cv::Scalar(seen_m));
  SceneGrid grid;
  sampleGrid(frame, depth_m, 40, grid);
  ModelView view;
  view.camera = frame.camera;
  view.depth_m = cv::Mat(size, CV_32FC1, cv::Scalar(wall_m));
  std::vector<Background> result;
  compareWithModel(grid, view, Eigen::Isometry3d::Identity(), sensor, result);
  return result;
}

TEST(CompareWithModel, TheSensorDecidesWhatMayBeOneSurface) {
  // A decimetre before a wall 4 m away is nothing to a Kinect and a person to a time of flight
  // camera.
  DepthSensor precise;
  precise.axial_1_m = 0.0003F;
  precise.systematic_1_m = precise.step_1_m = 0.0F;
  for (const Background cell : beforeWall(4.0F, 3.9F, DepthSensor())) {
    EXPECT_EQ(cell, Background::agrees);
  }
  for (const Background cell : beforeWall(4.0F, 3.9F, precise)) {
    EXPECT_EQ(cell, Background::nearer);
  }
  for (const Background cell : beforeWall(4.0F, 4.1F, precise)) {
    EXPECT_EQ(cell, Background::farther);
  }
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
  constexpr std::int64_t kPeriod_ns = 33333333;
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

}  // namespace
}  // namespace pf
