// SPDX-License-Identifier: BSD-3-Clause
#include "posefusion/loop/place_search.hpp"

#include <gtest/gtest.h>
#include <tbb/global_control.h>

#include <algorithm>

#include "place_scene.hpp"
#include "posefusion/core/se3.hpp"
#include "posefusion/loop/worker.hpp"

namespace pf {
namespace {

TEST(PlaceSearch, WhatIsOutOfReachChangesNothing) {
  // Neither the pose found nor a bit of its score, however large the map.
  MapPoints large = room().points.front();
  const std::size_t count = large.size();
  for (std::size_t i = 0; i < 5 * count; ++i) {
    const std::size_t from = i % count;
    large.x.push_back(large.x[from] + 40.0F);
    large.y.push_back(large.y[from] - 7.0F * static_cast<float>(i / count));
    for (auto* array : {&large.z, &large.nx, &large.ny, &large.nz, &large.intensity}) {
      array->push_back((*array)[from]);
    }
  }
  const PlaceQuery query = placeQuery(room().frame(7));
  const MapPose around{0, afterFall(room().sequence.pose(7), 0.5, 0.3)};
  const auto alone = searchPlaces(room().points, query, around, room().up, {});
  const auto found = searchPlaces(pointPyramid(large), query, around, room().up, {});
  ASSERT_FALSE(alone.empty());
  ASSERT_EQ(found.size(), alone.size());
  for (std::size_t i = 0; i < found.size(); ++i) {
    EXPECT_EQ(found[i].score, alone[i].score);
    EXPECT_EQ(found[i].pose.T_map_camera.matrix(), alone[i].pose.T_map_camera.matrix());
  }
}

TEST(PlaceSearch, APointWhereItLooksFromIsNotSeen) {
  MapPoints points = room().points.front();
  const Eigen::Isometry3d truth = room().sequence.pose(11);
  const Eigen::Vector3f at = truth.translation().cast<float>(), up = room().up.cast<float>();
  points.x.push_back(at.x()), points.y.push_back(at.y()), points.z.push_back(at.z());
  points.nx.push_back(up.x()), points.ny.push_back(up.y()), points.nz.push_back(up.z());
  points.intensity.push_back(255.0F);
  const auto found =
      searchPlaces(pointPyramid(points), placeQuery(room().frame(11)), {0, truth}, room().up, {});
  ASSERT_FALSE(found.empty());
  EXPECT_LT(metresOff(found[0].pose.T_map_camera, truth), 0.25);
}

TEST(PlaceSearch, TheOrderOfThePointsChangesNothing) {
  MapPoints turned = room().points.front();
  for (auto* array :
       {&turned.x, &turned.y, &turned.z, &turned.nx, &turned.ny, &turned.nz, &turned.intensity}) {
    std::reverse(array->begin(), array->end());
  }
  PointPyramid alone = {room().points.front()}, reversed = {turned};
  const PlaceQuery query = placeQuery(room().frame(7));
  const MapPose around{0, room().sequence.pose(5)};
  const auto a = searchPlaces(alone, query, around, room().up, {});
  const auto b = searchPlaces(reversed, query, around, room().up, {});
  ASSERT_FALSE(a.empty());
  ASSERT_EQ(a.size(), b.size());
  for (std::size_t i = 0; i < a.size(); ++i) EXPECT_EQ(a[i].score, b[i].score);
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
  const auto levels = findLevels(orientedPoints(room().points.front()), room().up, 0.3);
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
  EXPECT_TRUE(
      searchPlaces(pointPyramid({}), query, {0, T}, room().up, PlaceSearchConfig{}).empty());
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
    wall.weight[i] = 50;
    wall.odds[i] = static_odds::kMost;
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

}  // namespace
}  // namespace pf
