// SPDX-License-Identifier: BSD-3-Clause
// map -> odom while the camera is lost.
#include <gtest/gtest.h>
#include <tf2_msgs/TFMessage.h>
#include <tf2_ros/static_transform_broadcaster.h>

#include "chain_fixture.hpp"

namespace posefusion_ros {
namespace {

using geometry_msgs::TransformStamped;

constexpr char kMap[] = "held_map", kOdom[] = "held_odom", kCamera[] = "held_camera";

/// A camera that hangs on odometry, and the transforms that a chain sends.
class ChainTransforms : public testing::Test {
 protected:
  void load(const std::string& space, bool lossless, bool tf_while_lost) {
    chain = std::make_unique<Chain>(space);
    chain->set("lossless", lossless);
    chain->set("tracking/lost_after_s", 0.033);
    chain->set("odom_frame", std::string(kOdom));
    chain->set("map_frame", std::string(kMap));
    chain->set("tf_while_lost", tf_while_lost);
    TransformStamped link;
    link.header.frame_id = kOdom;
    link.child_frame_id = kCamera;
    link.transform.translation.x = 0.5;
    link.transform.rotation.w = 1;
    broadcaster.sendTransform(link);
    const boost::function<void(const tf2_msgs::TFMessage::ConstPtr&)> on_tf =
        [this](const tf2_msgs::TFMessage::ConstPtr& message) {
          const std::lock_guard<std::mutex> lock(mutex);
          for (const auto& t : message->transforms) {
            if (t.header.frame_id == kMap && t.child_frame_id == kOdom) sent.push_back(t);
          }
        };
    subscriber = chain->handle().subscribe<tf2_msgs::TFMessage>("/tf", 100, on_tf);
    ASSERT_TRUE(chain->load());
    ASSERT_TRUE(Chain::waitUntil([this] { return subscriber.getNumPublishers() > 0; }));
    ros::WallDuration(0.5).sleep();  // the listener of the chain hears the static transform
  }
  void TearDown() override {
    subscriber.shutdown();
    chain.reset();
  }

  TrackingStatusMsg process(int index, bool covered, std::int64_t stamp_ns) {
    CameraMessages m = restamped(toMessages(emptyRoom().frame(index).frame), stamp_ns);
    for (std_msgs::Header* header : {&m.color->header, &m.depth->header, &m.info->header}) {
      header->frame_id = kCamera;
    }
    if (covered) {
      std::fill(m.depth->data.begin(), m.depth->data.end(), std::uint8_t{0});
      std::fill(m.color->data.begin(), m.color->data.end(), std::uint8_t{90});
    }
    return chain->process(m);
  }

  std::vector<TransformStamped> transforms() const {
    const std::lock_guard<std::mutex> lock(mutex);
    return sent;
  }
  bool waitFor(std::size_t count, double patience_s = 30) const {
    return Chain::waitUntil([&] { return transforms().size() >= count; }, patience_s);
  }

  tf2_ros::StaticTransformBroadcaster broadcaster;
  std::unique_ptr<Chain> chain;
  mutable std::mutex mutex;
  std::vector<TransformStamped> sent;
  ros::Subscriber subscriber;
};

TEST_F(ChainTransforms, MapToOdomGoesOnWhileTheCameraIsCovered) {
  load("held", true, true);
  process(0, false, emptyRoom().stamp(0));
  ASSERT_TRUE(waitFor(1));
  TrackingStatusMsg status;
  for (int i = 1; i < 6; ++i) status = process(i, true, emptyRoom().stamp(i));
  EXPECT_EQ(status.state, TrackingStatusMsg::LOST);
  ASSERT_TRUE(waitFor(6));
  const auto all = transforms();
  for (std::size_t i = 1; i < all.size(); ++i) {
    EXPECT_EQ(all[i].header.stamp, toTime(emptyRoom().stamp(static_cast<int>(i))));
    EXPECT_EQ(all[i].transform.translation.x, all[0].transform.translation.x);
    EXPECT_EQ(all[i].transform.rotation.w, all[0].transform.rotation.w);
  }
}

TEST_F(ChainTransforms, NotWhereItIsNotWanted) {
  load("not_held", true, false);
  process(0, false, emptyRoom().stamp(0));
  ASSERT_TRUE(waitFor(1));
  for (int i = 1; i < 4; ++i) process(i, true, emptyRoom().stamp(i));
  EXPECT_FALSE(waitFor(2, 0.5));
}

TEST_F(ChainTransforms, MapToOdomGoesOnWhereNoFrameComesAnyMore) {
  load("silent", false, true);
  const ros::Time before = ros::Time::now();
  process(0, false, toNs(before));
  ASSERT_TRUE(waitFor(5));
  const auto all = transforms();
  EXPECT_GT(all.back().header.stamp, before + ros::Duration(0.2));
  EXPECT_EQ(all.back().transform.translation.x, all[0].transform.translation.x);
}

}  // namespace
}  // namespace posefusion_ros
