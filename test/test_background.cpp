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

}  // namespace
}  // namespace pf
