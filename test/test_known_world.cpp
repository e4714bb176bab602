// SPDX-License-Identifier: BSD-3-Clause
#include "posefusion/evaluation/known_world.hpp"

#include <gtest/gtest.h>

#include "posefusion/core/error.hpp"
#include "simulated_sequence.hpp"

namespace pf {
namespace {

const SimulatedSequence& box() { return exactBox<12>(); }

TEST(KnownWorld, IsWhatLocatedFramesSaw) {
  KnownWorld world;
  const RgbdFrame frame = box().frame(0).frame;
  for (int i = 0; i < 2; ++i) {
    const auto view = world.look(frame, {}, box().pose(0));
    EXPECT_EQ(view.known, 0.0) << "looking alone teaches nothing";
    EXPECT_GT(view.open, 0.8);
    EXPECT_FALSE(view.shouldBeKnown());
  }
  world.learn();
  EXPECT_EQ(world.look(frame, {}, box().pose(0)).known, 1.0);
  EXPECT_TRUE(world.look(box().frame(1).frame, {}, box().pose(1)).shouldBeKnown()) << "overlaps";
  Eigen::Isometry3d elsewhere = box().pose(0);
  elsewhere.translation().x() += 20;
  EXPECT_EQ(world.look(frame, {}, elsewhere).known, 0.0);
}

TEST(KnownWorld, ACoveredViewNeedNotBeKnown) {
  KnownWorld world;
  const RgbdFrame frame = box().frame(0).frame;
  world.look(frame, {}, box().pose(0));
  world.learn();
  cv::Mat person(frame.depth.size(), CV_8UC1, cv::Scalar(255));
  person.colRange(0, person.cols / 10).setTo(0);
  const auto view = world.look(frame, person, box().pose(0));
  EXPECT_EQ(view.known, 1.0);
  EXPECT_LT(view.open, 0.11);
  EXPECT_FALSE(view.shouldBeKnown());
}

TEST(KnownWorld, RefusesAMaskOfAnotherSize) {
  const RgbdFrame frame = box().frame(0).frame;
  const cv::Mat mask(3, 4, CV_8UC1, cv::Scalar(0));
  EXPECT_THROW(KnownWorld().look(frame, mask, box().pose(0)), InputError);
}

}  // namespace
}  // namespace pf
