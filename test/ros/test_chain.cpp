// SPDX-License-Identifier: BSD-3-Clause
// The nodelets, in one process, against the offline chain. No test depends on the machine's speed.
#include <gtest/gtest.h>
#include <nav_msgs/Odometry.h>
#include <tf2_msgs/TFMessage.h>
#include <tf2_ros/static_transform_broadcaster.h>

#include <opencv2/imgproc.hpp>

#include "../temporary_folder.hpp"
#include "chain_fixture.hpp"
#include "posefusion/io/files.hpp"
#include "posefusion/io/map_file.hpp"
#include "posefusion/io/people_json.hpp"
#include "posefusion/io/trajectory_file.hpp"
#include "posefusion/slam/pipeline.hpp"

namespace posefusion_ros {
namespace {

using pf::SimulatedSequence;
using sensor_msgs::ImageConstPtr;

TEST(Chain, LosslessIsTheOfflineChainToTheBit) {
  const pf::TemporaryFolder folder;
  const SimulatedSequence sequence("box_walker", 16);
  std::vector<pf::RgbdFrame> frames;
  std::vector<pf::People> people;
  for (int i = 0; i < sequence.frameCount(); ++i) {
    const auto made = sequence.frame(i);
    frames.push_back(made.frame);
    // The person is missed and fused at first; between detections its joints are carried.
    if (i >= 4 && i % 2 == 0) people.push_back(made.people);
  }
  for (const int i : {9, 10}) cv::GaussianBlur(frames[i].color, frames[i].color, {}, 8);
  pf::savePeople(folder / "people.json", people);

  Chain chain("equal");
  chain.set("pose/detector", std::string("recorded"));
  chain.set("people_file", folder / "people.json");
  chain.set("output", folder.str());
  chain.set("blur/max_gap_s", 0.05);
  ASSERT_TRUE(chain.load());
  pf::Config config;
  config.pose.detector = "recorded";
  config.blur.max_gap_s = 0.05;
  pf::Pipeline pipeline(config,
                        makePoseDetector(config.pose, pf::loadPeople(folder / "people.json")));
  pf::Trajectory expected;
  std::vector<int> outcomes;
  int frames_with_people = 0;
  for (std::size_t i = 0; i < frames.size(); ++i) {
    const pf::ProcessedFrame processed = pipeline.process(frames[i]);
    const pf::FrameStatus& status = processed.status;
    frames_with_people += processed.segmentation.mask.empty() ? 0 : 1;
    outcomes.push_back(static_cast<int>(status.outcome));
    if (status.located) {
      expected.push_back({status.stamp_ns, status.T_map_camera});
    }
    chain.send(toMessages(frames[i]));
    if (i >= 2) {  // three under way: stages work at the same time
      ASSERT_TRUE(chain.waitForStatuses(i - 1));
    }
  }
  ASSERT_TRUE(chain.waitForStatuses(frames.size()));
  ASSERT_EQ(chain.statuses().size(), frames.size());
  std::map<ros::Time, int> said;  // a blurred frame is reported before those on their way
  for (const auto& status : chain.statuses()) said[status.header.stamp] = outcome(status);
  for (std::size_t i = 0; i < frames.size(); ++i) {
    EXPECT_EQ(said[toTime(frames[i].stamp_ns)], outcomes[i]) << i;
  }
  EXPECT_EQ(outcomes[9], TrackingStatusMsg::BLURRED);
  EXPECT_EQ(outcomes[10], TrackingStatusMsg::FORCED);
  EXPECT_GT(frames_with_people, 2) << "the map got the masks of people missed before";
  EXPECT_GE(expected.size(), frames.size() - 2) << "all but the blurred frames";
  ASSERT_TRUE(chain.call("save_map").success);
  // The offline runner writes its files so.
  saveTrajectory(folder / "expected.txt", inWorld(pf::bodyFromOptical(), expected), "");
  saveMap(folder / "expected.ply", pipeline.mapper().map(), pf::bodyFromOptical());
  EXPECT_EQ(posesIn(folder / "latest/trajectory.txt"), posesIn(folder / "expected.txt"));
  EXPECT_EQ(pf::readFile(folder / "latest/map.ply"), pf::readFile(folder / "expected.ply"));
  chain.unload();
}

TEST(Chain, LosslessIsTheOfflineChainToTheBitWithADetectorsMaskToo) {
  const pf::TemporaryFolder folder;
  const std::string model = POSEFUSION_TEST_MODELS "/near_is_person.onnx";
  const SimulatedSequence sequence("box_walker", 6);
  Chain chain("equal_masks");
  chain.set("pose/detector", std::string("embedded"));
  chain.set("pose/embedded_model", model);
  chain.set("output", folder.str());
  std::mutex mutex;
  std::map<ros::Time, MovingObjectsMsg> published;
  const boost::function<void(const MovingObjectsMsg::ConstPtr&)> note =
      [&](const MovingObjectsMsg::ConstPtr& message) {
        const std::lock_guard<std::mutex> lock(mutex);
        published[message->header.stamp] = *message;
      };
  const auto subscriber =
      chain.handle().subscribe<MovingObjectsMsg>(topics::kMovingObjects, 100, note);
  ASSERT_TRUE(chain.load());
  pf::Config config;
  config.pose.detector = "embedded";
  config.pose.embedded_model = model;
  pf::Pipeline pipeline(config, makePoseDetector(config.pose, {}));
  int masked = 0;
  std::map<ros::Time, std::vector<pf::MovingObject>> moving;
  for (int i = 0; i < sequence.frameCount(); ++i) {
    const pf::RgbdFrame frame = sequence.frame(i).frame;
    const pf::ProcessedFrame processed = pipeline.process(frame);
    EXPECT_FALSE(processed.seen.people.mask.empty());
    masked += processed.segmentation.mask.empty() ? 0 : 1;
    if (i > 0) moving[toTime(frame.stamp_ns)] = processed.segmentation.moving;
    EXPECT_EQ(outcome(chain.process(toMessages(frame))),
              static_cast<int>(processed.status.outcome));
  }
  EXPECT_GT(masked, 0);
  EXPECT_TRUE(Chain::waitUntil([&] {
    const std::lock_guard<std::mutex> lock(mutex);
    return published.size() >= moving.size();
  })) << published.size();
  for (const auto& [stamp, objects] : moving) {
    const MovingObjectsMsg& message = published[stamp];
    EXPECT_EQ(message.header.frame_id, "map");
    ASSERT_EQ(message.objects.size(), objects.size()) << stamp;
    for (std::size_t k = 0; k < objects.size(); ++k) {
      EXPECT_EQ(message.objects[k].id, objects[k].id);
      EXPECT_NEAR(message.objects[k].centre.x, objects[k].centre_m.x(), 1e-6);
      EXPECT_NEAR(message.objects[k].centre.z, objects[k].centre_m.z(), 1e-6);
    }
  }
  EXPECT_FALSE(moving.rbegin()->second.empty());
  ASSERT_TRUE(chain.call("save_map").success);
  saveMap(folder / "expected.ply", pipeline.mapper().map());
  EXPECT_EQ(pf::readFile(folder / "latest/map.ply"), pf::readFile(folder / "expected.ply"));
  chain.unload();
}

TEST(Chain, PassesTheVerySameMessagesOn) {
  Chain chain("zero_copy");
  ASSERT_TRUE(chain.load());
  std::mutex mutex;
  std::map<std::string, std::vector<const void*>> seen;
  std::vector<ros::Subscriber> subscribers;
  for (const char* topic : {topics::kSharpColor, topics::kSharpDepth, topics::kStaticDepth}) {
    const boost::function<void(const ImageConstPtr&)> note = [&,
                                                              topic](const ImageConstPtr& image) {
      const std::lock_guard<std::mutex> lock(mutex);
      seen[topic].push_back(image.get());
    };
    subscribers.push_back(chain.handle().subscribe<sensor_msgs::Image>(topic, 100, note));
  }
  const SimulatedSequence& sequence = emptyRoom();
  std::vector<CameraMessages> sent;  // kept, so that no address is used twice
  for (int i = 0; i < 3; ++i) {
    sent.push_back(toMessages(sequence.frame(i).frame));
    EXPECT_EQ(outcome(chain.process(sent.back())), TrackingStatusMsg::FUSED);
  }
  EXPECT_TRUE(Chain::waitUntil([&] {
    const std::lock_guard<std::mutex> lock(mutex);
    return seen[topics::kSharpColor].size() == 3 && seen[topics::kSharpDepth].size() == 3 &&
           seen[topics::kStaticDepth].size() == 3;
  }));
  for (auto& subscriber : subscribers) subscriber.shutdown();
  const std::lock_guard<std::mutex> lock(mutex);
  for (int i = 0; i < 3; ++i) {
    EXPECT_EQ(seen[topics::kSharpColor][i], sent[i].color.get());
    EXPECT_EQ(seen[topics::kSharpDepth][i], sent[i].depth.get());
    EXPECT_EQ(seen[topics::kStaticDepth][i], sent[i].depth.get()) << "no person: nothing copied";
  }
}

TEST(Chain, LiveEveryFrameIsFusedOrReportedAsDropped) {
  Chain chain("live");
  chain.set("lossless", false);
  chain.set("queue_size", 2);
  ros::param::set(chain.space() + "/blur_gate/queue_size", 1000);
  ASSERT_TRUE(chain.load());
  const SimulatedSequence& sequence = emptyRoom();
  std::vector<CameraMessages> messages;
  for (int i = 0; i < 40; ++i) messages.push_back(toMessages(sequence.frame(i).frame));
  for (int i = 0; i < 40; ++i) {
    chain.send(messages[i]);
    if (i % 4 == 3) ros::WallDuration(0.05).sleep();
  }
  ASSERT_TRUE(chain.waitForStatuses(40));
  std::map<ros::Time, int> count;
  for (const auto& status : chain.statuses()) {
    ++count[status.header.stamp];
    EXPECT_TRUE(outcome(status) == TrackingStatusMsg::FUSED || !status.reason.empty());
  }
  EXPECT_EQ(count.size(), 40U) << "one status for each frame, none twice";
}

TEST(Chain, PosesFollowTheBaseFrameOrAreNotPublished) {
  Chain chain("base");
  chain.set("base_frame", std::string("test_base"));
  chain.set("map_frame", std::string("test_map"));
  ASSERT_TRUE(chain.load());
  std::mutex mutex;
  std::vector<nav_msgs::Odometry> odometry;
  std::vector<geometry_msgs::TransformStamped> transforms;
  const boost::function<void(const nav_msgs::Odometry::ConstPtr&)> on_odometry =
      [&](const nav_msgs::Odometry::ConstPtr& message) {
        const std::lock_guard<std::mutex> lock(mutex);
        odometry.push_back(*message);
      };
  const boost::function<void(const tf2_msgs::TFMessage::ConstPtr&)> on_tf =
      [&](const tf2_msgs::TFMessage::ConstPtr& message) {
        const std::lock_guard<std::mutex> lock(mutex);
        for (const auto& t : message->transforms) {
          if (t.header.frame_id == "test_map") transforms.push_back(t);
        }
      };
  const auto odometry_subscriber =
      chain.handle().subscribe<nav_msgs::Odometry>(topics::kOdometry, 10, on_odometry);
  const auto tf_subscriber = chain.handle().subscribe<tf2_msgs::TFMessage>("/tf", 10, on_tf);
  const SimulatedSequence& sequence = emptyRoom();
  const auto blind = chain.process(toMessages(sequence.frame(0).frame));
  EXPECT_EQ(outcome(blind), TrackingStatusMsg::FUSED);
  EXPECT_NE(blind.reason.find("test_base"), std::string::npos) << blind.reason;

  tf2_ros::StaticTransformBroadcaster broadcaster;
  geometry_msgs::TransformStamped mount;
  mount.header.frame_id = "test_base";
  mount.child_frame_id = frames::kOptical;
  mount.transform.translation.z = 1.25;
  mount.transform.rotation.x = -0.5;
  mount.transform.rotation.y = 0.5;
  mount.transform.rotation.z = -0.5;
  mount.transform.rotation.w = 0.5;
  broadcaster.sendTransform(mount);
  ros::WallDuration(0.5).sleep();
  const auto seeing = chain.process(toMessages(sequence.frame(1).frame));
  EXPECT_EQ(seeing.reason, "");
  EXPECT_NEAR(seeing.pose.position.z, 1.25, 1e-9) << "the camera's height above the base";
  chain.process(toMessages(sequence.frame(2).frame));
  EXPECT_TRUE(Chain::waitUntil([&] {
    const std::lock_guard<std::mutex> lock(mutex);
    return odometry.size() >= 2 && transforms.size() >= 2;
  }));
  const std::lock_guard<std::mutex> lock(mutex);
  ASSERT_EQ(odometry.size(), 2U);
  EXPECT_EQ(odometry[0].header.frame_id, "test_map");
  EXPECT_EQ(odometry[0].child_frame_id, "test_base");
  EXPECT_NEAR(odometry[0].pose.pose.position.z, 0, 1e-9) << "the map begins at the base";
  EXPECT_NEAR(odometry[0].pose.pose.orientation.w, 1, 1e-9);
  EXPECT_EQ(transforms[0].child_frame_id, "test_base");
  EXPECT_EQ(transforms[0].header.stamp, toTime(sequence.stamp(1)));
}

}  // namespace
}  // namespace posefusion_ros

int main(int argc, char** argv) {
  testing::InitGoogleTest(&argc, argv);
  ros::init(argc, argv, "test_chain");
  const ros::NodeHandle alive;
  ros::AsyncSpinner spinner(2);
  spinner.start();
  return RUN_ALL_TESTS();
}
