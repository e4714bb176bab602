// SPDX-License-Identifier: BSD-3-Clause
// People and cameras move as bodies do.
#include <gtest/gtest.h>

#include <cmath>

#include "simulator/camera_path.hpp"
#include "simulator/crowd.hpp"
#include "simulator/lighting.hpp"
#include "simulator/posture.hpp"
#include "simulator_scene.hpp"

namespace pf::simulator {
namespace {

using Eigen::Vector2d;
using Eigen::Vector3f;

World emptyRoom(double width_m, double depth_m) {
  World world;
  world.rooms.emplace_back(Eigen::Vector3d::Zero(), Eigen::Vector3d(width_m, depth_m, 2.5));
  return world;
}

Vector2d farAway(double) { return {-50.0, -50.0}; }

PersonSpec walker(const Vector2d& from, const Vector2d& to) {
  PersonSpec person;
  person.start_m = from;
  person.repeats = false;
  Action walk;
  walk.kind = Action::Kind::walk;
  walk.at_m.head<2>() = to;
  person.script = {walk};
  return person;
}

TEST(SimulatorMotion, WalkersArriveAndTheirStandingFeetDoNotSlide) {
  const World world = emptyRoom(8, 4);
  const Crowd crowd({walker({1, 2}, {6.5, 2.4})}, Walkway(world, 0.3), farAway, 12.0);
  ActorState before = crowd.at(0, 0.0);
  int steps = 0;
  for (double t = 0.02; t < 11.0; t += 1.0 / 60.0) {
    const ActorState now = crowd.at(0, t);
    for (std::size_t side = 0; side < 2; ++side) {
      const bool stood = before.feet[side].lift_m <= 0.0, stands = now.feet[side].lift_m <= 0.0;
      if (stood && stands) {
        EXPECT_LT((now.feet[side].at - before.feet[side].at).norm(), 1e-9);
      }
      steps += stood && !stands ? 1 : 0;
    }
    before = now;
  }
  EXPECT_LT((before.at - Vector2d(6.5, 2.4)).norm(), 0.12);
  EXPECT_GE(steps, 7);
  EXPECT_LE(steps, 24);
}

TEST(SimulatorMotion, PeopleThatMeetKeepApart) {
  const World world = emptyRoom(8, 4);
  const Crowd crowd({walker({1, 2}, {7, 2}), walker({7, 2.02}, {1, 2.02})}, Walkway(world, 0.3),
                    farAway, 14.0);
  for (double t = 0.0; t < 13.0; t += 0.05) {
    EXPECT_GT((crowd.at(0, t).at - crowd.at(1, t).at).norm(), 0.40) << t;
  }
  EXPECT_LT((crowd.at(0, 13.5).at - Vector2d(7, 2)).norm(), 0.3);
}

TEST(SimulatorMotion, WaysLeadRoundFurniture) {
  World world = emptyRoom(6, 6);
  world.footprints.push_back({{3, 3}, {1.0, 1.5}, 0.3});
  // The grid has cells of 10 cm: legs may cut a corner by less than that.
  const auto way = Walkway(world, 0.3).findWay({1, 3}, {5, 3});
  const Walkway walkway(world, 0.22);
  ASSERT_GE(way.size(), 3U);
  for (std::size_t i = 0; i + 1 < way.size(); ++i) {
    for (double s = 0.0; s <= 1.0; s += 0.05) {
      EXPECT_TRUE(walkway.isFree(way[i] + s * (way[i + 1] - way[i])));
    }
  }
}

TEST(SimulatorMotion, WaysLeadThroughDoorwaysNotThroughWalls) {
  World world = emptyRoom(4, 4);
  world.rooms.emplace_back(Eigen::Vector3d(4.12, 0, 0), Eigen::Vector3d(8, 4, 2.5));
  const Vector2d from(1, 3), to(7, 3);
  EXPECT_FALSE(Walkway(world, 0.3).connects(from, to));
  world.passages.push_back({{4.06, 1.0}, {0.22, 0.5}, M_PI / 2});
  const Walkway walkway(world, 0.3);
  EXPECT_TRUE(walkway.connects(from, to));
  const auto way = walkway.findWay(from, to);
  for (std::size_t i = 0; i + 1 < way.size(); ++i) {
    for (double s = 0.0; s <= 1.0; s += 0.02) {
      const Vector2d p = way[i] + s * (way[i + 1] - way[i]);
      EXPECT_TRUE(walkway.isFree(p)) << p.transpose();
    }
  }
}

TEST(SimulatorMotion, APersonAtATableComesAndGoesSideways) {
  World world = emptyRoom(6, 6);
  world.footprints.push_back({{3, 3}, {0.4, 1.0}, 0.0});    // a table
  world.footprints.push_back({{2.2, 3}, {0.3, 0.3}, 0.0});  // and its chair
  const Walkway walkway(world, 0.3);
  const Vector2d between(2.55, 3.1), door(0.8, 3.7);
  const double reach = (walkway.nearestFree(between) - between).norm() + 0.1;
  for (const auto& way : {walkway.findWay(between, door), walkway.findWay(door, between)}) {
    for (std::size_t i = 0; i + 1 < way.size(); ++i) {
      for (double s = 0.0; s <= 1.0; s += 0.02) {
        const Vector2d p = way[i] + s * (way[i + 1] - way[i]);
        EXPECT_TRUE((p - between).norm() < reach || Walkway(world, 0.22).isFree(p))
            << p.transpose();
      }
    }
  }
}

TEST(SimulatorMotion, LimbsKeepTheirLengthsAndReachWhatIsInReach) {
  const Vector3f root(0, 0, 1);
  for (const Vector3f& target : {Vector3f(0.2F, 0.1F, 0.7F), Vector3f(0.0F, 0.3F, 0.8F),
                                 Vector3f(2.0F, 0.0F, 1.0F), Vector3f(0.0F, 0.0F, 1.0F)}) {
    const LimbPose limb = solveLimb(root, target, {0.3F, 0.25F}, {-1, 0, 0});
    EXPECT_NEAR((limb.middle - root).norm(), 0.3F, 1e-3F);
    EXPECT_NEAR((limb.end - limb.middle).norm(), 0.25F, 2e-3F);
    const float distance = (target - root).norm();
    if (distance > 0.1F && distance < 0.5F) {
      EXPECT_LT((limb.end - target).norm(), 1e-4F);
    }
  }
}

TEST(SimulatorMotion, BonesOfAPostureHoldTogether) {
  const World world = emptyRoom(8, 4);
  const Crowd crowd({walker({1, 2}, {6.5, 2.4})}, Walkway(world, 0.3), farAway, 5.0);
  const Rig rig{Build{}};
  for (double t = 0.0; t < 5.0; t += 0.21) {
    const Posture posture = poseBody(rig, crowd.at(0, t), 7U);
    for (int bone = 1; bone < static_cast<int>(Bone::burden); ++bone) {
      const auto b = static_cast<std::size_t>(bone);
      const auto parent = static_cast<std::size_t>(Rig::kParent[b]);
      const Vector3f gap = posture[b] * rig.start[b] - posture[parent] * rig.start[b];
      EXPECT_LT(gap.norm(), 0.03F) << bone << " at " << t;
    }
    const auto joints = jointsOf(rig, posture);
    EXPECT_GT(joints[static_cast<std::size_t>(Joint::nose)].z(), 1.4F);
  }
}

TEST(SimulatorMotion, OnlyWhatCanBeReachedIsLeftFree) {
  World world = emptyRoom(4, 4);
  world.rooms.emplace_back(Eigen::Vector3d(4.12, 0, 0), Eigen::Vector3d(8, 4, 2.5));
  Walkway walkway(world, 0.3);
  EXPECT_TRUE(walkway.isFree({6, 2}));
  walkway.keepReachable({1, 1});
  EXPECT_TRUE(walkway.isFree({3, 3}));
  EXPECT_FALSE(walkway.isFree({6, 2}));
  EXPECT_LT(walkway.nearestFree({6, 2}).x(), 4.0);
}

TEST(SimulatorMotion, APersonPushedIntoAWallSlidesAlongIt) {
  const World world = emptyRoom(3, 1.2);
  const Walkway walkway(world, 0.3);
  const auto camera = [](double t) { return Vector2d(1.5, 1.2 - 0.1 * t); };
  const Crowd crowd({walker({1.5, 0.4}, {1.5, 0.4})}, walkway, camera, 10.0);
  for (double t = 0.0; t < 9.0; t += 0.05) EXPECT_TRUE(walkway.isFloor(crowd.at(0, t).at)) << t;
}

TEST(SimulatorMotion, WhatHasAPixelIsInTheViewCone) {
  const PinholeCamera camera;
  const double corner = std::hypot(0.5 * camera.width, 0.5 * camera.height) / camera.fx;
  const ViewCone cone{{1, 2, 1.4F}, {0, 0, 1}, static_cast<float>(std::atan(corner))};
  const Vector3f half(0.3F, 0.3F, 0.9F);
  for (int col = 0; col < camera.width; col += 40) {
    for (int row = 0; row < camera.height; row += 40) {
      for (const double z : {0.6, 2.0, 9.0}) {
        const Vector3f seen = cone.eye + camera.unproject(col, row, z).cast<float>();
        for (const Vector3f& off : {Vector3f(half), Vector3f(-half)}) {
          EXPECT_TRUE(cone.sees({seen + off - half, seen + off + half}));
        }
      }
    }
  }
  EXPECT_FALSE(cone.sees({Vector3f(1, 2, -4), Vector3f(2, 3, -2)}));
  EXPECT_FALSE(cone.sees({Vector3f(6, 2, 1), Vector3f(7, 3, 3)}));
}

}  // namespace
}  // namespace pf::simulator
