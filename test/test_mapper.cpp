// SPDX-License-Identifier: BSD-3-Clause
#include "posefusion/slam/mapper.hpp"

#include <gtest/gtest.h>
#include <tbb/global_control.h>

#include <cmath>
#include <limits>

#include "mapper_scene.hpp"
#include "posefusion/core/se3.hpp"
#include "posefusion/map/surfel_map.hpp"
#include "temporary_folder.hpp"

namespace pf {
namespace {

TEST_F(MapperTest, FollowsAHandHeldCamera) {
  Mapper mapper(config());
  for (int i = 0; i < 60; ++i) {
    const TrueFrame truth = room().frame(i);
    const FrameStatus status = mapper.process({truth.frame, {}, {}});
    ASSERT_EQ(status.outcome, FrameOutcome::fused) << "frame " << i;
    ASSERT_EQ(status.state, TrackingState::tracking);
    ASSERT_LT(errorM(status, truth), 0.006) << "frame " << i;
  }
}

TEST_F(MapperTest, FindsLargerStepsThroughThePyramid) {
  Mapper mapper(config());
  for (int i = 0; i < 60; i += 4) {  // an 8 Hz camera: up to 5 cm and 3 degrees a frame
    const TrueFrame truth = room().frame(i);
    const FrameStatus status = mapper.process({truth.frame, {}, {}});
    ASSERT_EQ(status.outcome, FrameOutcome::fused) << "frame " << i;
    ASSERT_LT(errorM(status, truth), 0.012) << "frame " << i;
  }
}

TEST_F(MapperTest, CovarianceIsPositiveAndSmallInARoom) {
  Mapper mapper(config());
  mapper.process({room().frame(0).frame, {}, {}});
  const FrameStatus status = mapper.process({room().frame(1).frame, {}, {}});
  const Matrix6d& C = status.covariance;
  EXPECT_LT((C - C.transpose()).norm(), 1e-9);
  for (int i = 0; i < 6; ++i) {
    EXPECT_GT(C(i, i), 0);
    EXPECT_LT(C(i, i), 4e-4) << "2 cm, 0.02 rad";
  }
}

TEST_F(MapperTest, TheSensorOfTheSettingsIsThatOfMapTrackingAndViews) {
  const auto tracked = [](const char* kind, double systematic_1_m = 0) {
    Config c = config();
    c.sensor.kind = kind;
    c.sensor.systematic_1_m = systematic_1_m;
    Mapper mapper(c);
    FrameStatus status;
    for (int i = 0; i < 3; ++i) status = mapper.process({room().frame(i).frame, {}, {}});
    EXPECT_EQ(status.outcome, FrameOutcome::fused)
        << kind << " " << systematic_1_m << ": " << status.detail;
    return status.covariance.trace();
  };
  const double kinect = tracked("auto");
  EXPECT_EQ(tracked("structured_light"), kinect);
  EXPECT_GT(tracked("auto", 0.01), 1.5 * kinect) << "its depth has less weight";
  Config stereo = config();
  stereo.sensor.kind = "active_stereo";
  EXPECT_EQ(Mapper(stereo).map().sensor().kind, DepthSensorKind::active_stereo);
}

TEST_F(MapperTest, AGapBetweenPeopleIsNotEnoughToTrackBy) {
  for (const auto& [width, outcome] :
       {std::pair{22, FrameOutcome::no_depth}, std::pair{140, FrameOutcome::fused}}) {
    Mapper mapper(config());
    for (int i = 0; i < 10; ++i) mapper.process({room().frame(i).frame, {}, {}});
    const TrueFrame truth = room().frame(10);
    cv::Mat gap(truth.frame.depth.size(), truth.frame.depth.type(), cv::Scalar(0));
    const cv::Rect seen(100, 0, width, gap.rows);
    truth.frame.depth(seen).copyTo(gap(seen));
    EXPECT_EQ(mapper.process({withDepth(truth, gap), {}, {}}).outcome, outcome)
        << width << " of 320";
  }
}

TEST_F(MapperTest, TheFarWallsOfAHallAgreeWithTheMap) {
  constexpr double kHidden_m = 5.2;
  const TemporaryFolder folder;
  const SimulatedSequence hall(
      folder.write(
          "hall.yaml",
          "base: empty_box\nrooms: [{size_m: [8.2, 7.2, 3.0], walls: plaster, lamps: [2, 2]}]\n"
          "objects:\n"
          "  - {kind: shelf, at_m: [8.0, 2.2], yaw_deg: 180, seed: 1}\n"
          "  - {kind: cabinet, at_m: [7.2, 0.25], yaw_deg: 90, size_m: [0.45, 0.9, 0.9]}\n"),
      5);
  Mapper mapper(config());
  for (int i = 0; i < hall.frameCount(); ++i) {
    TrueFrame seen = hall.frame(i);
    cv::Mat near;
    cv::compare(seen.frame.depth, kHidden_m / seen.frame.depth_unit_m, near, cv::CMP_LT);
    seen.frame.depth.setTo(0, near);
    const FrameStatus status = mapper.process({seen.frame, {}, {}});
    if (i == 0) continue;
    // One frame is as noisy as another: 3 of their standard deviations are 2 of the difference's,
    // and depth comes in steps of 0.14 m there.
    EXPECT_GT(status.tracking.inliers, 0.5 * status.tracking.candidates) << i;
    EXPECT_LT(status.tracking.seen_through, 0.05 * status.tracking.candidates) << i;
  }
}

TEST_F(MapperTest, ABareWallIsNotTrusted) {
  TrueFrame truth = room().frame(0);
  RgbdFrame wall = truth.frame;
  wall.depth = cv::Mat(240, 320, CV_32FC1, cv::Scalar(1.5));
  wall.color = cv::Mat(240, 320, CV_8UC3, cv::Scalar(128, 128, 128));
  Mapper mapper(config());
  mapper.process({wall, {}, {}});
  wall.stamp_ns += 33333333;
  EXPECT_EQ(mapper.process({wall, {}, {}}).outcome, FrameOutcome::degenerate);
}

TEST_F(MapperTest, ABodyBeforeTheLensIsNotFused) {
  Mapper mapper(config());
  for (int i = 0; i < 10; ++i) mapper.process({room().frame(i).frame, {}, {}});
  const std::size_t surfels = mapper.map().size();
  for (int i = 10; i < 20; ++i) {  // as in a fall: dark, and half a metre away
    RgbdFrame frame = room().frame(i).frame;
    frame.depth = cv::Mat(240, 320, CV_16UC1, cv::Scalar(0));
    for (int u = 40; u < 280; ++u) frame.depth.col(u).setTo(600 + u % 7);
    frame.color = frame.color * 0.2;
    EXPECT_NE(mapper.process({frame, {}, {}}).outcome, FrameOutcome::fused);
  }
  EXPECT_EQ(mapper.map().size(), surfels);
}

TEST_F(MapperTest, AFusedPersonLeavesTheMapWhereTheSegmenterFindsOne) {
  const cv::Rect person(130, 70, 60, 100);
  Mapper with_mask(config()), without_mask(config());
  RgbdFrame frame = room().frame(0).frame;
  const RgbdFrame with_person = frame;
  const auto step = [&](const cv::Mat& mask) {
    frame.stamp_ns += 33333333;
    without_mask.process({frame, {}, {}});
    return with_mask.process({frame, mask, {}, false, with_person.depth}).outcome;
  };
  for (int i = 0; i < 15; ++i) ASSERT_EQ(step({}), FrameOutcome::fused);
  cv::Mat mask = cv::Mat::zeros(frame.depth.size(), CV_8UC1);
  mask(person).setTo(255);
  frame.depth = with_person.depth.clone();
  frame.depth(person).setTo(0);
  for (int i = 0; i < 40; ++i) ASSERT_EQ(step(mask), FrameOutcome::fused);
  const auto mapped = [&](const Mapper& mapper) {
    return cv::countNonZero(mapper.view().depth_m(person));
  };
  EXPECT_GT(mapped(without_mask), person.area() * 9 / 10) << "no depth is no evidence";
  EXPECT_LT(mapped(with_mask), person.area() / 10);
  EXPECT_EQ(step(mask(person)), FrameOutcome::bad_input) << "the mask is not of the frame's size";
}

TEST_F(MapperTest, NothingToSeeAtFirstIsNoMap) {
  Mapper mapper(config());
  const TrueFrame truth = room().frame(0);
  const float nan = std::numeric_limits<float>::quiet_NaN();
  const FrameStatus status =
      mapper.process({withDepth(truth, cv::Mat(240, 320, CV_32FC1, cv::Scalar(nan))), {}, {}});
  EXPECT_EQ(status.outcome, FrameOutcome::no_depth);
  EXPECT_EQ(status.state, TrackingState::initializing);
  EXPECT_TRUE(mapper.view().empty());
}

TEST_F(MapperTest, BadInputIsNamedAndChangesNothing) {
  Mapper mapper(config());
  mapper.process({room().frame(0).frame, {}, {}});
  const TrueFrame next = room().frame(1);

  FrameStatus status = mapper.process({room().frame(0).frame, {}, {}});
  EXPECT_EQ(status.outcome, FrameOutcome::bad_input);
  EXPECT_EQ(status.detail, "its stamp is not later than that of the frame before");

  status = mapper.process({withDepth(next, cv::Mat()), {}, {}});
  EXPECT_EQ(status.detail, "there is no depth image");

  status = mapper.process({withDepth(next, cv::Mat(120, 160, CV_16UC1)), {}, {}});
  EXPECT_EQ(status.detail,
            "colour is 320x240 but depth is 160x120, expected registered images of one size");

  RgbdFrame other = next.frame;
  other.camera.fx *= 1.1;
  status = mapper.process({other, {}, {}});
  EXPECT_EQ(status.detail, "the camera (" + describe(other.camera) + ") is not that of the map (" +
                               describe(next.frame.camera) + ")");

  EXPECT_EQ(mapper.process({next.frame, {}, {}}).outcome, FrameOutcome::fused);
}

TEST_F(MapperTest, ResetStartsAnewAtThePoseGiven) {
  Mapper mapper(config());
  for (int i = 0; i < 5; ++i) mapper.process({room().frame(i).frame, {}, {}});
  Eigen::Isometry3d T = Eigen::Isometry3d::Identity();
  T.translation() << 1, 2, 3;
  mapper.reset(T);
  EXPECT_EQ(mapper.map().size(), 0U);
  const FrameStatus status = mapper.process({room().frame(0).frame, {}, {}});
  EXPECT_EQ(status.outcome, FrameOutcome::fused);
  EXPECT_TRUE(status.T_map_camera.isApprox(T));
}

TEST_F(MapperTest, DepthInMetresAndInMillimetresGiveTheSameMap) {
  Mapper millimetres(config()), metres(config());
  for (int i = 0; i < 5; ++i) {
    const TrueFrame truth = room().frame(i);
    ASSERT_EQ(truth.frame.depth.type(), CV_16UC1);
    cv::Mat depth_m;
    depthInMetres(truth.frame, 0.0, 100.0, depth_m);
    const FrameStatus a = millimetres.process({truth.frame, {}, {}});
    const FrameStatus b = metres.process({withDepth(truth, depth_m), {}, {}});
    EXPECT_TRUE(a.T_map_camera.matrix() == b.T_map_camera.matrix());
  }
  EXPECT_EQ(millimetres.map().collect().z, metres.map().collect().z);
}

TEST_F(MapperTest, GivesTheSameBitsForAnyNumberOfThreads) {
  Mapper mappers[2] = {Mapper(config()), Mapper(config())};
  for (int k = 0; k < 2; ++k) {
    tbb::global_control limit(tbb::global_control::max_allowed_parallelism, k == 0 ? 1 : 4);
    for (int i = 0; i < 12; ++i) mappers[k].process({room().frame(i).frame, {}, {}});
  }
  EXPECT_TRUE(mappers[0].view().T_map_camera.matrix() == mappers[1].view().T_map_camera.matrix());
  EXPECT_EQ(mappers[0].map().collect().x, mappers[1].map().collect().x);
  EXPECT_EQ(mappers[0].map().collect().odds, mappers[1].map().collect().odds);
}

TEST_F(MapperTest, RenderedDepthAgreesWithTheTruth) {
  Mapper mapper(config());
  FrameStatus status;
  for (int i = 0; i < 20; ++i) status = mapper.process({room().frame(i).frame, {}, {}});
  const SimulatedSequence exact("empty_box", 20, {"depth.noise=false"});
  const RgbdFrame truth = exact.frame(19).frame;
  cv::Mat true_depth;
  depthInMetres(truth, 0.0, 100.0, true_depth);
  const ModelView view = mapper.render(truth.camera, status.T_map_camera);
  std::vector<float> differences;
  for (int v = 0; v < 240; ++v) {
    for (int u = 0; u < 320; ++u) {
      const float z = view.depth_m.at<float>(v, u);
      const float exact_z = true_depth.at<float>(v, u);
      if (z > 0 && exact_z > 0) differences.push_back(std::abs(z - exact_z));
    }
  }
  ASSERT_GT(differences.size(), 60000U);
  std::nth_element(differences.begin(), differences.begin() + differences.size() / 2,
                   differences.end());
  EXPECT_LT(differences[differences.size() / 2], 0.01);
}

}  // namespace
}  // namespace pf
