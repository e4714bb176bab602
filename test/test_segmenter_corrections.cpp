// SPDX-License-Identifier: BSD-3-Clause
// Corrections of the map move the camera in it, which is no motion of objects.
#include <gtest/gtest.h>

#include "segmenter_scene.hpp"

namespace pf {
namespace {

constexpr float kWall_m = 3.0F, kBox_m = 2.0F;

/// A camera that rests before a mapped wall. `box`: of the picture, nearer than the wall.
class Watched {
 public:
  Watched() {
    view_.camera = kCamera;
    view_.depth_m = cv::Mat(480, 640, CV_32FC1, cv::Scalar(kWall_m));
    view_.T_world_map = Eigen::Isometry3d::Identity();
  }

  Segmentation see(const cv::Rect& box) {
    RgbdFrame frame;
    frame.camera = kCamera;
    frame.stamp_ns = view_.stamp_ns + kFrame_ns;
    frame.color = cv::Mat(480, 640, CV_8UC3, cv::Scalar::all(100));
    frame.depth = cv::Mat(480, 640, CV_32FC1, cv::Scalar(kWall_m));
    frame.depth(box).setTo(kBox_m);
    frame.depth_unit_m = 1.0;
    Segmentation result = segmenter_.segment(frame, {frame.stamp_ns, true, {}}, &view_);
    view_.stamp_ns = frame.stamp_ns;
    return result;
  }

  void know(const cv::Rect& box) { view_.depth_m(box).setTo(kBox_m); }

  /// The map, and the camera with it, are moved.
  void correct(const Eigen::Isometry3d& T_new_old) {
    view_.T_map_camera = T_new_old * view_.T_map_camera;
    view_.T_map_uncorrected = T_new_old * view_.T_map_uncorrected;
  }

 private:
  SegmenterChain segmenter_;
  ModelView view_;
};

Eigen::Isometry3d correction() {
  Eigen::Isometry3d T = Eigen::Isometry3d::Identity();
  T.translation() << 0.12, -0.06, 0.03;
  T.linear() = Eigen::AngleAxisd(0.02, Eigen::Vector3d::UnitY()).toRotationMatrix();
  return T;
}

TEST(SegmenterCorrections, WhatStandsStillIsNotMaskedWhereTheMapIsCorrected) {
  const cv::Rect box(250, 180, 140, 140);
  Watched room;
  room.know(box);
  for (int i = 0; i < 60; ++i) {
    if (i % 20 == 19) room.correct(correction());
    const cv::Mat mask = room.see(box).mask;
    ASSERT_TRUE(mask.empty() || cv::countNonZero(mask) == 0) << i;
  }
}

TEST(SegmenterCorrections, WhatMovesKeepsItsVelocityAndIsReportedInTheCorrectedMap) {
  // 5 px a frame at 2 m: 0.571 m/s to the right.
  const double speed_m_s = 5 * kBox_m / kCamera.fx * 30;
  Watched room;
  std::vector<MovingObject> before, after;
  for (int i = 0; i < 60; ++i) {
    if (i == 50) room.correct(correction());
    const auto moving = room.see({60 + 5 * std::max(0, i - 20), 180, 140, 140}).moving;
    if (i == 49) before = moving;
    if (i == 50) after = moving;
  }
  ASSERT_EQ(before.size(), 1U);
  ASSERT_EQ(after.size(), 1U);
  EXPECT_EQ(before[0].id, after[0].id);
  const Eigen::Vector3d moved = correction() * before[0].centre_m.cast<double>();
  EXPECT_NEAR((after[0].centre_m.cast<double>() - moved).norm(), speed_m_s / 30, 0.02);
  const Eigen::Vector3d velocity = correction().linear() * before[0].velocity_m_s.cast<double>();
  EXPECT_NEAR((after[0].velocity_m_s.cast<double>() - velocity).norm(), 0.0, 0.05);
}

}  // namespace
}  // namespace pf
