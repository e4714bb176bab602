// SPDX-License-Identifier: BSD-3-Clause
// Scene files: the package's own are good, bad ones are refused with the place of the mistake.
#include <gtest/gtest.h>

#include <set>

#include "simulator/furniture.hpp"
#include "simulator/scene_check.hpp"
#include "simulator_scene.hpp"

namespace pf::simulator {
namespace {

std::string loadError(const std::string& text) {
  return errorOf([&] { load(text); });
}

bool contains(const std::string& text, const std::string& part) {
  return text.find(part) != std::string::npos;
}

const std::string kRoom = "rooms: [{size_m: [4, 4, 2.5]}]\n";

TEST(SimulatorScenario, AllScenariosOfThePackageLoad) {
  for (const char* name : {"walking_static",
                           "walking_xyz",
                           "walking_rpy",
                           "walking_halfsphere",
                           "sitting_static",
                           "sitting_xyz",
                           "sitting_halfsphere",
                           "loop_room",
                           "hrpslam1",
                           "hrpslam2",
                           "fall_short",
                           "empty_room",
                           "crowd",
                           "empty_box",
                           "box_walker",
                           "floor",
                           "floor_light",
                           "corridor",
                           "corridor_light",
                           "stairs_fall",
                           "stairs_fall_light",
                           "movers",
                           "movers_light",
                           "office_day",
                           "office_day_light"}) {
    const Scenario s = loadScenario(name);
    EXPECT_FALSE(s.rooms.empty()) << name;
    EXPECT_TRUE(s.robot || s.hand_held) << name;
  }
  EXPECT_EQ(loadScenario("walking_xyz").hand_held->pattern, "xyz");
  EXPECT_EQ(loadScenario("walking_xyz").people.size(), 2U);
  EXPECT_EQ(loadScenario("crowd").people.size(), 10U);
  EXPECT_EQ(loadScenario("empty_room").people.size(), 0U);
  EXPECT_EQ(loadScenario("hrpslam1").robot->falls.size(), 2U);
  EXPECT_EQ(loadScenario("hrpslam2").robot->falls.size(), 5U);
  EXPECT_EQ(loadScenario("hrpslam1").duration_s, 840.0);
  EXPECT_EQ(loadScenario("hrpslam2").duration_s, 780.0);
}

TEST(SimulatorScenario, PeopleOfThePackagesScenariosFindRoom) {
  // The others have the people and the rooms of one of these.
  for (const char* name : {"walking_static", "sitting_static", "loop_room", "hrpslam1", "crowd",
                           "box_walker", "stairs_fall", "movers", "office_day"}) {
    const Scenario s = loadScenario(name);
    World world;
    for (const auto& room : s.rooms) addRoom(world, room, 1U);
    for (const auto& object : s.objects) addObject(world, object);
    EXPECT_EQ(errorOf([&] { checkScene(s, world); }), "") << name;
  }
}

TEST(SimulatorScenario, TheCorridorsBareWallIsCloseForAWhile) {
  const Simulation simulation(loadScenario("corridor_light"));
  const int frames = simulation.frameCount();
  double close_s = 0.0;
  for (const StampedPose& pose : simulation.truth(frames)) {
    const double wall_m = pose.T_world_camera.translation().y();
    const bool faces_it = pose.T_world_camera.linear()(1, 2) < -0.95;
    close_s += faces_it && wall_m > 0.0 && wall_m < 0.62 ? 0.005 : 0.0;
  }
  EXPECT_GT(close_s, 12.0);
  std::set<std::string> rooms;
  for (const Visit& visit : simulation.visits(frames)) rooms.insert(visit.room);
  EXPECT_EQ(rooms, (std::set<std::string>{"corridor", "kitchen", "library", "office"}));
}

TEST(SimulatorScenario, TheFallDownStairsEndsAFloorLower) {
  const Simulation simulation(loadScenario("stairs_fall_light"));
  const auto events = simulation.events(simulation.frameCount());
  ASSERT_EQ(events.size(), 2U);
  const Trajectory truth = simulation.truth(simulation.frameCount());
  EXPECT_NEAR(truth.front().T_world_camera.translation().z(), 2.06, 0.05);
  EXPECT_NEAR(truth.back().T_world_camera.translation().z(), 1.38, 0.05);
}

TEST(SimulatorScenario, TheCameraIsThatOfTheSeedUnlessItIsNamed) {
  ScenarioChanges changes;
  EXPECT_EQ(loadScenario("walking_xyz").depth.specimen, 1);
  changes.seed = 5U;
  EXPECT_EQ(loadScenario("walking_xyz", changes).depth.specimen, 5);
  changes.seed = 1000000000U;
  EXPECT_LE(loadScenario("walking_xyz", changes).depth.specimen, 1000000);
  changes.assignments = {"depth.specimen=1"};
  EXPECT_EQ(loadScenario("walking_xyz", changes).depth.specimen, 1);
  EXPECT_EQ(load(kRoom + "seed: 7\ndepth: {specimen: 2}\n").depth.specimen, 2);
  EXPECT_EQ(load(kRoom + "seed: 7\ndepth: {axial: 2}\n").depth.specimen, 7);
}

TEST(SimulatorScenario, EveryValueCanBeChanged) {
  ScenarioChanges changes;
  changes.assignments = {"camera.period_s=7", "people.1.height_m=1.9", "color.noise=0"};
  changes.duration_s = 2.5;
  const Scenario s = loadScenario("walking_xyz", changes);
  EXPECT_EQ(s.hand_held->period_s, 7.0);
  EXPECT_EQ(s.people[1].build.height_m, 1.9);
  EXPECT_EQ(s.color.noise, 0.0);
  EXPECT_EQ(s.duration_s, 2.5);
  changes.assignments = {"people.7.height_m=1.9"};
  EXPECT_TRUE(contains(errorOf([&] { loadScenario("walking_xyz", changes); }), "'7' is no entry"));
  changes.assignments = {"duration_s.x=1"};
  EXPECT_TRUE(contains(errorOf([&] { loadScenario("walking_xyz", changes); }),
                       "--set duration_s.x=1: 'x' is within a single value"));
  changes.assignments = {};
  changes.start_s = 99999.0;
  EXPECT_TRUE(contains(errorOf([&] { loadScenario("walking_xyz", changes); }),
                       "walking_xyz: start_s is 99999, expected 0 to 36000"));
}

TEST(SimulatorScenario, MistakesAreNamedWithTheirPlace) {
  EXPECT_TRUE(contains(errorOf([] { loadScenario("nowhere"); }), "walking_xyz"));
  EXPECT_TRUE(contains(errorOf([] { loadScenario("nowhere.yaml"); }), "nowhere.yaml"));
  EXPECT_TRUE(contains(loadError("rooms: ["), "YAML"));
  EXPECT_TRUE(contains(loadError("duration_s: 3"), "rooms is missing"));
  EXPECT_TRUE(contains(loadError(kRoom + "colour: {}"), "colour is unknown"));
  EXPECT_TRUE(contains(loadError(kRoom + "camera: {motion: fly}"), "halfsphere"));
  EXPECT_TRUE(contains(loadError(kRoom + "camera: {wdith: 3}"), "camera.wdith is unknown"));
  EXPECT_TRUE(contains(loadError(kRoom + "duration_s: long"), "expected a number"));
  EXPECT_TRUE(contains(loadError(kRoom + "duration_s: -3"), "duration_s is -3"));
  EXPECT_TRUE(
      contains(loadError(kRoom + "objects: [{kind: table, at_m: [1]}]"), "objects[0].at_m"));
  EXPECT_TRUE(contains(loadError(kRoom + "objects: [{kind: chiar, at_m: [1, 1]}]"), "chair"));
  EXPECT_TRUE(contains(loadError(kRoom + "people: [{script: [{do: fly}]}]"),
                       "people[0].script[0].do is 'fly'"));
  EXPECT_TRUE(contains(loadError("base: scene.yaml\n" + kRoom), "leads back"));
  EXPECT_TRUE(contains(loadError("base: [a]\n" + kRoom), "scene.yaml: base is not"));
  EXPECT_TRUE(contains(loadError(kRoom + "fps: 9\nfps: 8"), "scene.yaml: fps is given twice"));
  EXPECT_TRUE(contains(loadError(kRoom + "seed: 1.5"), "seed is 1.5, expected a whole number"));
  EXPECT_TRUE(contains(loadError(kRoom + "duration_s: 0"), "duration_s is 0, expected 0.05 to"));
  EXPECT_TRUE(contains(loadError(kRoom + "depth: {min_m: 9}"), "depth.min_m"));
  EXPECT_TRUE(contains(loadError("rooms: [{walls: fur}]"), "rooms[0].walls is 'fur'"));
  const std::string robot = "camera: {motion: robot, waypoints: [[1, 1], [3, 1]], ";
  EXPECT_TRUE(contains(loadError(kRoom + robot + "falls: [{at_s: 9}, {at_s: 3}]}"),
                       "falls[1].at_s is not after"));
  EXPECT_TRUE(contains(loadError(kRoom + robot + "turn_deg_s: 0}"), "turn_deg_s"));
}

TEST(SimulatorScenario, ImpossibleGeometryIsRefused) {
  const auto build = [](const std::string& rest) {
    const std::string rooms = contains(rest, "rooms:") ? "" : kRoom;
    return errorOf([&] { Simulation simulation(load(rooms + "duration_s: 0.2\n" + rest)); });
  };
  EXPECT_EQ(build("camera: {at_m: [1, 1, 1.2], look_at_m: [3, 3, 1]}"), "");
  EXPECT_TRUE(contains(build("camera: {at_m: [-1, 1, 1.2], look_at_m: [3, 3, 1]}"), "outside"));
  EXPECT_TRUE(
      contains(build("camera: {at_m: [0.02, 1, 1.2], look_at_m: [3, 1, 1], shake: 0}"), "8 cm"));
  EXPECT_TRUE(contains(build("camera: {at_m: [2, 2, 0.9], look_at_m: [3, 3, 1]}\n"
                             "objects: [{kind: pillar, at_m: [2, 2], size_m: [0.8, 0.8, 2.4]}]"),
                       "inside"));
  EXPECT_TRUE(contains(build("camera: {at_m: [1, 1, 1], look_at_m: [1, 1, 2]}"), "straight above"));
  EXPECT_TRUE(contains(build("camera: {at_m: [1, 1, 1.2], look_at_m: [3, 3, 1]}\n"
                             "people: [{start_m: [2, 2], script: [{do: walk, to: [9, 2]}]}]"),
                       "people[0].script[0]"));
  const std::string table =
      "camera: {at_m: [1, 1, 1.2], look_at_m: [3, 3, 1]}\n"
      "objects: [{kind: table, at_m: [2.5, 2.5]}]\n";
  EXPECT_TRUE(contains(build(table + "people: [{start_m: [2.5, 2.6]}]"),
                       "scene.yaml: people[0].start_m is (2.50, 2.60), inside"));
  EXPECT_TRUE(
      contains(build(table + "people: [{start_m: [1, 3], script: [{do: walk, to: [2.5, 2.5]}]}]"),
               "people[0].script[0].to is (2.50, 2.50), inside"));
  EXPECT_TRUE(contains(build("people: [{start_m: [1, 3], script: [{do: walk, to: [6, 3]}]}]\n"
                             "rooms: [{size_m: [4, 4, 2.5]}, "
                             "{origin_m: [4.2, 0], size_m: [4, 4, 2.5]}]\n"),
                       "people[0].script[0].to is (6.00, 3.00), no way leads there"));
  EXPECT_TRUE(contains(build("objects: [{kind: table, at_m: [9, 1]}]"),
                       "scene.yaml: objects[0].at_m is (9.00, 1.00), outside"));
  EXPECT_TRUE(contains(build("objects: [{kind: table, texture: fur, at_m: [1, 1]}]"), "fur"));
}

}  // namespace
}  // namespace pf::simulator
