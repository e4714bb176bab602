// SPDX-License-Identifier: BSD-3-Clause
// posefusion_simulate from the command line: stopped, short of space, with bad outputs.
#include <gtest/gtest.h>
#include <rosbag/bag.h>
#include <rosbag/view.h>
#include <sensor_msgs/Imu.h>
#include <tf2_msgs/TFMessage.h>

#include <algorithm>
#include <chrono>
#include <csignal>
#include <filesystem>
#include <map>
#include <nlohmann/json.hpp>
#include <thread>

#include "full_disk.hpp"
#include "posefusion/io/files.hpp"
#include "posefusion/io/frame_source.hpp"
#include "posefusion/io/trajectory_file.hpp"
#include "posefusion_ros/bags/bag_source.hpp"
#include "posefusion_ros/bags/conversions.hpp"
#include "program.hpp"
#include "simulator_scene.hpp"

namespace pf {
namespace {

namespace fs = std::filesystem;

/// Minutes in an empty room with a fall near the beginning and one much later.
constexpr char kScene[] = R"(
duration_s: 400
rooms: [{size_m: [6, 6, 2.6], lamps: [1, 1]}]
camera:
  motion: robot
  waypoints: [[1, 1], [5, 1], [5, 5], [1, 5]]
  width: 64
  falls: [{at_s: 0.3, skip_m: 0.2}, {at_s: 300}]
)";

class SimulatorToolTest : public testing::Test {
 protected:
  std::string scene() const { return own.write("scene.yaml", kScene); }
  std::string log() const { return own / "log.txt"; }

  int run(std::vector<std::string> arguments) {
    const Program program("posefusion_simulate", std::move(arguments), log());
    const int code = program.exitCode();
    said = program.said();
    return code;
  }
  bool hasSaid(const std::string& text) const { return said.find(text) != std::string::npos; }

  /// Starts a recording, and stops it when some frames are made.
  int runAndStop(const std::string& output, int signal) {
    const Program program("posefusion_simulate", {scene(), "--output", output}, log());
    for (int i = 0; i < 1200; ++i) {
      std::this_thread::sleep_for(std::chrono::milliseconds(50));
      // Progress is printed every five seconds: frames are made by then.
      if (program.said().find("frames per second") != std::string::npos) break;
    }
    program.send(signal);
    const int code = program.exitCode();
    said = program.said();
    return code;
  }

  /// The truth covers the frames read back, and not much more.
  static void expectTruthOfTheFrames(FrameSource& source) {
    const Trajectory truth = source.truth();
    ASSERT_FALSE(truth.empty());
    std::int64_t first = 0, last = 0;
    while (const auto frame = source.next()) {
      if (first == 0) first = frame->frame.stamp_ns;
      last = frame->frame.stamp_ns;
    }
    EXPECT_LE(truth.front().stamp_ns, first);
    EXPECT_GE(truth.front().stamp_ns, first - 100'000'000);
    EXPECT_GE(truth.back().stamp_ns, last + 33'000'000);  // the depth comes after the colour
    EXPECT_LE(truth.back().stamp_ns, last + 300'000'000);
  }

  /// Nothing but these is in the folder.
  std::vector<std::string> files() const {
    std::vector<std::string> names;
    for (const auto& entry : fs::directory_iterator(own.str())) {
      names.push_back(entry.path().filename());
    }
    std::sort(names.begin(), names.end());
    return names;
  }

  TemporaryFolder own;
  std::string said;
};

TEST_F(SimulatorToolTest, AStoppedFolderHasTheTruthOfItsFrames) {
  EXPECT_EQ(runAndStop(own / "out", SIGINT), 130) << said;
  EXPECT_TRUE(hasSaid("frames are in " + own / "out")) << said;
  const auto source = openTumFolder(own / "out");
  ASSERT_GT(source->frameCount(), 5U);
  expectTruthOfTheFrames(*source);
  const auto events = nlohmann::json::parse(readFile(own / "out/events.json")).at("events");
  int falls = 0;
  for (const auto& event : events) falls += event.at("kind") == "fall" ? 1 : 0;
  EXPECT_EQ(falls, 1);
}

TEST_F(SimulatorToolTest, AStoppedBagIsWholeAndHasTheTruthOfItsFrames) {
  EXPECT_EQ(runAndStop(own / "out.bag", SIGTERM), 143) << said;
  EXPECT_EQ(files(), (std::vector<std::string>{"log.txt", "out.bag", "scene.yaml"}));
  const auto source = posefusion_ros::openBag(own / "out.bag");
  ASSERT_GT(source->frameCount(), 5U);
  expectTruthOfTheFrames(*source);
}

TEST_F(SimulatorToolTest, WithoutImagesOnlyTheTruthAndTheOtherSensorsAreWritten) {
  const auto into = [&](const std::string& output, const std::vector<std::string>& changes = {}) {
    std::vector<std::string> arguments{scene(), "--duration", "1", "--no-images", "--output"};
    arguments.push_back(own / output);
    arguments.insert(arguments.end(), changes.begin(), changes.end());
    return run(arguments);
  };
  EXPECT_EQ(into("out"), 0) << said;
  std::vector<std::string> names;
  for (const auto& entry : fs::directory_iterator(own / "out")) {
    names.push_back(entry.path().filename());
  }
  std::sort(names.begin(), names.end());
  EXPECT_EQ(names,
            (std::vector<std::string>{"base_camera.txt", "groundtruth.txt", "head_joints.csv",
                                      "imu.csv", "imu.yaml", "odometry.txt"}));
  const std::string before = readFile(own / "out/imu.csv");
  EXPECT_EQ(into("out", {"--seed", "9"}), 1);
  EXPECT_TRUE(hasSaid("groundtruth.txt: is of another recording")) << said;
  EXPECT_EQ(readFile(own / "out/imu.csv"), before);
  EXPECT_EQ(into("out", {"--set", "imu.rate_hz=100"}), 0) << said;
  EXPECT_LT(readFile(own / "out/imu.csv").size(), before.size());
  EXPECT_EQ(into("out.bag"), 1);
  EXPECT_TRUE(hasSaid("out.bag: is a bag, --no-images expects a folder")) << said;
}

TEST_F(SimulatorToolTest, ABagHasTheOtherSensorsAsAFolderHas) {
  for (const char* output : {"out", "out.bag"}) {
    ASSERT_EQ(run({scene(), "--duration", "0.3", "--output", own / output}), 0) << said;
  }
  const Trajectory odometry = loadTrajectory(own / "out/odometry.txt"),
                   neck = loadTrajectory(own / "out/base_camera.txt");
  rosbag::Bag bag(own / "out.bag");
  std::map<std::string, std::size_t> counts;
  std::size_t poses = 0;
  for (const rosbag::MessageInstance& message : rosbag::View(bag)) {
    ++counts[message.getTopic()];
    if (const auto imu = message.instantiate<sensor_msgs::Imu>()) {
      EXPECT_EQ(imu->header.frame_id, "imu_link");
      EXPECT_EQ(imu->orientation_covariance[0], -1.0);
    }
    const auto tf = message.instantiate<tf2_msgs::TFMessage>();
    if (!tf || tf->transforms[0].header.frame_id != "odom") continue;
    ASSERT_LT(poses, odometry.size());
    ASSERT_EQ(tf->transforms.size(), 3U);
    EXPECT_EQ(tf->transforms[1].header.frame_id, "base_link");
    EXPECT_EQ(tf->transforms[1].child_frame_id, "camera_rgb_optical_frame");
    EXPECT_EQ(tf->transforms[2].child_frame_id, "imu_link");
    EXPECT_EQ(posefusion_ros::toNs(tf->transforms[0].header.stamp), odometry[poses].stamp_ns);
    for (const auto& [part, pose] : {std::pair(0, odometry[poses]), std::pair(1, neck[poses])}) {
      const auto& t = tf->transforms[static_cast<std::size_t>(part)].transform.translation;
      const Eigen::Vector3d published(t.x, t.y, t.z);
      EXPECT_LT((published - pose.T_world_camera.translation()).norm(), 1e-7);
    }
    ++poses;
  }
  EXPECT_EQ(poses, odometry.size());
  EXPECT_EQ(counts["/odom"], odometry.size());
  EXPECT_EQ(counts["/joint_states"], odometry.size());
  EXPECT_EQ(counts["/imu/data"], 71U);
  EXPECT_EQ(counts["/tf"], counts["/truth"] + odometry.size());
}

TEST_F(SimulatorToolTest, AFullDiskLeavesNoPartOfABag) {
  const int code = [&] {
    const FullDisk full(300'000);
    return run({scene(), "--output", own / "out.bag", "--duration", "20"});
  }();
  EXPECT_EQ(code, 1) << said;
  EXPECT_TRUE(hasSaid("out.bag: cannot be written")) << said;
  EXPECT_EQ(files(), (std::vector<std::string>{"log.txt", "scene.yaml"}));
}

TEST_F(SimulatorToolTest, OutputsThatCannotBeAreRefusedByName) {
  own.write("file", "");
  own.write("old.bag", "old");
  const std::vector<std::string> here = {scene(), "--duration", "0.1", "--output"};
  const auto with = [&](const std::string& output) {
    auto arguments = here;
    arguments.push_back(own / output);
    return arguments;
  };
  EXPECT_EQ(run(with("file")), 1);
  EXPECT_TRUE(hasSaid("file: is there")) << said;
  EXPECT_EQ(run(with("file/out")), 1);
  EXPECT_TRUE(hasSaid("file/out/rgb: the folder cannot be made")) << said;
  EXPECT_EQ(run(with("old.bag")), 1);
  EXPECT_TRUE(hasSaid("old.bag: is there, expected a new bag")) << said;
  EXPECT_EQ(readFile(own / "old.bag"), "old");
  EXPECT_EQ(run(with("nowhere/out.bag")), 1);
  EXPECT_TRUE(hasSaid("nowhere/out.bag: cannot be written")) << said;
}

}  // namespace
}  // namespace pf
