// SPDX-License-Identifier: BSD-3-Clause
// Poses with their covariance, and a user's hint of the place of a lost camera.
#include <geometry_msgs/PoseStamped.h>
#include <geometry_msgs/PoseWithCovarianceStamped.h>
#include <gtest/gtest.h>
#include <nav_msgs/Odometry.h>
#include <rosgraph_msgs/Log.h>

#include <limits>

#include "../temporary_folder.hpp"
#include "chain_fixture.hpp"
#include "posefusion/core/error.hpp"
#include "posefusion/io/saved_map_file.hpp"
#include "posefusion_ros/place_hint.hpp"

namespace posefusion_ros {
namespace {

using geometry_msgs::PoseWithCovarianceStamped;

PoseWithCovarianceStamped hintAt(double x_m, double y_m, const std::string& frame = "map") {
  PoseWithCovarianceStamped hint;
  hint.header.frame_id = frame;
  hint.pose.pose.position.x = x_m;
  hint.pose.pose.position.y = y_m;
  hint.pose.pose.orientation.w = 1;
  return hint;
}

/// A chain that begins in a map of the empty room, lost.
class ChainHint : public testing::Test {
 protected:
  void SetUp() override {
    pf::Config config;
    config.frame.shrink = 1;
    pf::Mapper mapper(config);
    for (int i = 0; i < 20; ++i) mapper.process({emptyRoom().frame(i).frame, {}, {}});
    {
      pf::MapRecording recording(folder / "map.pfdb", pf::MapWriter::Mode::create, "", mapper);
      recording.update(emptyRoom().frame(0).frame.camera, mapper);
      recording.finish(mapper);
    }
    const auto* test = testing::UnitTest::GetInstance()->current_test_info();
    chain = std::make_unique<Chain>(std::string("hint_") + test->name());
    chain->set("frame/shrink", 1);
    chain->set("map_file", folder / "map.pfdb");
    chain->set("localize_only", true);
    publisher = chain->handle().advertise<PoseWithCovarianceStamped>(topics::kInitialPose, 1);
    log = ros::NodeHandle().subscribe("/rosout", 1000, &ChainHint::onLog, this);
    ASSERT_TRUE(chain->load());
    ASSERT_TRUE(Chain::waitUntil([&] { return publisher.getNumSubscribers() > 0; }));
  }
  /// Returns when fusion has it.
  void say(const PoseWithCovarianceStamped& hint) {
    publisher.publish(hint);
    ros::WallDuration(0.5).sleep();
  }
  TrackingStatusMsg process(int index) {
    pf::RgbdFrame frame = emptyRoom().frame(index % 40).frame;
    frame.stamp_ns = 1'000'000'000LL + index * 33'333'333LL;
    return chain->process(toMessages(frame));
  }
  bool hasLogged(const std::string& text) {
    return Chain::waitUntil(
        [&] {
          const std::lock_guard<std::mutex> lock(mutex);
          return said.find(text) != std::string::npos;
        },
        5);
  }
  void onLog(const rosgraph_msgs::Log::ConstPtr& message) {
    const std::lock_guard<std::mutex> lock(mutex);
    said += message->msg + "\n";
  }
  /// Shows frames until one is located; the error of its position (m), or -1.
  double errorWhenFound() {
    for (int i = 0; i < 60; ++i) {
      const TrackingStatusMsg status = process(i);
      if (!status.located) continue;
      const Eigen::Isometry3d T_first_camera =
          emptyRoom().frame(0).T_map_camera.inverse() * emptyRoom().frame(i % 40).T_map_camera;
      const Eigen::Vector3d expected = pf::bodyFromOptical() * T_first_camera.translation();
      const auto& at = status.pose.position;
      return (expected - Eigen::Vector3d(at.x, at.y, at.z)).norm();
    }
    return -1;
  }

  const pf::TemporaryFolder folder;
  std::unique_ptr<Chain> chain;
  ros::Publisher publisher;
  ros::Subscriber log;
  std::mutex mutex;
  std::string said;
};

TEST_F(ChainHint, ALostCameraIsSearchedForAtTheHint) {
  say(hintAt(0, 0));
  const double error_m = errorWhenFound();
  EXPECT_TRUE(hasLogged("initialpose: the camera is looked for there too")) << said;
  EXPECT_GE(error_m, 0) << "not found";
  EXPECT_LT(error_m, 0.05);
  say(hintAt(0, 0));
  process(60);
  EXPECT_TRUE(hasLogged("initialpose: the camera is not lost: nothing changes")) << said;
}

TEST_F(ChainHint, AWrongPlaceIsRejected) {
  say(hintAt(7, -5));
  const double error_m = errorWhenFound();
  EXPECT_TRUE(hasLogged("initialpose: the camera is looked for there too")) << said;
  EXPECT_GE(error_m, 0) << "not found";
  EXPECT_LT(error_m, 0.05);
}

TEST_F(ChainHint, WhatIsNoPoseInTheMapIsRefusedAndTheChainGoesOn) {
  say(hintAt(0, 0, "base"));
  process(0);
  EXPECT_TRUE(hasLogged("initialpose: is in the frame 'base', expected map")) << said;
  PoseWithCovarianceStamped broken = hintAt(0, 0);
  broken.pose.pose.orientation.w = 0;
  say(broken);
  process(1);
  EXPECT_TRUE(hasLogged("initialpose: is no pose, expected finite numbers")) << said;
}

TEST_F(ChainHint, PosesHaveTheCovarianceOfTheOdometry) {
  boost::shared_ptr<const PoseWithCovarianceStamped> with;
  nav_msgs::Odometry::ConstPtr odometry;
  geometry_msgs::PoseStamped::ConstPtr plain;
  const auto lock = [&] { return std::lock_guard<std::mutex>(mutex); };
  ros::NodeHandle& handle = chain->handle();
  const auto a = handle.subscribe<PoseWithCovarianceStamped>(
      topics::kPoseWithCovariance, 1, [&](const PoseWithCovarianceStamped::ConstPtr& m) {
        const auto guard = lock();
        with = m;
      });
  const auto b = handle.subscribe<nav_msgs::Odometry>(topics::kOdometry, 1,
                                                      [&](const nav_msgs::Odometry::ConstPtr& m) {
                                                        const auto guard = lock();
                                                        odometry = m;
                                                      });
  const auto c = handle.subscribe<geometry_msgs::PoseStamped>(
      topics::kPose, 1, [&](const geometry_msgs::PoseStamped::ConstPtr& m) {
        const auto guard = lock();
        plain = m;
      });
  ASSERT_GE(errorWhenFound(), 0);
  ASSERT_TRUE(Chain::waitUntil([&] {
    const auto guard = lock();
    return with && odometry && plain;
  }));
  const auto guard = lock();
  EXPECT_EQ(with->header.stamp, odometry->header.stamp);
  EXPECT_EQ(with->header.frame_id, "map");
  EXPECT_EQ(with->pose.covariance, odometry->pose.covariance);
  EXPECT_GT(with->pose.covariance[0], 0);
  EXPECT_EQ(with->pose.pose, odometry->pose.pose);
  EXPECT_EQ(with->pose.pose, plain->pose);
}

}  // namespace
}  // namespace posefusion_ros
