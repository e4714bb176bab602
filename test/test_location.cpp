// SPDX-License-Identifier: BSD-3-Clause
#include "posefusion/segmentation/location.hpp"

#include <gtest/gtest.h>

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

TEST(MayBeNew, ASureDetectionNeedsNoMap) {
  Detections sure;
  sure.people.people[0].score = 0.8F;
  for (const Background b : {Background::nearer, Background::agrees, Background::unknown}) {
    EXPECT_TRUE(sure.mayBeNew(b)[0]);
  }
}

TEST(MayBeNew, WhomNoMaskShowsIsNotAskedForOne) {
  Detections joints;
  joints.people.people[1].score = 0.1F;
  EXPECT_TRUE(joints.mayBeNew(Background::agrees)[1]);
  joints.shown = {};
  EXPECT_EQ(pf::mayBeNew(joints.people, joints.shown, {}), (std::vector<bool>{true, true}));
}

}  // namespace
}  // namespace pf
