// SPDX-License-Identifier: BSD-3-Clause
#include "posefusion/loop/place_search.hpp"

#include <gtest/gtest.h>
#include <tbb/global_control.h>

#include "posefusion/core/se3.hpp"
#include "posefusion/loop/verify.hpp"
#include "posefusion/loop/worker.hpp"
#include "posefusion/map/fusion.hpp"
#include "simulated_sequence.hpp"

namespace pf {
namespace {

/// The small room, mapped at its true poses.
struct MappedRoom {
  SimulatedSequence sequence{"empty_box", 12};
  SurfelMap map{stableAtOnce()};
  MapPoints points;
  Eigen::Vector3d up;

  static MapConfig stableAtOnce() {
    MapConfig config;
    config.stable_confidence = 2;
    return config;
  }

  MappedRoom() {
    Fuser fuser;
    for (int i = 0; i < sequence.frameCount(); ++i) fuser.fuse(frame(i), sequence.pose(i), map);
    points = thinnedPoints(map);
    const auto levels = findLevels(orientedPoints(points), -Eigen::Vector3d::UnitY(), 0.9);
    up = levels ? levels->up : Eigen::Vector3d(0, 0, 0);
  }

  WorkingFrame frame(int index) const {
    WorkingFrame working;
    working.assign(sequence.frame(index).frame, cv::Mat(), FrameConfig{});
    return working;
  }
};

const MappedRoom& room() {
  static const MappedRoom mapped;
  return mapped;
}

/// `T` turned about the vertical and shifted horizontally, as by a fall.
Eigen::Isometry3d afterFall(const Eigen::Isometry3d& T, double turn_rad, double shift_m) {
  Eigen::Isometry3d moved = T;
  const Eigen::Vector3d up = room().up;
  moved.linear() = Eigen::AngleAxisd(turn_rad, up).toRotationMatrix() * T.linear();
  const Eigen::Vector3d ahead = T.linear().col(2);
  moved.translation() += shift_m * (ahead - ahead.dot(up) * up).normalized();
  return moved;
}

double metresOff(const Eigen::Isometry3d& a, const Eigen::Isometry3d& b) {
  return (a.translation() - b.translation()).norm();
}

double radiansOff(const Eigen::Isometry3d& a, const Eigen::Isometry3d& b) {
  return logSo3(a.linear().transpose() * b.linear()).norm();
}

TEST(Levels, UpIsThatOfTheRoom) {
  // The camera of the small room looks a little down: up is not the picture's up.
  const auto frame_levels = placeQuery(room().frame(11));
  ASSERT_TRUE(frame_levels.floor);
  const Eigen::Vector3d seen = room().sequence.pose(11).linear() * frame_levels.floor->up;
  EXPECT_GT(seen.dot(room().up), std::cos(0.035));
}

TEST(Levels, NoneWhereNothingFacesUp) {
  const std::vector<float> zero(100, 0.0F), one(100, 1.0F);
  const OrientedPoints wall{zero.data(), zero.data(), one.data(), zero.data(),
                            zero.data(), one.data(),  100};
  EXPECT_FALSE(findLevels(wall, Eigen::Vector3d::UnitY(), 0.5));
}

TEST(MapPoints, AreThinAndStable) {
  const MapPoints& points = room().points;
  ASSERT_GT(points.size(), 100U);
  EXPECT_LT(points.size(), room().map.stableCount() / 2);
  const MapPoints coarse = thinnedPoints(room().map, kFirstFragment, 0.2);
  EXPECT_LT(coarse.size(), points.size() / 2);
}

TEST(PlaceSearch, FindsThePlaceAfterAFall) {
  const WorkingFrame frame = room().frame(11);
  const Eigen::Isometry3d truth = room().sequence.pose(11);
  for (const double turn : {-1.2, 0.4}) {
    const Eigen::Isometry3d before = afterFall(truth, turn, 0.4);
    const auto found =
        searchPlaces(room().points, placeQuery(frame), {0, before}, room().up, PlaceSearchConfig{});
    ASSERT_FALSE(found.empty());
    EXPECT_LT(metresOff(found[0].pose.T_map_camera, truth), 0.25) << turn;
    EXPECT_LT(radiansOff(found[0].pose.T_map_camera, truth), 0.175) << turn;
  }
}

TEST(PlaceSearch, FindsThePlaceFromBelow) {
  // Lying: lower by more than the grid's own heights, tilted up.
  const Eigen::Isometry3d truth = room().sequence.pose(11);
  Eigen::Isometry3d before = afterFall(truth, 0.3, 0.3);
  before.translation() += 0.5 * room().up;
  before.linear() *= Eigen::AngleAxisd(0.3, Eigen::Vector3d::UnitX()).toRotationMatrix();
  const auto found = searchPlaces(room().points, placeQuery(room().frame(11)), {0, before},
                                  room().up, PlaceSearchConfig{});
  ASSERT_FALSE(found.empty());
  EXPECT_LT(metresOff(found[0].pose.T_map_camera, truth), 0.25);
  EXPECT_LT(radiansOff(found[0].pose.T_map_camera, truth), 0.175);
}

/// The map as a camera sees it.
WorkingFrame seenFrom(const Eigen::Isometry3d& T_map_camera) {
  RgbdFrame seen = room().sequence.frame(0).frame;
  ModelView view;
  RenderOptions options;
  options.age = SurfelAge::all;
  options.with_color = true;
  SurfelRenderer().render(room().map, seen.camera, T_map_camera, options, view);
  seen.depth = view.depth_m;
  seen.color = view.color;
  WorkingFrame working;
  working.assign(seen, cv::Mat(), FrameConfig{});
  return working;
}

TEST(PlaceSearch, FindsACameraThatLiesOnItsSide) {
  const auto levels = findLevels(orientedPoints(room().points), room().up, 0.3);
  ASSERT_TRUE(levels);
  const Eigen::Isometry3d standing = room().sequence.pose(11);
  const double high_m = room().up.dot(standing.translation()) - levels->lowest_m;
  for (const double roll : {-1.5, 1.4}) {
    Eigen::Isometry3d lying = standing;
    lying.translation() -= (high_m - 0.35) * room().up;
    lying.linear() *= Eigen::AngleAxisd(roll, Eigen::Vector3d::UnitZ()).toRotationMatrix();
    const auto found =
        searchPlaces(room().points, placeQuery(seenFrom(lying)), {0, afterFall(standing, 0.4, 0.3)},
                     room().up, PlaceSearchConfig{});
    ASSERT_FALSE(found.empty());
    EXPECT_LT(metresOff(found[0].pose.T_map_camera, lying), 0.25) << roll;
    EXPECT_LT(radiansOff(found[0].pose.T_map_camera, lying), 0.175) << roll;
  }
}

TEST(PlaceSearch, CandidatesAreSortedAndApart) {
  const auto found = searchPlaces(room().points, placeQuery(room().frame(3)),
                                  {0, room().sequence.pose(0)}, room().up, PlaceSearchConfig{});
  ASSERT_GT(found.size(), 1U);
  for (std::size_t i = 1; i < found.size(); ++i) {
    EXPECT_GE(found[i - 1].score, found[i].score);
    EXPECT_LE(found[i].score, 1.5);
    const Eigen::Isometry3d &a = found[0].pose.T_map_camera, &b = found[i].pose.T_map_camera;
    EXPECT_TRUE(metresOff(a, b) > 0.19 || radiansOff(a, b) > 0.16);
  }
}

TEST(PlaceSearch, GivesNothingOfNothing) {
  const PlaceQuery query = placeQuery(room().frame(0));
  const Eigen::Isometry3d T = room().sequence.pose(0);
  EXPECT_TRUE(searchPlaces(MapPoints{}, query, {0, T}, room().up, PlaceSearchConfig{}).empty());
  PlaceQuery blind = query;
  blind.depth_m = cv::Mat::zeros(query.depth_m.size(), CV_32FC1);
  EXPECT_TRUE(searchPlaces(room().points, blind, {0, T}, room().up, PlaceSearchConfig{}).empty());
}

TEST(PlaceSearch, GivesTheSameBitsForAnyNumberOfThreads) {
  std::vector<PlaceCandidate> found[2];
  for (int i = 0; i < 2; ++i) {
    tbb::global_control limit(tbb::global_control::max_allowed_parallelism, i == 0 ? 1 : 4);
    found[i] = searchPlaces(room().points, placeQuery(room().frame(5)),
                            {0, room().sequence.pose(0)}, room().up, PlaceSearchConfig{});
  }
  ASSERT_EQ(found[0].size(), found[1].size());
  for (std::size_t i = 0; i < found[0].size(); ++i) {
    EXPECT_EQ(found[0][i].score, found[1][i].score);
    EXPECT_EQ(found[0][i].pose.T_map_camera.matrix(), found[1][i].pose.T_map_camera.matrix());
  }
}

TEST(LoopWorker, FindsACameraThatWasLastSeenFallingOnItsBack) {
  // One keyframe, without a picture: features cannot help.
  KeyframeView view = keyframeView(room().frame(0), 0, {0, room().sequence.pose(0)}, true);
  view.intensity.setTo(128);
  const Eigen::Isometry3d truth = room().sequence.pose(11);
  Eigen::Isometry3d last = afterFall(truth, 0.3, 0.3);
  last.linear() *= Eigen::AngleAxisd(1.2, Eigen::Vector3d::UnitX()).toRotationMatrix();
  last.translation() -= 0.9 * room().up;
  LoopQuestion question;
  question.known = {view};
  question.place = std::make_shared<const PlaceQuestion>(
      PlaceQuestion{room().frame(11), std::make_shared<const SurfelMap>(room().map), {0, last}});
  LoopWorker worker{LoopConfig{}, TrackingConfig{}, DepthSensor{}};
  const LoopAnswer answer = worker.answer(question);
  ASSERT_TRUE(answer.place);
  EXPECT_LT(metresOff(answer.place->alignment.T_map_camera, truth), 0.03);
}

TEST(LoopWorker, LooksInEachFragmentByItself) {
  // The room is a fragment whose coordinates overlap with those of another, where a wall is.
  auto map = std::make_shared<SurfelMap>(room().map.config());
  map->restore({{2, room().map.collect()}}, room().map.frame());
  SurfelArrays wall;
  wall.resize(2500);
  for (std::size_t i = 0; i < wall.size(); ++i) {
    wall.x[i] = 0.05F * static_cast<float>(i % 50) - 1.2F;
    wall.y[i] = 0.05F * static_cast<float>(i / 50) - 1.2F;
    wall.z[i] = 0.7F;
    wall.nz[i] = -1.0F;
    wall.radius[i] = 0.05F;
    wall.weight[i] = wall.confidence[i] = 50;
    wall.created[i] = wall.seen[i] = map->frame();
  }
  map->add(wall, 0);
  LoopQuestion question;
  PlaceQuestion place{room().frame(11), map, {0, room().sequence.pose(8)}};
  LoopWorker worker{LoopConfig{}, TrackingConfig{}, DepthSensor{}};
  question.place = std::make_shared<const PlaceQuestion>(place);
  EXPECT_FALSE(worker.answer(question).place) << "it is not in the fragment of the last pose";
  place.elsewhere.push_back({2, room().sequence.pose(8)});
  question.place = std::make_shared<const PlaceQuestion>(place);
  const LoopAnswer answer = worker.answer(question);
  ASSERT_TRUE(answer.place);
  EXPECT_EQ(answer.place->fragment, 2);
  EXPECT_LT(metresOff(answer.place->alignment.T_map_camera, room().sequence.pose(11)), 0.03);
}

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

TEST(VerifyPlace, APositionThatIsHardlyKnownIsNotBelieved) {
  PlaceVerdict verdict;
  verdict.alignment.converged = true;
  verdict.agreement = {1.0, 1.0, 0.0, 0.0, 1.0, 0.2};
  for (const double sigma_m : {0.03, 0.04}) {
    verdict.alignment.covariance(1, 1) = sigma_m * sigma_m;
    EXPECT_DOUBLE_EQ(positionSigma(verdict.alignment.covariance), sigma_m);
    const PlaceDoubt doubt = judgePlace(verdict, verdict.alignment.T_map_camera, {});
    EXPECT_EQ(doubt, sigma_m < 0.033 ? PlaceDoubt::none : PlaceDoubt::degenerate);
  }
}

TEST(VerifyPlace, ABentMapIsBelievedWhereShapeAndPictureSayTheSame) {
  PlaceVerdict verdict;
  verdict.alignment.converged = true;
  PlaceAgreement& agreement = verdict.agreement;
  agreement.overlap = 0.7;
  agreement.agreeing = 0.8;
  const auto judged = [&](double spread, double correlation) {
    agreement.spread = spread;
    agreement.correlation = correlation;
    return judgePlace(verdict, verdict.alignment.T_map_camera, {});
  };
  EXPECT_EQ(judged(0.15, 0.8), PlaceDoubt::none);
  EXPECT_EQ(judged(0.05, 0.8), PlaceDoubt::disagrees) << "it may have slid";
  EXPECT_EQ(judged(0.15, 0.7), PlaceDoubt::disagrees) << "it may be another room";
  agreement.agreeing = 0.7;
  EXPECT_EQ(judged(0.15, 0.8), PlaceDoubt::disagrees);
}

TEST(VerifyPlace, ATruePlaceIsNotBelievedThroughAGap) {
  TrueFrame truth = room().sequence.frame(8);
  PlaceVerifier verifier{TrackingConfig{}};
  for (const double open : {0.8, 0.12}) {
    const int covered = static_cast<int>((1.0 - open) * truth.frame.depth.cols);
    truth.frame.depth.colRange(0, covered).setTo(0);
    WorkingFrame frame;
    frame.assign(truth.frame, cv::Mat(), FrameConfig{});
    const PlaceVerdict verdict = verifier.verify(room().map, frame, {0, truth.T_map_camera});
    EXPECT_EQ(verdict.accepted(), open > 0.5) << name(verdict.doubt);
    EXPECT_EQ(verdict.doubt == PlaceDoubt::covered, open < 0.5) << name(verdict.doubt);
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
  const PlaceAgreement agreement = compareViews(frame, view);
  EXPECT_GT(agreement.seen_through, 0.8);
  EXPECT_LT(agreement.agreeing, 0.1);
}

}  // namespace
}  // namespace pf
