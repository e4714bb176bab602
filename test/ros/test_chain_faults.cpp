// SPDX-License-Identifier: BSD-3-Clause
// Frames and settings that are no good.
#include <geometry_msgs/PoseStamped.h>
#include <gtest/gtest.h>

#include "../temporary_folder.hpp"
#include "chain_fixture.hpp"

namespace posefusion_ros {
namespace {

using pf::SimulatedSequence;

TEST(Chain, EveryBadFrameGetsOneStatusWithTheReason) {
  Chain chain("bad");
  ASSERT_TRUE(chain.load());
  const SimulatedSequence& sequence = emptyRoom();
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
  const SimulatedSequence& sequence = emptyRoom();
  EXPECT_EQ(outcome(chain.process(toMessages(sequence.frame(0).frame))), TrackingStatusMsg::FUSED);
  pf::RgbdFrame empty = sequence.frame(1).frame;
  empty.depth = cv::Mat::zeros(empty.depth.size(), CV_16UC1);
  EXPECT_EQ(outcome(chain.process(toMessages(empty))), TrackingStatusMsg::NO_DEPTH);
  empty = sequence.frame(2).frame;
  empty.depth = cv::Mat(empty.depth.size(), CV_32FC1, cv::Scalar(std::nan("")));
  EXPECT_EQ(outcome(chain.process(toMessages(empty))), TrackingStatusMsg::NO_DEPTH);
  EXPECT_EQ(outcome(chain.process(toMessages(sequence.frame(3).frame))), TrackingStatusMsg::FUSED);
}

TEST(Chain, WhileItIsLostTheSegmenterGetsNoViewAndNoPoseIsPublished) {
  Chain chain("lost");
  chain.set("tracking/lost_after_s", 0.067);
  ASSERT_TRUE(chain.load());
  std::mutex mutex;
  std::vector<ModelViewMsg::ConstPtr> views;
  int poses = 0;
  const boost::function<void(const ModelViewMsg::ConstPtr&)> on_view =
      [&](const ModelViewMsg::ConstPtr& view) {
        const std::lock_guard<std::mutex> lock(mutex);
        views.push_back(view);
      };
  const boost::function<void(const geometry_msgs::PoseStamped::ConstPtr&)> on_pose =
      [&](const geometry_msgs::PoseStamped::ConstPtr&) {
        const std::lock_guard<std::mutex> lock(mutex);
        ++poses;
      };
  auto view = chain.handle().subscribe<ModelViewMsg>(topics::kModelView, 100, on_view);
  auto pose = chain.handle().subscribe<geometry_msgs::PoseStamped>(topics::kPose, 100, on_pose);
  const SimulatedSequence& sequence = emptyRoom();
  for (int i = 0; i < 4; ++i) {
    pf::RgbdFrame frame = sequence.frame(i).frame;
    if (i > 0) frame.depth = cv::Mat::zeros(frame.depth.size(), CV_16UC1);
    const auto status = chain.process(toMessages(frame));
    // Frame 1 is reckoned by its corners from frame 0, which has depth.
    EXPECT_EQ(status.located != 0, i <= 1) << i;
    EXPECT_EQ(status.state == TrackingStatusMsg::LOST, i >= 2) << i;
    EXPECT_EQ(status.reason.empty(), i == 0) << status.reason;
  }
  EXPECT_TRUE(Chain::waitUntil([&] {
    const std::lock_guard<std::mutex> lock(mutex);
    return views.size() >= 4;
  }));
  view.shutdown();
  pose.shutdown();
  const std::lock_guard<std::mutex> lock(mutex);
  ASSERT_EQ(views.size(), 4U);
  for (std::size_t i = 0; i < 4; ++i) EXPECT_EQ(views[i]->depth.data.empty(), i >= 2) << i;
  EXPECT_EQ(poses, 2);
}

TEST(Chain, AMissingModelIsNamedInEachStatus) {
  Chain chain("no_model");
  chain.set("pose/detector", std::string("network"));
  chain.set("pose/model", std::string("/nowhere/network.pb"));
  ASSERT_TRUE(chain.load());
  const SimulatedSequence& sequence = emptyRoom();
  for (int i = 0; i < 2; ++i) {
    const auto status = chain.process(toMessages(sequence.frame(i).frame));
    EXPECT_EQ(outcome(status), TrackingStatusMsg::NO_DETECTOR);
    EXPECT_NE(status.reason.find("/nowhere/network.pb"), std::string::npos) << status.reason;
  }
  EXPECT_EQ(chain.statuses().size(), 2U);
}

TEST(Chain, WithoutAModelItGoesOnWhereSetTo) {
  Chain chain("go_on");
  chain.set("pose/detector", std::string("network"));
  chain.set("pose/model", std::string("/nowhere/network.pb"));
  chain.set("without_people_if_no_detector", true);
  ASSERT_TRUE(chain.load());
  const SimulatedSequence& sequence = emptyRoom();
  EXPECT_EQ(outcome(chain.process(toMessages(sequence.frame(0).frame))), TrackingStatusMsg::FUSED);
}

TEST(Chain, ABadParameterLeavesTheNodeletIdle) {
  for (const char* name : {"map/memory_limit_mb", "surfels_period_s"}) {
    const pf::TemporaryFolder folder;
    Chain chain("bad_parameter");
    ros::param::del(chain.space() + "/fusion");
    ros::param::set(chain.space() + "/fusion/output", folder.str());
    ros::param::set(chain.space() + "/fusion/" + name, std::string("much"));
    ASSERT_TRUE(chain.load({"fusion"}));
    EXPECT_FALSE(ros::service::exists(chain.space() + "/fusion/save_map", false)) << name;
    chain.unload();
  }
}

}  // namespace
}  // namespace posefusion_ros
