// SPDX-License-Identifier: BSD-3-Clause
// The map outlives frames of another camera, and clocks that are put right.
#include <gtest/gtest.h>

#include "mapper_scene.hpp"
#include "posefusion/map/surfel_map.hpp"
#include "posefusion/slam/mapper.hpp"

namespace pf {
namespace {

TEST_F(MapperTest, WhileAnotherCameraSendsNothingIsKnownAndNothingIsLost) {
  Mapper mapper(config());
  FrameStatus status;
  for (int i = 0; i < 5; ++i) status = mapper.process({room().frame(i).frame, {}, {}});
  const std::size_t surfels = status.surfels;
  for (int i = 5; i < 10; ++i) {
    RgbdFrame other = room().frame(i).frame;
    other.camera.cx += 3;
    status = mapper.process({other, {}, {}});
    EXPECT_EQ(status.outcome, FrameOutcome::bad_input);
    EXPECT_EQ(status.state, TrackingState::lost);
    EXPECT_TRUE(status.is_other_camera);
    EXPECT_FALSE(status.located);
    EXPECT_EQ(status.surfels, surfels);
    EXPECT_TRUE(mapper.view().empty());
    EXPECT_EQ(mapper.skip(0, FrameOutcome::blurred).state, TrackingState::lost);
  }
  RgbdFrame same = room().frame(10).frame;
  same.camera.fx *= 1 + 1e-7;  // as another calibration, or its text, has it
  status = mapper.process({same, {}, {}});
  EXPECT_EQ(status.outcome, FrameOutcome::fused) << status.detail;
  EXPECT_EQ(status.state, TrackingState::tracking);
  EXPECT_FALSE(status.is_other_camera);
}

TEST_F(MapperTest, AfterTheClockWasPutBackTheCameraIsFoundInTheSameMap) {
  Mapper mapper(config());
  FrameStatus status;
  for (int i = 20; i < 30; ++i) status = mapper.process({room().frame(i).frame, {}, {}});
  const Eigen::Vector3d place = status.T_map_camera.translation();
  const std::size_t surfels = status.surfels, frames = mapper.backEnd().frames().size();
  mapper.restartClock();
  EXPECT_TRUE(mapper.view().empty());
  EXPECT_EQ(mapper.map().size(), surfels);
  int found = -1;
  for (int i = 0; i < 20; ++i) {
    RgbdFrame frame = room().frame(29).frame;  // as it stood, at earlier times
    frame.stamp_ns = room().stamp(i);
    status = mapper.process({frame, {}, {}});
    EXPECT_NE(status.outcome, FrameOutcome::bad_input) << status.detail;
    if (found < 0 && status.located) found = i;
    if (found >= 0) {
      EXPECT_LT((status.T_map_camera.translation() - place).norm(), 0.01);
    }
  }
  EXPECT_GT(found, 0) << "a place that only looks right takes proof";
  EXPECT_GE(status.surfels, surfels);
  EXPECT_EQ(mapper.backEnd().frames().size(), frames + 20 - static_cast<std::size_t>(found));
}

TEST_F(MapperTest, WithoutAMapAClockThatWasPutBackBeginsOne) {
  Mapper mapper(config());
  mapper.process({withDepth(room().frame(5), cv::Mat::zeros(240, 320, CV_16UC1)), {}, {}});
  mapper.restartClock();
  EXPECT_EQ(mapper.process({room().frame(0).frame, {}, {}}).outcome, FrameOutcome::fused);
}

TEST_F(MapperTest, AClockThatWasPutForwardLosesNothing) {
  for (const std::int64_t step_s : {2, 3600, 40'000'000}) {
    Mapper mapper(config());
    FrameStatus status;
    for (int i = 0; i < 5; ++i) status = mapper.process({room().frame(i).frame, {}, {}});
    const std::size_t surfels = status.surfels;
    int located = 0;
    for (int i = 5; i < 25; ++i) {
      RgbdFrame frame = room().frame(i).frame;
      frame.stamp_ns += step_s * 1'000'000'000;
      status = mapper.process({frame, {}, {}});
      located += status.located ? 1 : 0;
    }
    EXPECT_GT(located, 5) << step_s;
    EXPECT_EQ(status.state, TrackingState::tracking) << step_s << status.detail;
    EXPECT_GE(status.surfels, surfels) << step_s;
  }
}

}  // namespace
}  // namespace pf
