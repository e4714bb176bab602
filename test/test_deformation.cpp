// SPDX-License-Identifier: BSD-3-Clause
#include "posefusion/graph/deformation.hpp"

#include <gtest/gtest.h>

#include <limits>

#include "posefusion/core/se3.hpp"

namespace pf {
namespace {

Eigen::Isometry3d slide(double x, double yaw) {
  Vector6d twist;
  twist << x, 0.2 * x, 0, 0, yaw, 0.1 * yaw;
  return expSe3(twist);
}

bool same(const Eigen::Isometry3d& a, const Eigen::Isometry3d& b, double within = 1e-12) {
  return (a.matrix() - b.matrix()).norm() <= within;
}

/// Still until frame 10, then two corrections tracked into each other, then a jump at 40.
Deformation example(const Eigen::Isometry3d& world = Eigen::Isometry3d::Identity()) {
  const auto seen = [&](const Eigen::Isometry3d& T) { return world * T * world.inverse(); };
  return Deformation(3, {{0, Eigen::Isometry3d::Identity(), true},
                         {10, Eigen::Isometry3d::Identity(), true},
                         {20, seen(slide(0.3, 0.1)), true},
                         {30, seen(slide(0.5, -0.2)), false},
                         {40, seen(slide(2.0, 1.0)), false}});
}

TEST(Deformation, OfNothingIsTheIdentity) {
  EXPECT_TRUE(Deformation().isIdentity());
  EXPECT_EQ(Deformation().version(), 0);
  EXPECT_TRUE(same(Deformation().at(5), Eigen::Isometry3d::Identity(), 0));
  const Deformation still(
      1, {{3, Eigen::Isometry3d::Identity(), true}, {9, Eigen::Isometry3d::Identity(), false}});
  EXPECT_TRUE(still.isIdentity());
  EXPECT_TRUE(same(still.at(6), Eigen::Isometry3d::Identity(), 0));
}

TEST(Deformation, MovesNothingToTheBitWhereNoNeighbourMoves) {
  const Deformation d = example();
  EXPECT_FALSE(d.isIdentity());
  EXPECT_EQ(d.version(), 3);
  for (const int frame : {-5, 0, 4, 10}) {
    EXPECT_TRUE(same(d.at(frame), Eigen::Isometry3d::Identity(), 0)) << frame;
  }
}

TEST(Deformation, ReportsTheFirstFrameThatItMoves) {
  using Frames = std::numeric_limits<std::int32_t>;
  EXPECT_EQ(example().firstMoved(0), 11);
  EXPECT_FALSE(same(example().at(11), Eigen::Isometry3d::Identity(), 0));
  EXPECT_EQ(example().firstMoved(1), Frames::max()) << "it has no node there";
  EXPECT_EQ(Deformation().firstMoved(0), Frames::max());
  const Deformation all(1, {{5, slide(0.3, 0.1), true}});
  EXPECT_EQ(all.firstMoved(0), Frames::min()) << "what is older goes with the first node";
  const Deformation apart(1,
                          {{5, Eigen::Isometry3d::Identity(), false}, {9, slide(0.3, 0.1), true}});
  EXPECT_EQ(apart.firstMoved(0), 9) << "nothing is blended where nothing was tracked";
}

TEST(Deformation, IsTheCorrectionAtItsNodesAndGoesSteadilyBetween) {
  const Deformation d = example();
  EXPECT_TRUE(same(d.at(20), slide(0.3, 0.1), 0));
  EXPECT_TRUE(same(d.at(30), slide(0.5, -0.2), 0));
  const Eigen::Isometry3d step = d.at(20).inverse() * d.at(21);
  for (int frame = 20; frame < 30; ++frame) {
    EXPECT_TRUE(same(d.at(frame + 1), d.at(frame) * step, 1e-12)) << frame;
  }
  EXPECT_FALSE(same(step, Eigen::Isometry3d::Identity(), 1e-3));
}

TEST(Deformation, DoesNotBlendAcrossWhatWasNotTracked) {
  const Deformation d = example();
  EXPECT_TRUE(same(d.at(39), slide(0.5, -0.2), 0));
  EXPECT_TRUE(same(d.at(40), slide(2.0, 1.0), 0));
}

TEST(Deformation, WhatIsMadeAfterTheLastNodeGoesWithIt) {
  EXPECT_TRUE(same(example().at(1000), slide(2.0, 1.0), 0));
}

TEST(Deformation, MovesWithTheWorld) {
  const Eigen::Isometry3d world = slide(5, 2);
  for (const int frame : {5, 13, 20, 27, 35, 50}) {
    const Eigen::Isometry3d expected = world * example().at(frame) * world.inverse();
    EXPECT_TRUE(same(example(world).at(frame), expected, 1e-9)) << frame;
  }
}

TEST(Deformation, SortsItsNodes) {
  const Deformation d(1, {{30, slide(1, 0), false}, {10, slide(2, 0), false}});
  EXPECT_TRUE(same(d.at(15), slide(2, 0), 0));
  EXPECT_TRUE(same(d.at(35), slide(1, 0), 0));
}

TEST(Deformation, OfOneFragmentLeavesTheOthers) {
  // Fragment 1 was mapped in between, and the camera came back to fragment 0.
  const Deformation d(
      1, {{0, slide(0.1, 0), true, 0}, {10, slide(5, 1), false, 1}, {20, slide(0.3, 0), false, 0}},
      Deformation::Join{1, 0});
  EXPECT_TRUE(same(d.at(5, 0), slide(0.15, 0), 1e-9));
  EXPECT_TRUE(same(d.at(15, 0), slide(0.25, 0), 1e-9)) << "not by the other's keyframe";
  EXPECT_TRUE(same(d.at(5, 1), slide(5, 1), 0));
  EXPECT_TRUE(same(d.at(15, 1), slide(5, 1), 0));
  EXPECT_TRUE(same(d.at(15, 2), Eigen::Isometry3d::Identity(), 0));
  EXPECT_EQ(d.fragmentAfter(0), 0);
  EXPECT_EQ(d.fragmentAfter(1), 0);
  EXPECT_EQ(d.fragmentAfter(2), 2);
}

TEST(Deformation, ThatJoinsFragmentsIsNoIdentityEvenIfNothingMoves) {
  const Eigen::Isometry3d still = Eigen::Isometry3d::Identity();
  EXPECT_FALSE(Deformation(1, {{0, still, true, 1}}, Deformation::Join{1, 0}).isIdentity());
}

}  // namespace
}  // namespace pf
