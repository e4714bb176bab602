// SPDX-License-Identifier: BSD-3-Clause
#include <gtest/gtest.h>

#include "place_scene.hpp"
#include "posefusion/graph/expected_place.hpp"
#include "posefusion/loop/verify.hpp"

namespace pf {
namespace {

TEST(VerifyPlace, TheTruePlaceIsMadeExactAndAccepted) {
  const Eigen::Isometry3d truth = room().sequence.pose(8);
  Vector6d off;
  off << 0.05, -0.03, 0.05, 0.03, 0.05, -0.02;
  PlaceVerifier verifier{TrackingConfig{}};
  const PlaceVerdict verdict =
      verifier.verify(room().map, room().frame(8), {0, truth * expSe3(off)});
  EXPECT_TRUE(verdict.accepted()) << name(verdict.doubt);
  EXPECT_LT(metresOff(verdict.alignment.T_map_camera, truth), 0.02);
  EXPECT_LT(radiansOff(verdict.alignment.T_map_camera, truth), 0.02);
}

TEST(VerifyPlace, APositionThatIsHardlyKnownIsRejected) {
  PlaceVerdict verdict;
  verdict.alignment.converged = true;
  verdict.agreement = {1.0, 1.0, 0.0, 0.0, 1.0, 0.2};
  for (const double sigma_m : {0.005, 0.04}) {
    verdict.alignment.covariance(1, 1) = sigma_m * sigma_m;
    EXPECT_DOUBLE_EQ(positionSigma(verdict.alignment.covariance), sigma_m);
    judgePlace(verdict, TrackingConfig{});
    EXPECT_EQ(verdict.doubt, sigma_m < 0.01 ? PlaceDoubt::none : PlaceDoubt::degenerate);
  }
}

TEST(VerifyPlace, TheSurerAPlaceMustBeTheFewerAreAccepted) {
  PlaceVerdict verdict;
  verdict.alignment.converged = true;
  verdict.agreement = {0.5, 0.9, 0.01, 0.1, 0.8, 0.05};
  verdict.alignment.covariance = independentCovariance(0.005, 0.003);
  TrackingConfig config;
  bool before = true;
  int accepted = 0;
  for (const double sure : {0.5, 0.9, 0.99, 0.999, 0.999999}) {
    config.sure_to_return = sure;
    judgePlace(verdict, config);
    EXPECT_TRUE(before || !verdict.accepted());
    EXPECT_EQ(verdict.accepted(), verdict.log_odds >= logOdds(sure));
    before = verdict.accepted();
    accepted += before ? 1 : 0;
  }
  EXPECT_GT(accepted, 0);
}

TEST(VerifyPlace, ATruePlaceIsRejectedThroughAGap) {
  TrueFrame truth = room().sequence.frame(8);
  PlaceVerifier verifier{TrackingConfig{}};
  for (const double open : {0.8, 0.12}) {
    const int covered = static_cast<int>((1.0 - open) * truth.frame.depth.cols);
    truth.frame.depth.colRange(0, covered).setTo(0);
    WorkingFrame frame;
    frame.assign(truth.frame, cv::Mat(), FrameConfig{});
    const PlaceVerdict verdict = verifier.verify(room().map, frame, {0, truth.T_map_camera});
    EXPECT_EQ(verdict.accepted(), open > 0.5) << name(verdict.doubt);
  }
}

TEST(VerifyPlace, NoWrongPlaceIsAccepted) {
  const WorkingFrame frame = room().frame(8);
  const Eigen::Isometry3d truth = room().sequence.pose(8);
  PlaceVerifier verifier{TrackingConfig{}};
  int wrong = 0;
  for (const double turn : {-0.7, -0.4, 0.4, 0.7}) {
    for (const double shift : {-0.4, 0.0, 0.4}) {
      const PlaceVerdict v = verifier.verify(room().map, frame, {0, afterFall(truth, turn, shift)});
      const bool is_true = metresOff(v.alignment.T_map_camera, truth) < 0.1 &&
                           radiansOff(v.alignment.T_map_camera, truth) < 0.05;
      EXPECT_TRUE(is_true || !v.accepted()) << turn << " " << shift;
      wrong += is_true ? 0 : 1;
    }
  }
  EXPECT_GT(wrong, 4);
}

TEST(VerifyPlace, SeesWhenTheMapsSurfacesAreGone) {
  // A frame whose walls stand half a metre farther sees through the map.
  TrueFrame truth = room().sequence.frame(8);
  cv::add(truth.frame.depth, 500, truth.frame.depth, truth.frame.depth > 0);  // mm
  WorkingFrame frame;
  frame.assign(truth.frame, cv::Mat(), FrameConfig{});
  ModelView view;
  RenderOptions options;
  options.age = SurfelAge::all;
  SurfelRenderer().render(room().map, frame.camera, truth.T_map_camera, options, view);
  const ViewAgreement agreement = compareViews(frame, view);
  EXPECT_GT(agreement.seen_through, 0.8);
  EXPECT_LT(agreement.agreeing, 0.1);
}

/// Two rooms that are the same.
TEST(VerifyPlace, OfAlikePlacesTheOneThatIsExpectedIsAccepted) {
  Eigen::Isometry3d T_other_room = Eigen::Isometry3d::Identity();
  T_other_room.translation().x() = 12;
  SurfelMap both(MappedRoom::stableAtOnce());
  Fuser fuser;
  for (int i = 0; i < room().sequence.frameCount(); ++i) {
    for (const auto& T : {Eigen::Isometry3d::Identity(), T_other_room}) {
      fuser.fuse(room().frame(i), T * room().sequence.pose(i), both);
    }
  }
  std::vector<PlaceCandidate> candidates(2);
  candidates[0].pose = {0, room().sequence.pose(8)};
  candidates[1].pose = {0, T_other_room * room().sequence.pose(8)};
  PlaceVerifier verifier{TrackingConfig{}};
  EXPECT_EQ(verifier.verifyBest(both, room().frame(8), candidates).doubt, PlaceDoubt::ambiguous);
  PoseGraph graph((GraphConfig()));
  Keyframe last;
  last.T_map_camera = T_other_room * room().sequence.pose(0);
  graph.addKeyframe(last);
  PoseConstraint reckoned;
  reckoned.from = 0;
  for (const double sigma_m : {0.5, 10.0}) {
    reckoned.covariance = independentCovariance(sigma_m, sigma_m);
    const ExpectedPlace expected(graph, reckoned);
    const PlaceVerdict verdict =
        verifier.verifyBest(both, room().frame(8), candidates, 6, &expected);
    EXPECT_EQ(verdict.accepted(), sigma_m < 1) << "an uncertain prior decides nothing";
    EXPECT_LT(metresOff(verdict.alignment.T_map_camera, candidates[1].pose.T_map_camera), 0.05);
  }
}

}  // namespace
}  // namespace pf
