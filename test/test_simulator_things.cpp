// SPDX-License-Identifier: BSD-3-Clause
// Things that move: how they move, and scene files with impossible values.
#include <gtest/gtest.h>

#include <cmath>
#include <map>

#include "simulator/thing_stage.hpp"
#include "simulator_things_scene.hpp"

namespace pf::simulator {
namespace {

constexpr double kFast_m_s = 2.5, kFast_rad_s = 4.0;  // faster than people handle things

double yawOf(const Eigen::Isometry3d& T) { return std::atan2(T(1, 0), T(0, 0)); }

TEST(SimulatorThings, EachMovesOverItsWholeWayWithoutAJump) {
  const Simulation simulation(thingsScenario());
  for (std::size_t i = 0; i < simulation.things().size(); ++i) {
    const Trajectory poses = simulation.thingPoses(i, simulation.frameCount());
    ASSERT_GE(poses.size(), 10U) << i;
    for (std::size_t k = 1; k < poses.size(); ++k) {
      const double dt = 1e-9 * static_cast<double>(poses[k].stamp_ns - poses[k - 1].stamp_ns);
      ASSERT_GT(dt, 0.0);
      const Eigen::Isometry3d T = poses[k - 1].T_world_camera.inverse() * poses[k].T_world_camera;
      EXPECT_LT(T.translation().norm(), kFast_m_s * dt + 1e-6) << i << " at " << k;
      EXPECT_LT(std::abs(yawOf(T)), kFast_rad_s * dt + 1e-6) << i << " at " << k;
    }
  }
}

TEST(SimulatorThings, TheMovesInTheEventsAreOneChainFromTheFirstPlace) {
  const Scenario scenario = thingsScenario();
  const Simulation simulation(scenario);
  const auto changes = simulation.thingChanges(simulation.frameCount());
  ASSERT_EQ(changes.size(), scenario.things.size());
  for (std::size_t i = 0; i < changes.size(); ++i) {
    ASSERT_EQ(changes[i].size(), 1U) << scenario.things[i].name;
    EXPECT_EQ(changes[i][0].from.at_m, scenario.things[i].object.at_m);
    EXPECT_TRUE(changes[i][0].is_over) << scenario.things[i].name;
    EXPECT_GT(changes[i][0].end_s, changes[i][0].begin_s);
  }
  EXPECT_EQ(changes[kParcel][0].mover, 0);
  EXPECT_EQ(changes[kChair][0].mover, 0);
  EXPECT_EQ(changes[kTrolley][0].mover, ThingTrack::kItself);
  EXPECT_LT((changes[kParcel][0].to.at_m - Eigen::Vector3d(4.25, 3.2, 0.73)).norm(), 1e-9);
  EXPECT_LT((changes[kTrolley][0].to.at_m - Eigen::Vector3d(3.0, 0.5, 0.0)).norm(), 1e-9);
  EXPECT_LT((changes[kStool][0].to.at_m - Eigen::Vector3d(3.1, 1.2, 0.0)).norm(), 1e-9);
}

TEST(SimulatorThings, ADoorTurnsAboutItsHinge) {
  const Simulation simulation(thingsScenario());
  const Eigen::Vector3d hinge(0.0, 0.4, 0.0);
  const Trajectory poses = simulation.thingPoses(kDoor, simulation.frameCount());
  const Eigen::Vector3d first = poses.front().T_world_camera * hinge;
  for (const StampedPose& pose : poses) {
    EXPECT_LT((pose.T_world_camera * hinge - first).norm(), 1e-9);
  }
  const double turned = yawOf(poses.front().T_world_camera.inverse() * poses.back().T_world_camera);
  EXPECT_NEAR(turned, 80.0 * M_PI / 180.0, 1e-9);
}

TEST(SimulatorThings, WhatMovesUnseenIsInNoPictureMeanwhile) {
  Simulation simulation(thingsScenario({"things.4.moves.0.over_s=0.4"}));
  const auto changes = simulation.thingChanges(simulation.frameCount());
  int stool = 0, trolley = 0;
  for (int i = 0; i < simulation.frameCount(); ++i) {
    const SimulatedFrame frame = simulation.frame(i);
    stool += cv::countNonZero(frame.thing_mask == static_cast<int>(kStool) + 1);
    trolley += cv::countNonZero(frame.thing_mask == static_cast<int>(kTrolley) + 1);
  }
  EXPECT_EQ(changes[kStool].size(), 1U);
  EXPECT_EQ(stool, 0);
  EXPECT_GT(trolley, 500);
}

TEST(SimulatorThings, ABentWayKeepsItsEndsAndItsCornersAreCut) {
  const std::vector<Eigen::Vector3d> way{{0, 0, 0}, {2, 0, 0}, {2, 2, 0}};
  const auto smooth = rounded(way);
  EXPECT_EQ(smooth.front(), way.front());
  EXPECT_EQ(smooth.back(), way.back());
  double sharpest = 0.0;
  for (std::size_t i = 2; i < smooth.size(); ++i) {
    const Eigen::Vector3d a = (smooth[i - 1] - smooth[i - 2]).normalized();
    const Eigen::Vector3d b = (smooth[i] - smooth[i - 1]).normalized();
    sharpest = std::max(sharpest, std::acos(std::min(1.0, a.dot(b))));
  }
  EXPECT_LT(sharpest, 0.5 * M_PI / 2.0 + 1e-9);
}

TEST(SimulatorThings, ThePackagesScenariosMoveEachThingAndEndAtRest) {
  for (const char* name : {"movers_light", "office_day_light"}) {
    const Scenario scenario = loadScenario(name);
    const Simulation simulation(scenario);
    const auto changes = simulation.thingChanges(simulation.frameCount());
    std::size_t by_people = 0, all = 0;
    for (std::size_t i = 0; i < changes.size(); ++i) {
      EXPECT_FALSE(changes[i].empty()) << name << " " << scenario.things[i].name;
      for (const ThingChange& change : changes[i]) {
        EXPECT_TRUE(change.is_over) << name << " " << scenario.things[i].name;
        by_people += change.mover >= 0 ? 1 : 0;
        ++all;
      }
    }
    EXPECT_GE(by_people, 4U) << name;
    EXPECT_GE(all - by_people, 4U) << name;
  }
}

TEST(SimulatorThings, MistakesAreNamedWithTheirPlace) {
  const std::string room = "rooms: [{size_m: [4, 4, 2.5]}]\n";
  const std::string box = "{name: a, kind: box, at_m: [1, 1]}";
  const std::map<std::string, std::string> mistakes = {
      {"things: [{kind: box}]", "things[0].name is missing"},
      {"things: [" + box + ", " + box + "]", "things[1].name is 'a', as that of a thing before"},
      {"things: [{name: a, kind: window, at_m: [1, 1]}]", "things[0].kind is 'window'"},
      {"things: [{name: a, kind: box, at_m: [2, 2], moves: [{at_s: 1}]}]",
       "things[0].moves[0].to is missing"},
      {"things: [{name: a, kind: box, at_m: [2, 2], moves: [{to: [1, 2], path: [[1, 1]]}]}]",
       "things[0].moves[0].path is given beside to"},
      {"things: [{name: a, kind: box, at_m: [2, 2], moves: [{to: [1, 2], when: dark}]}]",
       "things[0].moves[0].when is 'dark'"},
      {"things: [{name: a, kind: box, at_m: [2, 2], moves: [{to: [1, 2], over_s: 5}, {at_s: 3, to: "
       "[1, 1]}]}]",
       "things[0].moves[1].at_s is before the move before has ended"},
      {"things: [" + box + "]\npeople: [{script: [{do: take, thing: b}]}]",
       "people[0].script[0].thing is 'b'"},
      {"things: [" + box + "]\npeople: [{script: [{do: put, at: [1, 1]}]}]",
       "people[0].script[0] puts down what nobody took"},
      {"things: [" + box + "]\npeople: [{script: [{do: take, thing: a}]}]",
       "people[0].script repeats with something in the hands"},
      {"things: [" + box + "]\npeople: [{script: [{do: push, thing: a}]}]",
       "people[0].script[0].to is missing"},
      {"things: [" + box + "]\npeople: [{script: [{do: swing, thing: a}]}]",
       "people[0].script[0].thing has no hinge_m"},
  };
  for (const auto& [text, expected] : mistakes) {
    const std::string error = errorOf([&] { load(room + text); });
    EXPECT_NE(error.find(expected), std::string::npos) << text << "\n" << error;
  }
}

TEST(SimulatorThings, PlacesOutsideOfAllRoomsAreRefused) {
  const std::string scene =
      "duration_s: 0.2\nrooms: [{size_m: [4, 4, 2.5]}]\n"
      "camera: {at_m: [1, 1, 1.2], look_at_m: [3, 3, 1]}\n";
  const std::map<std::string, std::string> mistakes = {
      {"things: [{name: a, kind: box, at_m: [9, 1]}]", "things[0].at_m is (9.00, 1.00), outside"},
      {"things: [{name: a, kind: box, at_m: [1, 1], moves: [{to: [9, 1]}]}]",
       "things[0].moves[0].path is (9.00, 1.00), outside"},
      {"things: [{name: a, kind: box, at_m: [2, 3]}]\n"
       "people: [{start_m: [2, 2], script: [{do: take, thing: a}, {do: put, at: [9, 1]}]}]",
       "people[0].script[1].at is (9.00, 1.00), outside"},
  };
  for (const auto& [text, expected] : mistakes) {
    const std::string error = errorOf([&] { Simulation simulation(load(scene + text)); });
    EXPECT_NE(error.find(expected), std::string::npos) << text << "\n" << error;
  }
}

}  // namespace
}  // namespace pf::simulator
