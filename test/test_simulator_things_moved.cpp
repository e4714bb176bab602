// SPDX-License-Identifier: BSD-3-Clause
// Pictures and files of things that move agree with their poses.
#include <gtest/gtest.h>
#include <tbb/global_control.h>

#include <fstream>
#include <nlohmann/json.hpp>
#include <opencv2/core.hpp>

#include "posefusion/core/trajectory.hpp"
#include "posefusion/io/things_file.hpp"
#include "posefusion/io/trajectory_file.hpp"
#include "simulator/output.hpp"
#include "simulator_things_scene.hpp"

namespace pf::simulator {
namespace {

bool same(const cv::Mat& a, const cv::Mat& b) {
  return a.size() == b.size() && a.type() == b.type() && cv::norm(a, b, cv::NORM_INF) == 0.0;
}

/// A pixel's point in the world.
Eigen::Vector3d pointAt(const SimulatedFrame& frame, int row, int col) {
  const double z = 1e-3 * frame.frame.depth.at<std::uint16_t>(row, col);
  return frame.T_world_camera * frame.frame.camera.unproject(col, row, z);
}

TEST(SimulatorThingsMoved, DepthOfAThingsPixelsLiesOnIt) {
  Simulation simulation(thingsScenario());
  const int frames = simulation.frameCount();
  std::vector<int> pixels(simulation.things().size(), 0);
  for (int i = 0; i < frames; i += 3) {
    const SimulatedFrame frame = simulation.frame(i);
    for (std::size_t thing = 0; thing < pixels.size(); ++thing) {
      const auto pose = poseAt(simulation.thingPoses(thing, frames), frame.depth_stamp_ns);
      if (!pose) continue;
      Eigen::AlignedBox3d box = simulation.things()[thing].box;
      box.extend(Eigen::Vector3d(box.min().array() - 0.01));
      box.extend(Eigen::Vector3d(box.max().array() + 0.01));
      const cv::Mat mask = frame.thing_mask == static_cast<int>(thing) + 1;
      for (int row = 0; row < mask.rows; ++row) {
        for (int col = 0; col < mask.cols; ++col) {
          if (mask.at<std::uint8_t>(row, col) == 0) continue;
          if (frame.frame.depth.at<std::uint16_t>(row, col) == 0) continue;
          ++pixels[thing];
          ASSERT_EQ(frame.mask.at<std::uint8_t>(row, col), 0);
          ASSERT_TRUE(box.contains(pose->inverse() * pointAt(frame, row, col)))
              << thing << " in frame " << i;
        }
      }
    }
  }
  for (const std::size_t thing : {kParcel, kChair, kDoor, kTrolley}) {
    EXPECT_GT(pixels[thing], 50) << thing;
  }
}

TEST(SimulatorThingsMoved, WhatRestsIsNotMasked) {
  Simulation simulation(thingsScenario());
  const auto changes = simulation.thingChanges(simulation.frameCount());
  for (int i = 0; i < simulation.frameCount(); i += 2) {
    const double time_s = (i + 1) / 5.0;
    const cv::Mat mask = simulation.frame(i).thing_mask;
    for (std::size_t thing = 0; thing < changes.size(); ++thing) {
      const ThingChange& change = changes[thing][0];
      if (time_s > change.begin_s - 0.15 && time_s < change.end_s + 0.15) continue;
      EXPECT_EQ(cv::countNonZero(mask == static_cast<int>(thing) + 1), 0) << thing << " " << i;
    }
  }
}

TEST(SimulatorThingsMoved, WithoutMotionTheWalkIsTheSameAndAllStayAtTheirStart) {
  Simulation moved(thingsScenario()), still(thingsScenario({"things_move=false"}));
  const int frames = moved.frameCount();
  for (std::size_t i = 0; i < still.things().size(); ++i) {
    EXPECT_TRUE(still.thingChanges(frames)[i].empty());
    const Trajectory poses = still.thingPoses(i, frames), before = moved.thingPoses(i, frames);
    for (const StampedPose& pose : poses) {
      EXPECT_TRUE(pose.T_world_camera.isApprox(before.front().T_world_camera));
    }
  }
  const Trajectory a = moved.truth(frames), b = still.truth(frames);
  ASSERT_EQ(a.size(), b.size());
  EXPECT_TRUE(a.back().T_world_camera.isApprox(b.back().T_world_camera, 0.0));
  EXPECT_TRUE(same(moved.frame(0).frame.depth, still.frame(0).frame.depth));
  const SimulatedFrame last = still.frame(frames - 1);
  EXPECT_EQ(cv::countNonZero(last.thing_mask), 0);
  EXPECT_FALSE(same(moved.frame(frames - 1).frame.depth, last.frame.depth));
}

TEST(SimulatorThingsMoved, TheSceneIsThatOfTheLastFrame) {
  const Simulation simulation(thingsScenario());
  const auto& things = simulation.things();
  for (const int frames : {1, simulation.frameCount()}) {
    const Mesh scene = simulation.sceneAfter(frames);
    std::size_t vertex = simulation.world().mesh.positions.size();
    for (std::size_t i = 0; i < things.size(); ++i) {
      const Eigen::Isometry3d T = simulation.thingPoses(i, frames).back().T_world_camera;
      for (const Eigen::Vector3f& p : things[i].mesh.positions) {
        const Eigen::Vector3d expected = T * p.cast<double>();
        ASSERT_LT((scene.positions[vertex++].cast<double>() - expected).norm(), 1e-4) << i;
      }
    }
    EXPECT_EQ(vertex, scene.positions.size());
  }
}

TEST(SimulatorThingsMoved, OneThreadMakesTheSameBytesAsMany) {
  const auto drawn = [] {
    ScenarioChanges changes;
    changes.start_s = 1.5;  // the door is on its way
    changes.duration_s = 0.4;
    Simulation simulation(load(thingsScene(), changes));
    return std::vector<SimulatedFrame>{simulation.frame(0), simulation.frame(1)};
  };
  const auto many = drawn();
  const tbb::global_control one(tbb::global_control::max_allowed_parallelism, 1);
  const auto serial = drawn();
  EXPECT_GT(cv::countNonZero(many[0].thing_mask), 50);
  for (std::size_t i = 0; i < many.size(); ++i) {
    EXPECT_TRUE(same(many[i].frame.color, serial[i].frame.color));
    EXPECT_TRUE(same(many[i].frame.depth, serial[i].frame.depth));
    EXPECT_TRUE(same(many[i].thing_mask, serial[i].thing_mask));
  }
}

TEST(SimulatorThingsMoved, TheFolderDescribesTheThings) {
  const TemporaryFolder folder;
  ScenarioChanges changes;
  changes.duration_s = 3.0;
  Simulation simulation(load(thingsScene(), changes));
  const std::string path = folder / "recording";
  const auto output = openTumOutput(path, simulation);
  for (int i = 0; i < simulation.frameCount(); ++i) output->add(simulation.frame(i));
  output->finish(simulation);
  std::ifstream file(path + "/events.json");
  const auto things = nlohmann::json::parse(file).at("things");
  ASSERT_EQ(things.size(), 5U);
  const auto& door = things[kDoor];
  EXPECT_EQ(door.at("name"), "door");
  EXPECT_EQ(door.at("moves").at(0).at("begin"), "1001.000000");
  EXPECT_EQ(door.at("moves").at(0).at("end"), "1002.500000");
  const Trajectory poses = loadTrajectory(path + "/things/3.txt");
  EXPECT_EQ(poses.front().stamp_ns, simulation.thingPoses(kDoor, 15).front().stamp_ns);
  const auto recorded = loadThings(path);
  ASSERT_EQ(recorded.size(), 5U);
  ASSERT_EQ(recorded[kDoor].moves.size(), 1U);
  EXPECT_EQ(recorded[kDoor].moves[0].begin_ns, poses[1].stamp_ns);
  EXPECT_TRUE(recorded[kDoor].moves[0].to.isApprox(poses.back().T_world_camera, 1e-4));
  for (const char* name : {"/things/3.ply", "/things/room_points.ply", "/scene.ply"}) {
    EXPECT_TRUE(std::ifstream(path + name).good()) << name;
  }
}

}  // namespace
}  // namespace pf::simulator
