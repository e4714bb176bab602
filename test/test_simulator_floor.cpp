// SPDX-License-Identifier: BSD-3-Clause
// The floor: its ways touch nothing, and the rooms that are to look alike do.
#include <gtest/gtest.h>

#include <cmath>
#include <set>

#include "simulator/crowd.hpp"
#include "simulator/renderer.hpp"
#include "simulator/scene_check.hpp"
#include "simulator/settled.hpp"
#include "simulator_scene.hpp"

namespace pf::simulator {
namespace {

using Eigen::Vector2d;

/// A scenario's rooms and things without their pictures, and the scenario settled in it.
struct Built {
  explicit Built(const Scenario& read) {
    world.plain = true;
    for (const auto& room : read.rooms) addRoom(world, room, 1U);
    for (const auto& object : read.objects) addObject(world, object);
    scenario = settled(read, world);
  }
  World world;
  Scenario scenario;
};

Scenario floorOf(std::uint32_t seed, const std::string& name = "floor") {
  ScenarioChanges changes;
  changes.seed = seed;
  return loadScenario(name, changes);
}

Vector2d within(const Footprint& f, const Vector2d& p) {
  const Vector2d d = Eigen::Rotation2Dd(-f.yaw) * (p - f.centre);
  return f.half_size - d.cwiseAbs();
}

double toFurniture(const World& world, const Vector2d& p) {
  double least = 1e9;
  for (const auto& f : world.footprints) {
    least = std::min(least, (-within(f, p)).cwiseMax(0.0).norm());
  }
  return least;
}

/// To the nearest wall, or to the jamb of a doorway; below 0 in a wall.
double toWalls(const World& world, const Vector2d& p) {
  constexpr double kJamb_m = 0.28;  // a passage is the middle of a doorway
  double most = -1e9;
  for (const auto& room : world.rooms) {
    const Vector2d low = p - room.min().head<2>(), high = room.max().head<2>() - p;
    most = std::max(most, std::min(low.minCoeff(), high.minCoeff()));
  }
  for (const auto& passage : world.passages) {
    const Vector2d inside = within(passage, p);
    if (inside.y() > 0.0) most = std::max(most, inside.x() + kJamb_m);
  }
  return most;
}

std::string roomAt(const Scenario& scenario, const Vector2d& p) {
  for (const auto& room : scenario.rooms) {
    const Eigen::Array2d inside = p - room.origin_m;
    if ((inside > 0.0).all() && (inside < room.size_m.head<2>().array()).all()) return room.name;
  }
  return "";
}

TEST(SimulatorFloor, TheRobotGoesThroughAllRoomsAndTouchesNothing) {
  for (const std::uint32_t seed : {1U, 2U, 3U}) {
    const Built floor(floorOf(seed));
    EXPECT_EQ(errorOf([&] { checkScene(floor.scenario, floor.world); }), "") << seed;
    const double end_s = floor.scenario.duration_s;
    const auto path = makeRobot(*floor.scenario.robot, end_s, seed);
    std::set<std::string> visited;
    double bare_m = 0.0;
    Vector2d last = path->at(0.0).translation().head<2>();
    for (double t = 0.0; t < end_s; t += 0.2) {
      const Eigen::Isometry3d pose = path->at(t);
      const Vector2d at = pose.translation().head<2>();
      ASSERT_GT(toFurniture(floor.world, at), 0.2) << seed << ": " << at.transpose();
      ASSERT_GT(toWalls(floor.world, at), 0.2) << seed << ": " << at.transpose();
      visited.insert(roomAt(floor.scenario, at));
      const bool faces_wall = pose.linear()(1, 2) < -0.9 && std::abs(at.y() - 0.55) < 0.05;
      bare_m += faces_wall ? (at - last).norm() : 0.0;
      last = at;
    }
    for (const auto& room : floor.scenario.rooms) EXPECT_EQ(visited.count(room.name), 1U);
    EXPECT_GT(bare_m, 34.0) << "there and back before a bare wall";
    EXPECT_EQ(roomAt(floor.scenario, last), "office");
    EXPECT_LT((path->at(end_s - 2.0).translation() - path->at(end_s - 0.1).translation()).norm(),
              0.05)
        << seed << " is still on the way";
  }
}

TEST(SimulatorFloor, PeopleGoThroughDoorwaysNotThroughWalls) {
  for (const std::uint32_t seed : {1U, 2U, 3U}) {
    const Built floor(floorOf(seed));
    constexpr double kEnd_s = 500.0;
    const auto path = makeRobot(*floor.scenario.robot, kEnd_s, seed);
    const Crowd crowd(
        floor.scenario.people, Walkway(floor.world, kWalkClearance_m),
        [&](double t) { return Vector2d(path->at(t).translation().head<2>()); }, kEnd_s);
    for (std::size_t person = 0; person < crowd.size(); ++person) {
      std::set<std::string> visited;
      for (double t = 0.0; t < kEnd_s; t += 0.1) {
        const Vector2d at = crowd.at(person, t).at;
        ASSERT_GT(toWalls(floor.world, at), 0.12) << seed << ": " << at.transpose();
        visited.insert(roomAt(floor.scenario, at));
      }
      EXPECT_GE(visited.size(), 3U) << floor.scenario.people[person].name;
    }
  }
}

/// What is seen from a place of a room (from its low corner) eastwards.
cv::Mat depthIn(const Built& built, const RayCaster& caster, const std::string& name) {
  cv::Mat depth_m;
  for (const auto& room : built.scenario.rooms) {
    if (room.name != name) continue;
    const Eigen::Vector3d eye(room.origin_m.x() + 0.9, room.origin_m.y() + 3.9, 1.4);
    const Eigen::Isometry3d pose = lookAt(eye, eye + Eigen::Vector3d(1.0, -0.9, -0.2));
    const ViewSample sample{pose.linear().cast<float>(), pose.translation().cast<float>(), 0.0F};
    const std::vector<Avatar> no_people;
    const std::vector<ThingShape> nothing;
    DepthView view;
    Renderer(built.world, caster)
        .depth(built.scenario.camera, sample, {caster, no_people, nothing, 1U}, view);
    depth_m = view.depth_m.clone();
  }
  return depth_m;
}

/// The share of pixels whose depths are not the same.
double difference(const cv::Mat& a, const cv::Mat& b) {
  cv::Mat apart;
  cv::absdiff(a, b, apart);
  return cv::countNonZero(apart > 0.002) / static_cast<double>(a.total());
}

TEST(SimulatorFloor, RoomsAlikeLookAlikeAndOthersDoNot) {
  cv::Mat office_before;
  for (const std::uint32_t seed : {1U, 2U}) {
    const Built floor(floorOf(seed, "floor_light"));
    const RayCaster caster(floor.world.mesh);
    const cv::Mat office = depthIn(floor, caster, "office");
    EXPECT_LT(difference(office, depthIn(floor, caster, "twin_office")), 0.002) << seed;
    for (const char* other : {"meeting", "kitchen", "workshop", "store", "lounge", "library"}) {
      EXPECT_GT(difference(office, depthIn(floor, caster, other)), 0.3) << seed << " " << other;
    }
    if (!office_before.empty()) {
      EXPECT_GT(difference(office, office_before), 0.3);
    }
    office_before = office;
  }
}

TEST(SimulatorFloor, TheLightOneHasTheSameRoomsAndWays) {
  const Built full(floorOf(3U)), light(floorOf(3U, "floor_light"));
  EXPECT_EQ(full.world.mesh.positions, light.world.mesh.positions);
  const auto &a = full.scenario.robot->waypoints, &b = light.scenario.robot->waypoints;
  ASSERT_EQ(a.size(), b.size());
  for (std::size_t i = 0; i < a.size(); ++i) EXPECT_EQ(a[i].at, b[i].at);
  ASSERT_EQ(full.scenario.people.size(), light.scenario.people.size());
  for (std::size_t i = 0; i < full.scenario.people.size(); ++i) {
    EXPECT_EQ(full.scenario.people[i].start_m, light.scenario.people[i].start_m);
  }
  EXPECT_EQ(light.scenario.camera.width, 320);
  EXPECT_FALSE(light.scenario.color.motion_blur);
  EXPECT_NE(floorOf(4U).objects[0].seed, full.scenario.objects[0].seed);
  EXPECT_NE(Built(floorOf(4U)).scenario.robot->waypoints[0].at, a[0].at);
}

}  // namespace
}  // namespace pf::simulator
