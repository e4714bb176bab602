// SPDX-License-Identifier: BSD-3-Clause
#include "posefusion/slam/localiser.hpp"

#include <gtest/gtest.h>

#include <cmath>

#include "fusion_scene.hpp"
#include "mapper_scene.hpp"
#include "posefusion/core/se3.hpp"
#include "posefusion/map/fusion.hpp"
#include "posefusion/map/render.hpp"
#include "simulated_sequence.hpp"

namespace pf {
namespace {

TEST_F(MapperTest, ATurnIntoTheUnknownWithoutASharpFrameIsFollowed) {
  // From one end of the swing to the other.
  constexpr int kStart = 24, kSharp = kStart + 3, kTurned = 72;
  const SimulatedSequence turn("empty_box", kTurned + 6,
                               {"depth.distortion=0", "camera.at_m=[2.1, 1.8, 1.35]",
                                "camera.look_at_m=[2.4, 1.8, 1.3]", "camera.period_s=0.8"});
  EXPECT_GT(angleOf(turn.pose(kStart).inverse() * turn.pose(kTurned)), 1.3);
  Mapper mapper(config());
  mapper.reset(turn.pose(kStart));
  std::size_t mapped = 0;
  for (int i = kStart; i < turn.frameCount(); ++i) {
    const TrueFrame truth = turn.frame(i);
    const bool forced = i >= kSharp && i < kTurned;
    StaticFrame input{truth.frame, {}, {}};
    input.forced = forced;
    const FrameStatus status = mapper.process(input);
    EXPECT_EQ(status.outcome, forced ? FrameOutcome::forced : FrameOutcome::fused) << "frame " << i;
    EXPECT_TRUE(status.located);
    EXPECT_LT(errorM(status, truth), 0.03) << "frame " << i;
    if (i == kSharp) mapped = status.surfels;
    if (forced) {
      EXPECT_EQ(status.surfels, mapped) << "nothing blurred is fused";
    }
  }
}

TEST_F(MapperTest, BlurredFramesProveNothingAndBreakNoProof) {
  for (const bool all_blurred : {false, true}) {
    Mapper mapper(config());
    for (int i = 0; i < 20; ++i) mapper.process({room().frame(i).frame, {}, {}});
    FrameStatus status;
    for (int i = 20; i < 30; ++i) {
      const cv::Mat covered = cv::Mat::zeros(240, 320, CV_16UC1);
      status = mapper.process({withDepth(room().frame(i), covered), {}, {}});
    }
    ASSERT_EQ(status.state, TrackingState::lost);
    int frames = 0;
    for (; frames < 24 && status.state == TrackingState::lost; ++frames) {
      StaticFrame input{room().frame(20).frame, {}, {}};
      input.frame.stamp_ns = room().stamp(31 + frames);
      input.forced = all_blurred || frames % 2 == 1;
      status = mapper.process(input);
    }
    EXPECT_EQ(status.state == TrackingState::lost, all_blurred) << frames;
  }
}

TEST_F(MapperTest, IsLostAfterAWhileAndComesBackWhereItWas) {
  Mapper mapper(config());
  for (int i = 0; i < 20; ++i) mapper.process({room().frame(i).frame, {}, {}});
  const std::size_t surfels = mapper.map().size();
  FrameStatus status;
  for (int i = 20; i < 30; ++i) {  // something covers the camera
    const TrueFrame truth = room().frame(i);
    status = mapper.process({withDepth(truth, cv::Mat::zeros(240, 320, CV_16UC1)), {}, {}});
    EXPECT_EQ(status.outcome, FrameOutcome::no_depth);
  }
  EXPECT_EQ(status.state, TrackingState::lost);
  EXPECT_EQ(mapper.map().size(), surfels) << "nothing was fused meanwhile";
  const TrueFrame truth = room().frame(20);  // back near the last good pose
  RgbdFrame frame = truth.frame;
  int proofs = 0;
  for (; status.state != TrackingState::tracking && proofs < 15; ++proofs) {
    frame.stamp_ns = room().stamp(40 + proofs);
    status = mapper.process({frame, {}, {}});
    if (status.state == TrackingState::tracking) break;
    EXPECT_EQ(status.outcome, FrameOutcome::unproven) << status.detail;
    EXPECT_FALSE(status.located);
    EXPECT_EQ(mapper.map().size(), surfels) << "nothing is fused before it is proven";
  }
  EXPECT_EQ(status.state, TrackingState::tracking);
  EXPECT_GE(proofs, 5) << "one good frame is no proof";
  EXPECT_LT(errorM(status, truth), 0.006);
}

TEST_F(MapperTest, WhileLostAFrameThatSeesThroughTheMapIsNotFused) {
  Mapper mapper(config());
  for (int i = 0; i < 20; ++i) mapper.process({room().frame(i).frame, {}, {}});
  FrameStatus status;
  for (int i = 20; i < 32; ++i) {
    const cv::Mat nothing = cv::Mat::zeros(240, 320, CV_16UC1);
    status = mapper.process({withDepth(room().frame(i), nothing), {}, {}});
  }
  ASSERT_EQ(status.state, TrackingState::lost);
  const std::size_t surfels = mapper.map().size();
  RgbdFrame frame = room().frame(20).frame;
  frame.depth = frame.depth.clone();
  // What the map has in the right part is gone: enough agrees to track on, not enough to come back.
  cv::Mat emptied = frame.depth.colRange(180, 320);
  cv::add(emptied, cv::Scalar(300), emptied, emptied > 0);
  for (int k = 0; k < 12; ++k) {
    frame.stamp_ns = room().stamp(40 + k);
    status = mapper.process({frame, {}, {}});
    EXPECT_EQ(status.state, TrackingState::lost);
    EXPECT_NE(status.outcome, FrameOutcome::fused) << k;
  }
  EXPECT_EQ(mapper.map().size(), surfels);
}

/// A step of a camera in a mapped room that no corner measures.
class LocaliserStepTest : public MapperTest {
 protected:
  void SetUp() override {
    Fuser fuser;
    for (int i = 0; i <= kFirst; ++i) fuser.fuse(frameAt(i), room().frame(i).T_map_camera, map_);
    localiser_.begin(frameAt(kFirst), room().frame(kFirst).frame.stamp_ns,
                     {kFirstFragment, room().frame(kFirst).T_map_camera});
  }
  const WorkingFrame& frameAt(int i) {
    frame_.assign(room().frame(i).frame, cv::Mat(), config().frame);
    return frame_;
  }
  const ModelView& viewFrom(const Eigen::Isometry3d& T) {
    SurfelRenderer().render(map_, frame_.camera, T, {}, view_);
    return view_;
  }
  /// Some frames on; `shows`: depth of the map as the strict test sees it, times this.
  Location step(double shows, const SparseFlow& flow = {}, bool forced = false) {
    const WorkingFrame& frame = frameAt(kFirst + kStep);
    MapRenderers render;
    render.model = [this](const Eigen::Isometry3d& T) {
      points_.assign(viewFrom(T), frame_.sensor);
      return RenderedModel{points_, T};
    };
    render.view = [this, shows](const Eigen::Isometry3d& T) -> const ModelView& {
      viewFrom(T);
      view_.depth_m *= shows;
      return view_;
    };
    return localiser_.locate(frame, room().frame(kFirst + kStep).frame.stamp_ns, flow, forced,
                             view_, render);
  }
  /// The corners' way from the first frame into another one, as if that were the next.
  static SparseFlow flowTo(int i) {
    FlowTracker tracker;
    tracker.advance(room().frame(kFirst).frame);
    RgbdFrame next = room().frame(i).frame;
    next.stamp_ns = room().frame(kFirst + kStep).frame.stamp_ns;
    return tracker.advance(next);
  }

  static constexpr int kFirst = 20, kStep = 8;
  SurfelMap map_{config().map};
  Localiser localiser_{config().tracking};
  WorkingFrame frame_;
  ModelView view_;
  ModelPyramid points_;
};

TEST_F(LocaliserStepTest, IsAcceptedWhereTheMapAgrees) {
  const Location location = step(1.0);
  EXPECT_EQ(location.outcome, FrameOutcome::fused) << location.detail;
}

TEST_F(LocaliserStepTest, IsRejectedWithTrackingAlone) {
  const Location location = step(1.5);
  EXPECT_EQ(location.outcome, FrameOutcome::jumped) << location.detail;
}

TEST_F(LocaliserStepTest, OfABlurredFrameIsReportedUnlessCornersContradict) {
  const Localiser before = localiser_;
  const Location location = step(1.0, flowTo(kFirst + kStep), true);
  ASSERT_TRUE(location.motion.found);
  EXPECT_EQ(location.outcome, FrameOutcome::forced);
  EXPECT_TRUE(location.located);
  localiser_ = before;
  const Location contradicted = step(1.0, flowTo(kFirst), true);
  ASSERT_TRUE(contradicted.motion.found);
  EXPECT_FALSE(contradicted.located) << "corners show no motion";
}

/// A camera in a room of which the map shows nothing any more.
class LocaliserLossTest : public MapperTest {
 protected:
  Location see(int i, const SparseFlow& flow) {
    const TrueFrame truth = room().frame(i);
    frame_.assign(truth.frame, cv::Mat(), config().frame);
    if (i == 0) return localiser_.begin(frame_, truth.frame.stamp_ns, {0, truth.T_map_camera});
    return localiser_.locate(
        frame_, truth.frame.stamp_ns, flow, false, nothing_,
        {[&](const Eigen::Isometry3d& T) {
           return RenderedModel{points_, T};
         },
         [&](const Eigen::Isometry3d&) -> const ModelView& { return nothing_; }});
  }

  Localiser localiser_{config().tracking};
  WorkingFrame frame_;
  ModelView nothing_;
  ModelPyramid points_;
};

TEST_F(LocaliserLossTest, TheWayThroughALossIsKnownWhileCornersMeasureIt) {
  FlowTracker flow;
  Location location;
  constexpr int kLast = 24;
  for (int i = 0; i <= kLast; ++i) location = see(i, flow.advance(room().frame(i).frame));
  ASSERT_EQ(location.state, TrackingState::lost);
  EXPECT_TRUE(location.carried.is_measured);
  const Eigen::Isometry3d truth = room().frame(kLast).T_map_camera;
  const Eigen::Isometry3d off = truth.inverse() * location.carried.T_map_camera;
  EXPECT_LT(off.translation().norm(), 0.03);
  EXPECT_LT(angleOf(off), 0.02);
  const double sigma_m = std::sqrt(location.carried.covariance.topLeftCorner<3, 3>().trace());
  EXPECT_LT(off.translation().norm(), 3 * sigma_m) << "the covariance covers the error";

  EXPECT_FALSE(see(kLast + 1, {}).carried.is_measured);
  location = see(kLast + 2, flow.advance(room().frame(kLast + 2).frame));
  EXPECT_FALSE(location.carried.is_measured) << "one unknown step is enough";
}

}  // namespace
}  // namespace pf
