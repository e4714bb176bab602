// SPDX-License-Identifier: BSD-3-Clause
// The nodelets, in one process, against the offline chain. No test depends on the machine's speed.
#include <gtest/gtest.h>
#include <nav_msgs/Odometry.h>
#include <tf2_msgs/TFMessage.h>
#include <tf2_ros/static_transform_broadcaster.h>

#include <filesystem>
#include <opencv2/imgproc.hpp>

#include "chain_fixture.hpp"
#include "posefusion/io/files.hpp"
#include "posefusion/io/map_file.hpp"
#include "posefusion/io/people_json.hpp"
#include "posefusion/pipeline.hpp"

namespace posefusion_ros {
namespace {

using posefusion::SyntheticSequence;
using sensor_msgs::ImageConstPtr;

std::string freshFolder(const std::string& name) {
  const auto folder =
      std::filesystem::temp_directory_path() / ("posefusion_" + name + std::to_string(getpid()));
  std::filesystem::remove_all(folder);
  std::filesystem::create_directories(folder);
  return folder.string();
}

int outcome(const TrackingStatusMsg& status) { return status.outcome; }

/// What trajectory.txt and map.ply say besides comments.
std::string posesIn(const std::string& file) {
  std::istringstream lines(posefusion::readFile(file));
  std::string line, poses;
  while (std::getline(lines, line)) {
    if (line.rfind('#', 0) != 0) poses += line + "\n";
  }
  return poses;
}

TEST(Chain, LosslessIsTheOfflineChainToTheBit) {
  const std::string folder = freshFolder("equal");
  const SyntheticSequence sequence(smallSequence(16, true));
  std::vector<posefusion::RgbdFrame> frames;
  std::vector<posefusion::People> people;
  for (int i = 0; i < sequence.frameCount(); ++i) {
    const auto made = sequence.frame(i);
    frames.push_back(made.frame);
    if (i % 2 == 0) people.push_back(made.people);  // between them joints are carried
  }
  cv::GaussianBlur(frames[9].color, frames[9].color, {}, 8);
  posefusion::savePeople(folder + "/people.json", people);

  Chain chain("equal");
  chain.set("pose/detector", std::string("recorded"));
  chain.set("people_file", folder + "/people.json");
  chain.set("output", folder);
  ASSERT_TRUE(chain.load());
  posefusion::Config config;
  config.pose.detector = "recorded";
  posefusion::Pipeline pipeline(
      config, makePoseDetector(config.pose, posefusion::loadPeople(folder + "/people.json")));
  posefusion::Trajectory expected;
  for (std::size_t i = 0; i < frames.size(); ++i) {
    const auto status = pipeline.process(frames[i]).status;
    if (status.outcome == posefusion::FrameOutcome::fused) {
      expected.push_back({status.stamp_ns, status.T_map_camera});
    }
    chain.send(toMessages(frames[i]));
    if (i >= 2) {  // three under way: stages work at the same time
      ASSERT_TRUE(chain.waitForStatuses(i - 1));
    }
  }
  ASSERT_TRUE(chain.waitForStatuses(frames.size()));
  EXPECT_EQ(chain.statuses().size(), frames.size());
  EXPECT_EQ(expected.size(), frames.size() - 1) << "all but the blurred frame";
  ASSERT_TRUE(chain.call("save_map").success);
  saveTrajectory(folder + "/expected.txt", expected, "");
  saveMap(folder + "/expected.ply", pipeline.mapper().map());
  EXPECT_EQ(posesIn(folder + "/trajectory.txt"), posesIn(folder + "/expected.txt"));
  EXPECT_EQ(posefusion::readFile(folder + "/map.ply"),
            posefusion::readFile(folder + "/expected.ply"));
  chain.unload();
  std::filesystem::remove_all(folder);
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
  const SyntheticSequence sequence(smallSequence(3, false));
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
    EXPECT_EQ(seen[topics::kStaticDepth][i], sent[i].depth.get()) << "nobody there: nothing copied";
  }
}

TEST(Chain, EveryBadFrameGetsOneStatusThatSaysWhy) {
  Chain chain("bad");
  ASSERT_TRUE(chain.load());
  const SyntheticSequence sequence(smallSequence(12, false));
  int next = 0;
  const auto fresh = [&] { return toMessages(sequence.frame(next++).frame); };
  const auto expectBad = [&](const CameraMessages& messages, const std::string& why) {
    const auto status = chain.process(messages);
    EXPECT_EQ(outcome(status), TrackingStatusMsg::BAD_INPUT) << why;
    EXPECT_EQ(status.header.stamp, messages.color->header.stamp);
    EXPECT_NE(status.reason.find(why), std::string::npos) << status.reason;
  };
  EXPECT_EQ(outcome(chain.process(fresh())), TrackingStatusMsg::FUSED);

  CameraMessages m = fresh();
  m.info->K = {};
  expectBad(m, "fx is 0");
  m = fresh();
  m.color->encoding = "mono16";
  expectBad(m, "mono16");
  m = fresh();
  m.depth = toImage(cv::Mat::zeros(100, 100, CV_16UC1), "16UC1", m.depth->header);
  expectBad(m, "100x100");
  m = fresh();
  m.color->data.resize(100);
  expectBad(m, "image message");
  m = fresh();
  m.depth->header.frame_id = "elsewhere";
  expectBad(m, "'elsewhere'");
  m = fresh();
  m.color->header.stamp = m.depth->header.stamp = m.info->header.stamp = toTime(sequence.stamp(1));
  expectBad(m, "went back");

  CameraMessages lonely = fresh();
  lonely.depth.reset();
  chain.send(lonely);
  EXPECT_EQ(outcome(chain.process(fresh())), TrackingStatusMsg::BAD_INPUT);
  ASSERT_TRUE(chain.waitForStatuses(9));
  EXPECT_EQ(chain.statuses().size(), 9U);
  EXPECT_EQ(outcome(chain.statuses().back()), TrackingStatusMsg::FUSED);
}

TEST(Chain, DepthWithoutAnythingInItIsReportedAndDoesNoHarm) {
  Chain chain("no_depth");
  ASSERT_TRUE(chain.load());
  const SyntheticSequence sequence(smallSequence(4, false));
  EXPECT_EQ(outcome(chain.process(toMessages(sequence.frame(0).frame))), TrackingStatusMsg::FUSED);
  posefusion::RgbdFrame empty = sequence.frame(1).frame;
  empty.depth = cv::Mat::zeros(empty.depth.size(), CV_16UC1);
  EXPECT_EQ(outcome(chain.process(toMessages(empty))), TrackingStatusMsg::NO_DEPTH);
  empty = sequence.frame(2).frame;
  empty.depth = cv::Mat(empty.depth.size(), CV_32FC1, cv::Scalar(std::nan("")));
  EXPECT_EQ(outcome(chain.process(toMessages(empty))), TrackingStatusMsg::NO_DEPTH);
  EXPECT_EQ(outcome(chain.process(toMessages(sequence.frame(3).frame))), TrackingStatusMsg::FUSED);
}

TEST(Chain, ResetEmptiesTheMapAndSaveTellsWhere) {
  const std::string folder = freshFolder("services");
  Chain chain("services");
  chain.set("output", folder + "/out");
  ASSERT_TRUE(chain.load());
  const SyntheticSequence sequence(smallSequence(6, false));
  const auto empty = chain.call("save_map");
  EXPECT_TRUE(empty.success);
  EXPECT_NE(empty.message.find("nothing to save"), std::string::npos);
  std::uint64_t grown = 0;
  for (int i = 0; i < 3; ++i) grown = chain.process(toMessages(sequence.frame(i).frame)).surfels;
  EXPECT_GT(grown, 0U);
  const auto saved = chain.call("save_map");
  EXPECT_TRUE(saved.success);
  EXPECT_NE(saved.message.find(folder + "/out"), std::string::npos) << saved.message;
  EXPECT_TRUE(std::filesystem::exists(folder + "/out/map.ply"));
  EXPECT_TRUE(chain.call("reset").success);
  EXPECT_TRUE(chain.call("reset").success);
  const auto again = chain.process(toMessages(sequence.frame(3).frame));
  EXPECT_EQ(outcome(again), TrackingStatusMsg::FUSED);
  EXPECT_NEAR(again.pose.position.x, 0, 1e-9) << "a new map begins";
  chain.unload();
  EXPECT_EQ(posefusion::loadTrajectory(folder + "/out/trajectory.txt").size(), 1U)
      << "the new map was saved at the end";
  std::filesystem::remove_all(folder);
}

TEST(Chain, AnOutputThatCannotBeWrittenIsAnAnswerNotACrash) {
  const std::string folder = freshFolder("unwritable");
  std::ofstream(folder + "/file") << "in the way";
  Chain chain("unwritable");
  chain.set("output", folder + "/file");
  ASSERT_TRUE(chain.load());
  const SyntheticSequence sequence(smallSequence(2, false));
  chain.process(toMessages(sequence.frame(0).frame));
  const auto response = chain.call("save_map");
  EXPECT_FALSE(response.success);
  EXPECT_NE(response.message.find(folder + "/file"), std::string::npos) << response.message;
  EXPECT_EQ(outcome(chain.process(toMessages(sequence.frame(1).frame))), TrackingStatusMsg::FUSED);
  chain.unload();
  std::filesystem::remove_all(folder);
}

TEST(Chain, ATimeJumpBeginsANewMapAndKeepsTheOldOne) {
  const std::string folder = freshFolder("jump");
  Chain chain("jump");
  chain.set("output", folder);
  ASSERT_TRUE(chain.load());
  const SyntheticSequence sequence(smallSequence(3, false));
  for (int round = 0; round < 2; ++round) {
    for (int i = 0; i < 3; ++i) {
      posefusion::RgbdFrame frame = sequence.frame(i).frame;
      frame.stamp_ns += (round == 0 ? 100 : 50) * 1000000000L;
      const auto status = chain.process(toMessages(frame));
      EXPECT_EQ(outcome(status), TrackingStatusMsg::FUSED) << round << " " << i;
      EXPECT_EQ(toNs(status.header.stamp), frame.stamp_ns);
    }
  }
  ASSERT_TRUE(chain.call("save_map").success);
  EXPECT_EQ(posesIn(folder + "/trajectory.txt").substr(0, 3), "51.");
  EXPECT_EQ(posesIn(folder + "/before_reset_1/trajectory.txt").substr(0, 4), "101.");
  chain.unload();
  std::filesystem::remove_all(folder);
}

TEST(Chain, AMissingModelIsNamedInEachStatus) {
  Chain chain("no_model");
  chain.set("pose/detector", std::string("network"));
  chain.set("pose/model", std::string("/nowhere/network.pb"));
  ASSERT_TRUE(chain.load());
  const SyntheticSequence sequence(smallSequence(2, false));
  for (int i = 0; i < 2; ++i) {
    const auto status = chain.process(toMessages(sequence.frame(i).frame));
    EXPECT_EQ(outcome(status), TrackingStatusMsg::NO_DETECTOR);
    EXPECT_NE(status.reason.find("/nowhere/network.pb"), std::string::npos) << status.reason;
  }
  EXPECT_EQ(chain.statuses().size(), 2U);
}

TEST(Chain, WithoutAModelItGoesOnWhereToldTo) {
  Chain chain("go_on");
  chain.set("pose/detector", std::string("network"));
  chain.set("pose/model", std::string("/nowhere/network.pb"));
  chain.set("without_people_if_no_detector", true);
  ASSERT_TRUE(chain.load());
  const SyntheticSequence sequence(smallSequence(1, false));
  EXPECT_EQ(outcome(chain.process(toMessages(sequence.frame(0).frame))), TrackingStatusMsg::FUSED);
}

TEST(Chain, LiveEveryFrameIsFusedOrReportedAsDropped) {
  Chain chain("live");
  chain.set("lossless", false);
  chain.set("queue_size", 2);
  ros::param::set(chain.space() + "/blur_gate/queue_size", 1000);
  ASSERT_TRUE(chain.load());
  const SyntheticSequence sequence(smallSequence(40, false));
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

TEST(Chain, ABadParameterLeavesTheNodeletIdle) {
  Chain chain("bad_parameter");
  ros::param::set(chain.space() + "/fusion/map/memory_limit_mb", std::string("much"));
  nodelet::Loader loader(false);
  EXPECT_TRUE(loader.load(chain.space() + "/fusion", "posefusion/fusion", {}, {}));
  EXPECT_FALSE(ros::service::exists(chain.space() + "/fusion/save_map", false));
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
  const SyntheticSequence sequence(smallSequence(3, false));
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
