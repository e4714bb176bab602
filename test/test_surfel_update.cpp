// SPDX-License-Identifier: BSD-3-Clause
// What frames do to surfels: support, violation of free space, duplicates.
#include <gtest/gtest.h>

#include <utility>

#include "fusion_scene.hpp"
#include "posefusion/core/error.hpp"

namespace pf {
namespace {

TEST(SurfelUpdate, WhatWentAwayIsRemovedOnceTheRoomBehindIsSeen) {
  // A person stands before the wall, unmasked, long enough to become stable.
  SurfelMap map{MapConfig{}};
  Fuser fuser;
  for (int i = 0; i < 15; ++i) fuser.fuse(scene(3.0, 1.5), kIdentity, map);
  ASSERT_GT(countNear(map, 1.5), 1000U);
  int frames = 0;
  while (countNear(map, 1.5) > 0 && frames < 60) {
    fuser.fuse(scene(3.0), kIdentity, map);
    ++frames;
  }
  EXPECT_LE(frames, 30) << "gone within a second";
  EXPECT_GT(countNear(map, 3.0), 17000U) << "and the wall is complete";
}

TEST(SurfelUpdate, WhatAPersonHidesStays) {
  SurfelMap map{MapConfig{}};
  Fuser fuser;
  for (int i = 0; i < 15; ++i) fuser.fuse(scene(3.0), kIdentity, map);
  const std::size_t wall = countNear(map, 3.0);
  for (int i = 0; i < 60; ++i) fuser.fuse(scene(3.0, 1.5), kIdentity, map);
  EXPECT_EQ(countNear(map, 3.0), wall);
}

TEST(SurfelUpdate, MissingDepthIsNoEvidence) {
  SurfelMap map{MapConfig{}};
  Fuser fuser;
  for (int i = 0; i < 15; ++i) fuser.fuse(scene(2.0), kIdentity, map);
  const std::size_t size = map.size();
  WorkingFrame nothing = scene(2.0);
  nothing.depth_m.setTo(0);
  for (int i = 0; i < 60; ++i) fuser.fuse(nothing, kIdentity, map);
  EXPECT_EQ(map.size(), size);
}

TEST(SurfelUpdate, OldFurnitureThatWasMovedGoesWithinTwoSeconds) {
  SurfelMap map{MapConfig{}};
  fuseOften(300, scene(3.0, 1.5), map);
  ASSERT_GT(countNear(map, 1.5), 1000U);
  fuseOften(60, scene(3.0), map);
  EXPECT_EQ(countNear(map, 1.5), 0U);
}

TEST(SurfelUpdate, AFewWrongFramesDoNotEraseWhatManyHaveSeen) {
  // Ten frames at a pose that is 30 cm off see through the whole room.
  SurfelMap map{MapConfig{}};
  fuseOften(60, scene(2.0), map);
  const std::size_t wall = countNear(map, 2.0);
  fuseOften(10, scene(2.3), map);
  EXPECT_EQ(countNear(map, 2.0), wall);
}

TEST(SurfelUpdate, OnProbationNothingCountsAgainstStableSurfels) {
  SurfelMap map{MapConfig{}};
  fuseOften(60, scene(2.0), map);
  const std::size_t wall = countNear(map, 2.0);
  FusionOptions probation;
  probation.may_remove_stable = false;
  fuseOften(100, scene(2.3), map, probation);
  EXPECT_EQ(countNear(map, 2.0), wall);
  map.forEachSurfel([](const SurfelArrays& s, std::size_t i) {
    if (s.created[i] == 0) {
      ASSERT_EQ(s.odds[i], static_odds::kMost);
    }
  });
}

TEST(SurfelUpdate, BothSidesOfABoardAreMapped) {
  // Front face at z = 1.5 seen from the origin; then from behind, its other face 1 cm farther.
  SurfelMap map{MapConfig{}};
  fuseOften(15, scene(1.5), map);
  const std::size_t front = map.size();
  Eigen::Isometry3d behind = kIdentity;
  behind.linear() = Eigen::AngleAxisd(M_PI, Eigen::Vector3d::UnitY()).toRotationMatrix();
  behind.translation().z() = 3.01;
  fuseOften(15, scene(1.5), map, {}, behind);
  EXPECT_EQ(map.size(), 2 * front) << "the far side has surfels of its own";
  map.forEachSurfel([](const SurfelArrays& s, std::size_t i) {
    EXPECT_NEAR(s.odds[i], 15 * static_odds::kFrame, 1e-5) << "a view from behind is no evidence";
    EXPECT_EQ(s.nz[i] < 0, s.created[i] == 0);
  });
}

TEST(SurfelUpdate, DepthBeyondTheRangeSeesThroughWhatIsNearer) {
  SurfelMap map{MapConfig{}};
  fuseOften(15, scene(9.0, 1.5), map);
  ASSERT_GT(countNear(map, 1.5), 1000U);
  ASSERT_EQ(countNear(map, 9.0), 0U);
  fuseOften(40, scene(9.0), map);
  EXPECT_EQ(map.size(), 0U);
}

TEST(SurfelUpdate, WhatAPersonIsSeenThroughGoes) {
  // A board was taken away by a person who now stands in its place, masked but for the rim.
  const auto leftOfBoard = [](double person_m) {
    SurfelMap map{MapConfig{}};
    fuseOften(30, scene(3.0, 1.5), map);
    FusionOptions options;
    options.mask = cv::Mat::zeros(120, 160, CV_8UC1);
    options.mask(cv::Rect(kBoard.tl() + cv::Point(2, 2), kBoard.br() - cv::Point(2, 2))).setTo(255);
    options.input_depth_m = cv::Mat(120, 160, CV_32FC1, cv::Scalar(3.0));
    options.input_depth_m(kBoard).setTo(person_m);
    WorkingFrame masked = scene(3.0);
    masked.depth_m(kBoard).setTo(0);
    fuseOften(30, masked, map, options);
    return stableNear(map, 1.5);
  };
  const std::size_t all = leftOfBoard(1.2);
  EXPECT_GT(all, 1400U) << "nothing is known of what a person hides";
  EXPECT_LT(leftOfBoard(2.2), all / 50) << "gone within a second";
}

TEST(SurfelUpdate, FusedPeopleGoWhereTheSegmenterFindsThem) {
  // Nothing behind the person has depth; a chair at the same depth is beside the mask.
  const cv::Rect person(60, 40, 20, 40);
  SurfelMap map{MapConfig{}};
  fuseOften(30, scene(0.0, 1.5), map);
  FusionOptions options;
  options.mask = cv::Mat::zeros(120, 160, CV_8UC1);
  options.mask(person).setTo(255);
  options.input_depth_m = cv::Mat::zeros(120, 160, CV_32FC1);
  options.input_depth_m(kBoard).setTo(1.5);
  WorkingFrame masked = scene(0.0, 1.5);
  masked.depth_m(person).setTo(0);
  const auto countIn = [&](const cv::Rect& area) {
    std::size_t count = 0;
    map.forEachSurfel([&](const SurfelArrays& s, std::size_t i) {
      const Eigen::Vector2d pixel = smallCamera().project(Eigen::Vector3d(s.x[i], s.y[i], s.z[i]));
      count += area.contains({cvRound(pixel.x()), cvRound(pixel.y())}) ? 1 : 0;
    });
    return count;
  };
  const cv::Rect chair(80, 40, 20, 40);
  const std::size_t before = countIn(chair);
  ASSERT_GT(countIn(person), 700U);
  fuseOften(45, masked, map, options);
  EXPECT_EQ(countIn(person), 0U);
  EXPECT_EQ(countIn(chair), before);
  options.mask = cv::Mat::zeros(60, 80, CV_8UC1);
  EXPECT_THROW(Fuser().fuse(masked, kIdentity, map, options), InputError);
}

TEST(SurfelUpdate, MasksMayHaveARestOfPixelsBesideTheWorkingFrame) {
  SurfelMap map{MapConfig{}};
  FusionOptions options;
  options.mask = cv::Mat::zeros(241, 321, CV_8UC1);
  options.input_depth_m = cv::Mat(241, 321, CV_32FC1, cv::Scalar(3.0));
  EXPECT_NO_THROW(Fuser().fuse(scene(3.0), kIdentity, map, options));
}

/// A person at 1.5 m in the right half of the board's place.
const cv::Rect kFound(80, 40, 20, 40);

FusionOptions foundAt(double depth_m) {
  FusionOptions options;
  options.mask = cv::Mat::zeros(120, 160, CV_8UC1);
  options.mask(kFound).setTo(255);
  options.input_depth_m = cv::Mat(120, 160, CV_32FC1, cv::Scalar(depth_m));
  return options;
}

WorkingFrame withoutFound(WorkingFrame frame) {
  frame.depth_m(kFound).setTo(0);
  return frame;
}

TEST(SurfelUpdate, WhatIsSeenCloseToPeopleStays) {
  SurfelMap map{MapConfig{}};
  fuseOften(40, withoutFound(scene(3.0, 1.5)), map, foundAt(1.5));
  EXPECT_GT(stableNear(map, 1.5), 700U) << "the chair of a sitting person";
  map.forEachSurfel(
      [](const SurfelArrays& s, std::size_t i) { ASSERT_EQ(s.odds[i], static_odds::kMost); });
}

TEST(SurfelUpdate, APersonMappedUnnoticedGoesOnceFound) {
  // The board is a person; behind it nothing has depth, so that nothing is seen through it.
  SurfelMap map{MapConfig{}};
  fuseOften(20, scene(0.0, 1.5), map);
  ASSERT_GT(stableNear(map, 1.5), 1000U);
  fuseOften(40, withoutFound(scene(0.0)), map, foundAt(1.4));
  EXPECT_EQ(countNear(map, 1.5), 0U);
}

TEST(SurfelUpdate, WhatWasThereLongBeforePeopleCameStays) {
  SurfelMap map{MapConfig{}};
  fuseOften(120, scene(0.0, 1.5), map);
  const std::size_t furniture = stableNear(map, 1.5);
  fuseOften(100, withoutFound(scene(0.0)), map, foundAt(1.4));
  EXPECT_EQ(stableNear(map, 1.5), furniture);
}

TEST(SurfelUpdate, TheYoungerOfTwoLayersGoes) {
  // A wall, seen again for a while from a pose 5 cm off, so that a second layer is made.
  SurfelMap map{MapConfig{}};
  fuseOften(30, scene(1.5), map);
  const std::size_t wall = map.size();
  fuseOften(15, scene(1.54), map);
  ASSERT_GT(countNear(map, 1.54, 0.01), wall * 9 / 10) << "neither agreement nor violation";
  fuseOften(60, scene(1.5), map);
  EXPECT_EQ(countNear(map, 1.54, 0.01), 0U);
  EXPECT_EQ(countNear(map, 1.5, 0.01), wall);
}

/// A wall at 4 m. What is measured at 4.1 m is near enough to it, and to what lies at 4.2 m.
SurfelMap wallAtFourMetres() {
  SurfelMap map{MapConfig{}};
  fuseOften(10, scene(4.0), map);
  return map;
}

constexpr double kBetween_m = 4.1, kBehind_m = 4.2;

TEST(SurfelUpdate, AnOutlierBehindAWallFindsNoSupport) {
  SurfelMap map = wallAtFourMetres();
  const std::size_t wall = map.size();
  fuseOften(1, scene(kBehind_m), map);
  ASSERT_EQ(map.size(), 2 * wall) << "too far from the wall to be of it";
  fuseOften(25, scene(kBetween_m), map);
  EXPECT_EQ(map.size(), wall);
  EXPECT_EQ(countNear(map, kBehind_m, 0.05), 0U);
}

TEST(SurfelUpdate, TheYoungerLayerGoesAlsoWhereBothAgreeWithTheMeasurement) {
  SurfelMap map = wallAtFourMetres();
  const std::size_t wall = map.size();
  Eigen::Isometry3d away = kIdentity;
  away.translation().x() = 100;
  fuseOften(100, scene(2.0), map, {}, away);
  const std::size_t elsewhere = map.size() - wall;
  fuseOften(10, scene(kBehind_m), map);
  ASSERT_EQ(map.size(), 2 * wall + elsewhere);
  FusionOptions probation;
  probation.may_remove_stable = false;
  fuseOften(3, scene(kBetween_m), map, probation);
  EXPECT_EQ(map.size(), 2 * wall + elsewhere) << "whoever may be wrong removes nothing";
  fuseOften(30, scene(kBetween_m), map);
  EXPECT_EQ(map.size(), wall + elsewhere);
  EXPECT_EQ(countNear(map, kBehind_m, 0.05), 0U);
}

TEST(SurfelUpdate, ALowStepSeenFromAfarKeepsBothItsLevels) {
  SurfelMap map{MapConfig{}};
  Fuser fuser;
  for (int i = 0; i < 150; ++i) {
    Eigen::Isometry3d T = kIdentity;
    T.translation().x() = 0.01 * std::sin(0.3 * i);
    fuser.fuse(scene(4.0, 3.94), T, map);
  }
  const auto all = map.collect();
  for (const auto& [z, least] : {std::pair<float, std::size_t>{3.94F, 1500}, {4.0F, 15000}}) {
    std::size_t stable = 0;
    for (std::size_t i = 0; i < all.size(); ++i) {
      stable += std::abs(all.z[i] - z) < 0.01F && all.odds[i] > 0.9F * static_odds::kMost ? 1 : 0;
    }
    EXPECT_GT(stable, least) << z;
  }
}

TEST(SurfelUpdate, AnOldSurfaceBehindAYoungOneStays) {
  // A book is put on the table: what it hides is older and stays.
  SurfelMap map{MapConfig{}};
  fuseOften(30, scene(1.5), map);
  const std::size_t table = map.size();
  fuseOften(60, scene(1.5, 1.455), map);
  EXPECT_GT(countNear(map, 1.455, 0.01), 1000U);
  EXPECT_EQ(countNear(map, 1.5, 0.01), table);
}

}  // namespace
}  // namespace pf
