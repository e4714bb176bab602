// SPDX-License-Identifier: BSD-3-Clause
#include "posefusion/segmentation/location.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <opencv2/core.hpp>

namespace pf {
namespace {

constexpr std::size_t kCells = 20;

/// One person with a mask of 20 cells, and one beside without.
struct Detections {
  People people{1, true, {Person(), Person()}};
  ShownPeople shown{std::vector<float>(kCells, 0.9F), std::vector<std::int16_t>(kCells, 0)};

  std::vector<bool> mayBeNew(Background background) const {
    return pf::mayBeNew(people, shown, std::vector<Background>(kCells, background));
  }
};

TEST(MayBeNew, AWeakDetectionHasToStandBeforeTheMap) {
  Detections weak;
  weak.people.people[0].score = 0.3F;
  EXPECT_TRUE(weak.mayBeNew(Background::nearer)[0]);
  EXPECT_FALSE(weak.mayBeNew(Background::agrees)[0]);
  EXPECT_FALSE(weak.mayBeNew(Background::unknown)[0]);
  weak.shown.probability.assign(kCells, 0.3F);
  EXPECT_FALSE(weak.mayBeNew(Background::nearer)[0]) << "of these cells it is not even sure";
}

TEST(MayBeNew, AChairSeenFromItsSideIsWeakToo) {
  Detections chair;
  chair.people.people[0].score = 0.6F;  // of a real one, in an empty kitchen
  EXPECT_FALSE(chair.mayBeNew(Background::agrees)[0]);
  EXPECT_FALSE(chair.mayBeNew(Background::unknown)[0]);
}

/// A weak detection: `nearer` of its cells are before the map, `agrees` agree with it, and the
/// others lie on surfaces that the map has seen for a few frames only.
bool mayBeNew(std::size_t nearer, std::size_t agrees) {
  Detections weak;
  weak.people.people[0].score = 0.5F;
  std::vector<Background> background(kCells, Background::recent);
  std::fill_n(background.begin(), nearer, Background::nearer);
  std::fill_n(background.begin() + nearer, agrees, Background::agrees);
  return pf::mayBeNew(weak.people, weak.shown, background)[0];
}

TEST(MayBeNew, APersonMappedWhileComingInStandsBeforeTheMapInPart) {
  EXPECT_TRUE(mayBeNew(5, 0));
  EXPECT_TRUE(mayBeNew(5, 6)) << "an arm on the door post";
  EXPECT_FALSE(mayBeNew(0, 0)) << "a chair that has just come into view";
  EXPECT_FALSE(mayBeNew(2, 0)) << "its edge";
  EXPECT_FALSE(mayBeNew(5, 12)) << "a chair that was turned a little";
}

TEST(MayBeNew, ASureDetectionNeedsNoMap) {
  Detections sure;
  sure.people.people[0].score = 0.8F;
  for (const Background b : {Background::nearer, Background::agrees, Background::unknown}) {
    EXPECT_TRUE(sure.mayBeNew(b)[0]);
  }
}

TEST(MayBeNew, APersonThatNoMaskShowsNeedsNone) {
  Detections joints;
  joints.people.people[1].score = 0.1F;
  EXPECT_TRUE(joints.mayBeNew(Background::agrees)[1]);
  joints.shown = {};
  EXPECT_EQ(pf::mayBeNew(joints.people, joints.shown, {}), (std::vector<bool>{true, true}));
}

/// A carried person before a mapped wall 2 m away, and a detection of four joints on the wall
/// beside.
struct Carried {
  Evidence evidence;
  TrackedPerson tracked;

  Carried() {
    RgbdFrame frame{1, cv::Mat(30, 40, CV_8UC3, cv::Scalar(0, 0, 0)),
                    cv::Mat(30, 40, CV_32FC1, cv::Scalar(2.0F)), 1e-3,
                    PinholeCamera{40, 30, 33, 33, 19.5, 14.5, {}}};
    frame.depth(cv::Rect(5, 5, 8, 20)).setTo(1.4F);
    sampleGrid(frame, frame.depth, 40, evidence.grid);
    evidence.background.assign(evidence.grid.size(), Background::agrees);
    evidence.flatness.assign(evidence.grid.size(), Flatness::none);
    for (int v = 5; v < 25; ++v) {
      for (int u = 5; u < 13; ++u) {
        tracked.cells.push_back(v * 40 + u);
        evidence.background[v * 40 + u] = Background::nearer;
      }
    }
    tracked.id = 7;
    tracked.depth_m = 1.4F;
    tracked.fresh = true;
    tracked.detection = 0;
    for (int i = 0; i < 4; ++i) tracked.person.joints[i] = {30.0F, 6.0F + 5.0F * i, 0.5F};
  }
};

TEST(LocatePerson, AFewJointsOnTheWallDoNotEndAPersonThatTheMapShowsBeforeIt) {
  Carried carried;
  EXPECT_TRUE(locatePerson(carried.evidence, 30, carried.tracked));
  EXPECT_FALSE(carried.tracked.in_map);
  EXPECT_EQ(carried.tracked.body.anchors.size(), carried.tracked.cells.size());
  EXPECT_EQ(carried.tracked.depth_m, 1.4F);
}

TEST(LocatePerson, WhoseMaskLiesOnTheWallTooIsAThingOfTheMap) {
  Carried wall;
  wall.evidence.background.assign(wall.evidence.grid.size(), Background::agrees);
  EXPECT_FALSE(locatePerson(wall.evidence, 30, wall.tracked));
}

TEST(LocatePerson, ANewPersonOnTheWallIsPartOfTheMap) {
  Carried fresh;
  fresh.tracked.cells.clear();
  EXPECT_FALSE(locatePerson(fresh.evidence, 30, fresh.tracked));
}

}  // namespace
}  // namespace pf
