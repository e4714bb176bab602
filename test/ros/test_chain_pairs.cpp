// SPDX-License-Identifier: BSD-3-Clause
// Two chains beside each other, and a chain beside a driver.
#include <gtest/gtest.h>
#include <tf2_msgs/TFMessage.h>

#include <set>

#include "chain_fixture.hpp"

namespace posefusion_ros {
namespace {

/// The header with another frame, as another camera sends it.
CameraMessages seenBy(const std::string& camera, CameraMessages messages) {
  messages.color->header.frame_id = camera;
  messages.depth->header.frame_id = camera;
  messages.info->header.frame_id = camera;
  return messages;
}

TEST(ChainPairs, InTwoNamespacesHearNothingOfEachOther) {
  Chain left("left"), right("right");
  left.set("map_frame", std::string("left_map"));
  right.set("map_frame", std::string("right_map"));
  ASSERT_TRUE(left.load() && right.load());
  for (int i = 0; i < 4; ++i) {
    const auto l = left.process(seenBy("left_eye", toMessages(emptyRoom().frame(i).frame)));
    EXPECT_EQ(outcome(l), TrackingStatusMsg::FUSED);
    EXPECT_EQ(l.reason, "");
    EXPECT_EQ(l.header.frame_id, "left_map");
    if (i % 2 == 1) continue;
    // Backwards in time: a stamp of the other chain would be a jump.
    const auto r =
        right.process(seenBy("right_eye", restamped(toMessages(emptyRoom().frame(i).frame),
                                                    emptyRoom().stamp(i) - 500'000'000'000)));
    EXPECT_EQ(outcome(r), TrackingStatusMsg::FUSED);
    EXPECT_EQ(r.header.frame_id, "right_map");
  }
  EXPECT_EQ(left.statuses().size(), 4U);
  EXPECT_EQ(right.statuses().size(), 2U);
  ASSERT_TRUE(right.call("reset").success);
  EXPECT_EQ(left.process(seenBy("left_eye", toMessages(emptyRoom().frame(4).frame))).surfels > 0,
            true);
  EXPECT_NEAR(left.statuses().back().pose.position.x, left.statuses()[3].pose.position.x, 0.05)
      << "the map of the left one goes on";
}

TEST(ChainPairs, OfOneCameraFrameOnlyTheFirstSendsTransforms) {
  Chain first("first"), second("second");
  first.set("map_frame", std::string("first_map"));
  second.set("map_frame", std::string("second_map"));
  ASSERT_TRUE(first.load() && second.load());
  std::mutex mutex;
  std::set<std::string> parents;
  const boost::function<void(const tf2_msgs::TFMessage::ConstPtr&)> note =
      [&](const tf2_msgs::TFMessage::ConstPtr& message) {
        const std::lock_guard<std::mutex> lock(mutex);
        for (const auto& t : message->transforms) {
          if (t.child_frame_id == "shared_eye") parents.insert(t.header.frame_id);
        }
      };
  auto subscriber = first.handle().subscribe<tf2_msgs::TFMessage>("/tf", 100, note);
  const auto frame = [](int i) {
    return seenBy("shared_eye", toMessages(emptyRoom().frame(i).frame));
  };
  EXPECT_EQ(first.process(frame(0)).reason, "");
  ASSERT_TRUE(Chain::waitUntil([&] {
    const std::lock_guard<std::mutex> lock(mutex);
    return !parents.empty();
  }));
  ros::WallDuration(0.3).sleep();  // until the second has heard it too
  const auto refused = second.process(frame(0));
  EXPECT_EQ(outcome(refused), TrackingStatusMsg::FUSED) << "the map needs no transform";
  EXPECT_NE(refused.reason.find("frame shared_eye has the parent first_map already"),
            std::string::npos)
      << refused.reason;
  EXPECT_EQ(first.process(frame(1)).reason, "");
  subscriber.shutdown();
  EXPECT_EQ(parents, std::set<std::string>{"first_map"});
}

TEST(ChainPairs, BesideADriverWithFramesOfItsOwnTheDiagnosticsNameWhatToSet) {
  ros::NodeHandle handle;
  auto driver = handle.advertise<tf2_msgs::TFMessage>("/tf_static", 1, true);
  tf2_msgs::TFMessage mount;
  mount.transforms.resize(1);
  mount.transforms[0].header.frame_id = "driver_link";
  mount.transforms[0].child_frame_id = "driver_eye";
  mount.transforms[0].transform.rotation.w = 1;
  driver.publish(mount);
  const auto frame = [](int i) {
    return seenBy("driver_eye", toMessages(emptyRoom().frame(i).frame));
  };
  for (const bool has_base_frame : {false, true}) {
    Chain chain(has_base_frame ? "with_base" : "without_base");
    if (has_base_frame) chain.set("base_frame", std::string("driver_link"));
    ASSERT_TRUE(chain.load());
    ros::WallDuration(0.3).sleep();  // until it has heard the driver
    const std::string reason = chain.process(frame(0)).reason;
    if (has_base_frame) {
      EXPECT_EQ(reason, "");
    } else {
      EXPECT_NE(reason.find("give base_frame:=driver_link"), std::string::npos) << reason;
    }
  }
}

}  // namespace
}  // namespace posefusion_ros
