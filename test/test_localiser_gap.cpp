// SPDX-License-Identifier: BSD-3-Clause
// The localiser where people leave little of the view.
#include <gtest/gtest.h>

#include "fusion_scene.hpp"
#include "posefusion/map/render.hpp"
#include "posefusion/slam/localiser.hpp"
#include "small_camera.hpp"

namespace pf {
namespace {

/// A camera that stands before a wall without a picture, of which people leave a part, and a few
/// corners that are new in every frame: along the wall it is known by them alone.
class LocaliserGapTest : public ::testing::Test {
 protected:
  /// So many frames; ends with the first that is rejected.
  Location look(int frames, const cv::Rect& gap) {
    show(gap);
    fuseOften(20, frame_, map_);
    Location location = localiser_.begin(frame_, 0, {kFirstFragment, kIdentity});
    for (int i = 1; i <= frames && location.outcome == FrameOutcome::fused; ++i) {
      location = see(last_ = i, gap);
    }
    return location;
  }
  /// `walking` more corners move on alike, by `walk_px`.
  Location see(int i, const cv::Rect& gap, int walking = 0, const cv::Point2f& walk_px = {},
               bool forced = false) {
    SparseFlow flow{kStep_ns * (i - 1), kStep_ns * i, {}, {}, {}};
    for (int k = 0; k < walking + kCorners; ++k) {
      const cv::Point2f at(static_cast<float>(gap.x + 3 + (k * 7) % (gap.width - 6)),
                           static_cast<float>(gap.y + 3 + (k * 11) % (gap.height - 6)));
      flow.before.push_back(at);
      flow.after.push_back(k < walking ? at + walk_px : at);
      flow.ids.push_back(static_cast<std::uint32_t>(2 * kCorners * i + k));
    }
    SurfelRenderer().render(map_, frame_.camera, kIdentity, {}, view_);
    points_.assign(view_, frame_.sensor);
    return localiser_.locate(frame_, flow.to_ns, flow, forced, view_,
                             {[&](const Eigen::Isometry3d&) {
                                return RenderedModel{points_, kIdentity};
                              },
                              [&](const Eigen::Isometry3d&) -> const ModelView& { return view_; }});
  }

  /// The wall in this part of the picture, and nothing elsewhere.
  void show(const cv::Rect& gap, const cv::Rect& person = {}) {
    RgbdFrame frame{0, cv::Mat(120, 160, CV_8UC3, cv::Scalar(90, 90, 90)),
                    cv::Mat::zeros(120, 160, CV_32FC1), 1e-3, smallCamera()};
    frame.depth(gap).setTo(2.0F);
    frame.depth(person).setTo(1.0F);
    frame_.assign(frame, cv::Mat(), fullResolution());
  }

  static constexpr int kCorners = 14, kFrames = 300;
  static constexpr std::int64_t kStep_ns = 33333333;
  SurfelMap map_{MapConfig()};
  Localiser localiser_{TrackingConfig()};
  WorkingFrame frame_;
  ModelView view_;
  ModelPyramid points_;
  int last_ = 0;  ///< frame
};

TEST_F(LocaliserGapTest, IsRejectedWhereItIsKnownByALongChainOfCornersAlone) {
  const Location location = look(kFrames, {40, 20, 70, 80});
  EXPECT_EQ(location.outcome, FrameOutcome::degenerate) << location.detail;
  EXPECT_NE(location.detail.find("0.03"), std::string::npos) << location.detail;
}

TEST_F(LocaliserGapTest, AnOpenViewIsAccepted) {
  const Location location = look(kFrames, {0, 0, 160, 120});
  EXPECT_EQ(location.outcome, FrameOutcome::fused) << location.detail;
}

TEST_F(LocaliserGapTest, OfTwoMotionsThatAsManyCornersShowTheSteadyOneIsBelieved) {
  const cv::Rect gap(0, 0, 160, 120);
  look(5, gap);
  const Localiser before = localiser_;
  for (const cv::Point2f& walk_px : {cv::Point2f(3, 1), {-3, 1}, {1, 3}, {-4, -2}, {2, -3}}) {
    localiser_ = before;
    const Location location = see(6, gap, kCorners, walk_px);
    ASSERT_TRUE(location.motion.found);
    EXPECT_LT(location.motion.T_before_after.translation().norm(), 0.005) << walk_px;
  }
}

TEST_F(LocaliserGapTest, CornersOnAPersonBeforeTheMapAreLeftOutAfterABlurredFrameToo) {
  const cv::Rect gap(0, 0, 160, 120), person(90, 0, 70, 120);
  look(5, gap);
  const int all = see(++last_, gap, kCorners).motion.matches;
  show(gap, person);
  see(++last_, gap, kCorners, {}, true);
  const SparseMotion motion = see(++last_, gap, kCorners).motion;
  ASSERT_TRUE(motion.found);
  EXPECT_LT(motion.matches, 0.7 * all);
}

TEST_F(LocaliserGapTest, TheWayThatALostCameraWasCarriedDoesNotTellItsPlace) {
  const cv::Rect gap(40, 20, 70, 80);
  Location location = look(kFrames, gap);
  for (int i = 0; i < 60 && location.state != TrackingState::lost; ++i) {
    location = see(++last_, gap);
  }
  const double before_m = positionSigma(location.tracking.covariance);
  location = see(++last_, gap);
  ASSERT_EQ(location.state, TrackingState::lost);
  EXPECT_GT(positionSigma(location.tracking.covariance), 2 * before_m);
}

}  // namespace
}  // namespace pf
