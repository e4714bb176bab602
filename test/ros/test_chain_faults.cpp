// SPDX-License-Identifier: BSD-3-Clause
// Frames and settings that are no good.
#include <gtest/gtest.h>

#include "../temporary_folder.hpp"
#include "chain_fixture.hpp"

namespace posefusion_ros {
namespace {

using pf::SimulatedSequence;

TEST(Chain, EveryBadFrameGetsOneStatusThatSaysWhy) {
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

TEST(Chain, WithoutAModelItGoesOnWhereToldTo) {
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
