// SPDX-License-Identifier: BSD-3-Clause
// Scenes of several rooms, furnished by the seed and alike.
#include <gtest/gtest.h>
#include <tbb/global_control.h>

#include <fstream>
#include <nlohmann/json.hpp>

#include "simulator/output.hpp"
#include "simulator_scene.hpp"

namespace pf::simulator {
namespace {

/// Two small rooms alike, side by side; a robot goes from one into the other.
constexpr char kTwoRooms[] = R"(
duration_s: 30
fps: 1
rooms:
  - {name: one, size_m: [3.6, 3.6, 2.5], lamps: [1, 1], furniture: {style: lounge},
     doorways: [{wall: east, at_m: 0.7}]}
  - {name: two, like: one, origin_m: [3.72, 0], doorways: [{wall: west, at_m: 0.7}]}
people: [{name: anna, start_m: [5.5, 0.7], stray_m: 0.2, script: [{do: walk, to: [2.6, 0.7]}]}]
camera:
  motion: robot
  width: 80
  finds_way: true
  stray_m: 0.1
  repeats: false
  waypoints: [[2.6, 0.7], [6.4, 0.7]]
)";

std::vector<cv::Mat> picturesOf(std::uint32_t seed) {
  ScenarioChanges changes;
  changes.seed = seed;
  Simulation simulation(load(kTwoRooms, changes));
  std::vector<cv::Mat> pictures;
  for (int i = 0; i < 2; ++i) {
    const SimulatedFrame frame = simulation.frame(i);
    pictures.insert(pictures.end(), {frame.frame.color, frame.frame.depth});
  }
  return pictures;
}

TEST(SimulatorRooms, SameSeedSameBytesOnOneThreadAndOnTwo) {
  const auto many = picturesOf(5U), other = picturesOf(6U);
  const tbb::global_control one(tbb::global_control::max_allowed_parallelism, 1);
  const auto serial = picturesOf(5U);
  for (std::size_t i = 0; i < many.size(); ++i) {
    EXPECT_EQ(cv::norm(many[i], serial[i], cv::NORM_INF), 0.0) << i;
    EXPECT_GT(cv::norm(many[i], other[i], cv::NORM_INF), 0.0) << i;
  }
}

TEST(SimulatorRooms, EventsListTheRoomsAndWhenTheCameraWasInThem) {
  const TemporaryFolder folder;
  Simulation simulation(load(kTwoRooms));
  const auto output = openTumOutput(folder / "out", simulation);
  for (int i = 0; i < simulation.frameCount(); ++i) output->add(simulation.frame(i));
  output->finish(simulation);
  std::ifstream file(folder / "out/events.json");
  const auto events = nlohmann::json::parse(file);
  ASSERT_EQ(events["rooms"].size(), 2U);
  EXPECT_EQ(events["rooms"][1]["like"], "one");
  EXPECT_EQ(events["rooms"][1]["low_m"][0], 3.72);
  ASSERT_EQ(events["visits"].size(), 2U);
  EXPECT_EQ(events["visits"][0]["room"], "one");
  EXPECT_EQ(events["visits"][0]["start"], "1000.000000");
  EXPECT_EQ(events["visits"][0]["end"], events["visits"][1]["start"]);
  EXPECT_EQ(events["visits"][1]["room"], "two");
  EXPECT_EQ(events["visits"][1]["end"], "1030.050000");
}

TEST(SimulatorRooms, MistakesAreNamedWithTheirPlace) {
  const auto error = [](const std::string& rooms, const std::string& camera = "") {
    const std::string text = "duration_s: 0.2\nrooms: [{name: a, size_m: [4, 4, 2.5]}" + rooms +
                             "]\ncamera: {motion: robot, width: 32, " + camera + "}";
    return errorOf([&] { Simulation simulation(load(text)); });
  };
  const auto says = [](const std::string& text, const std::string& part) {
    EXPECT_NE(text.find(part), std::string::npos) << text;
  };
  const std::string way = "finds_way: true, waypoints: [[1, 1], [2, 1]";
  EXPECT_EQ(error("", way + "]"), "");
  says(error(", {name: a}", way + "]"), "rooms[1].name is 'a', as that of a room before");
  says(error(", {like: b}", way + "]"), "rooms[1].like is 'b', expected the name of a room before");
  says(error(", {furniture: {style: bar}}", way + "]"), "rooms[1].furniture.style is 'bar'");
  says(error(", {furniture: {style: office, seed: 1.5}}", way + "]"),
       "rooms[1].furniture.seed is 1.5");
  says(error("", "stray_m: 1, waypoints: [[1, 1]]"), "camera.stray_m needs finds_way: true");
  says(error("", way + ", [1]]"), "camera.waypoints is '[[1, 1], [2, 1], [1]]', expected a list");
  says(error(", {origin_m: [5, 0], size_m: [3, 3, 2.5]}", way + ", [6, 1, 90]]"),
       "camera.waypoints[2] is (6.00, 1.00), no way leads there");
}

}  // namespace
}  // namespace pf::simulator
