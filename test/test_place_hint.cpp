// SPDX-License-Identifier: BSD-3-Clause
// A user's hint of the place of a lost camera.
#include <gtest/gtest.h>

#include <cmath>
#include <limits>

#include "mapper_scene.hpp"
#include "posefusion/core/error.hpp"
#include "posefusion/loop/worker.hpp"
#include "posefusion/map/surfel_map.hpp"

namespace pf {
namespace {

using Eigen::Isometry3d;
using Eigen::Vector3d;

class PlaceHintTest : public MapperTest {
 protected:
  void SetUp() override {
    for (int i = 0; i < 10; ++i) mapper.process({room().frame(i).frame, {}, {}});
    T_last = mapper.backEnd().graph().keyframes().back().T_map_camera;
  }
  /// Sees nothing until it is lost.
  void lose() {
    const cv::Mat nothing = cv::Mat::zeros(240, 320, CV_16UC1);
    FrameStatus status;
    while (next < 50 && status.state != TrackingState::lost) {
      status = mapper.process({withDepth(room().frame(next++), nothing), {}, {}});
    }
    ASSERT_EQ(status.state, TrackingState::lost);
    mapper.takeQuestion();
  }
  /// Where a camera is searched for beside its last pose.
  std::vector<MapPose> lookedAt() {
    RgbdFrame frame = room().frame(9).frame;
    frame.stamp_ns = room().stamp(next++);
    mapper.process({frame, {}, {}});
    const auto question = mapper.takeQuestion();
    EXPECT_TRUE(question && question->place);
    LoopAnswer nowhere;
    nowhere.asked_for_place = true;
    mapper.take(nowhere);
    return question && question->place ? question->place->elsewhere : std::vector<MapPose>();
  }
  /// The camera `ahead_m` before its last pose, 3 m too high and turned, as a user gives it by
  /// pointing at a plan.
  Isometry3d pointed(double x_m, double y_m) const {
    return Eigen::Translation3d(x_m, y_m, 3) * Eigen::AngleAxisd(0.7, Vector3d::UnitZ()) *
           bodyFromOptical();
  }

  Mapper mapper{config()};
  Isometry3d T_last;
  int next = 10;
};

TEST_F(PlaceHintTest, ALostCameraIsLookedForThereTooWithHeightAndTiltOfTheNearestKeyframe) {
  lose();
  EXPECT_TRUE(lookedAt().empty());
  EXPECT_EQ(mapper.hint(pointed(1.5, -2)), "the camera is looked for there too");
  const auto places = lookedAt();
  ASSERT_EQ(places.size(), 1U);
  EXPECT_EQ(places[0].fragment, kFirstFragment);
  const Isometry3d T_world = mapper.worldFromMap() * places[0].T_map_camera;
  const Isometry3d T_keyframe = mapper.worldFromMap() * T_last;
  EXPECT_NEAR(T_world.translation().x(), 1.5, 1e-9);
  EXPECT_NEAR(T_world.translation().y(), -2, 1e-9);
  EXPECT_NEAR(T_world.translation().z(), T_keyframe.translation().z(), 1e-9);
  const Vector3d ahead = T_world.linear().col(2);
  EXPECT_NEAR(std::atan2(ahead.y(), ahead.x()), 0.7, 1e-9);
  EXPECT_NEAR(ahead.z(), T_keyframe.linear()(2, 2), 1e-9) << "tilt";
  EXPECT_EQ(lookedAt().size(), 1U) << "until it is found";
}

TEST_F(PlaceHintTest, AWrongPlaceIsRejected) {
  lose();
  mapper.hint(pointed(40, 40));
  LoopWorker worker(config().loop, config().tracking, DepthSensor());
  bool found = false;
  for (; next < 60 && !found; ++next) {
    RgbdFrame frame = room().frame(9).frame;
    frame.stamp_ns = room().stamp(next);
    const FrameStatus status = mapper.process({frame, {}, {}});
    if (const auto question = mapper.takeQuestion()) mapper.take(worker.answer(*question));
    found = status.located;
    if (found) {
      EXPECT_LT(errorM(status, room().frame(9)), 0.05);
    }
  }
  EXPECT_TRUE(found) << "it is where it was";
  EXPECT_EQ(mapper.hint(pointed(1, 1)), "the camera is not lost: nothing changes");
}

TEST_F(PlaceHintTest, AHintThatCannotHelpIsRefused) {
  EXPECT_EQ(mapper.hint(pointed(1, 1)), "the camera is not lost: nothing changes");
  Isometry3d T = pointed(1, 1);
  T.translation().x() = std::numeric_limits<double>::quiet_NaN();
  EXPECT_THROW(mapper.hint(T), InputError);
  Mapper empty(config());
  EXPECT_THROW(empty.hint(pointed(1, 1)), InputError);
}

TEST_F(PlaceHintTest, AnotherMapDoesNotKeepIt) {
  lose();
  mapper.hint(pointed(1, 1));
  mapper.reset();
  next = 10;
  for (int i = 0; i < 10; ++i) mapper.process({room().frame(i).frame, {}, {}});
  lose();
  EXPECT_TRUE(lookedAt().empty());
}

}  // namespace
}  // namespace pf
