// SPDX-License-Identifier: BSD-3-Clause
#include "posefusion/tracking/view_motion.hpp"

#include <gtest/gtest.h>

#include <opencv2/imgproc.hpp>

#include "place_scene.hpp"
#include "posefusion/map/render.hpp"

namespace pf {
namespace {

constexpr int kFrame = 8;

ModelView viewFrom(const Eigen::Isometry3d& T_map_camera) {
  SurfelRenderer renderer;
  ModelView view;
  RenderOptions options;
  options.age = SurfelAge::all;
  renderer.render(room().map, room().frame(kFrame).camera, T_map_camera, options, view);
  return view;
}

/// The view's camera stands aside of the frame's, in each direction, farther than alignment
/// reaches.
TEST(ViewMotion, MeasuresHowFarTheViewIsFromTheFrame) {
  const Eigen::Isometry3d truth = room().sequence.pose(kFrame);
  for (int axis = 0; axis < 3; ++axis) {
    Vector6d aside = Vector6d::Zero();
    aside[axis] = 0.15;
    aside[5 - axis] = 0.03;
    const Eigen::Isometry3d drawn = truth * expSe3(aside);
    const SparseMotion motion = motionFromView(room().frame(kFrame), viewFrom(drawn));
    ASSERT_TRUE(motion.found) << axis;
    EXPECT_LT(metresOff(drawn * motion.T_before_after, truth), 0.02) << axis;
    EXPECT_LT(radiansOff(drawn * motion.T_before_after, truth), 0.01) << axis;
  }
}

TEST(ViewMotion, APersonsPixelsSayNothing) {
  WorkingFrame frame = room().frame(kFrame);
  frame.levels[0].still.setTo(0);
  EXPECT_FALSE(motionFromView(frame, viewFrom(room().sequence.pose(kFrame))).found);
}

TEST(ViewMotion, IsNotFoundInABlankPicture) {
  WorkingFrame frame = room().frame(kFrame);
  frame.color.setTo(127);
  EXPECT_FALSE(motionFromView(frame, viewFrom(room().sequence.pose(kFrame))).found);
}

TEST(ViewMotion, IsNotFoundWhereNothingIsMapped) {
  const Eigen::Isometry3d away(Eigen::Translation3d(0, 0, 50));
  EXPECT_FALSE(motionFromView(room().frame(kFrame), viewFrom(away)).found);
}

}  // namespace
}  // namespace pf
