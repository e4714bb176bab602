// SPDX-License-Identifier: BSD-3-Clause
// Requests to a running chain: other settings, the map.
#include <dynamic_reconfigure/Reconfigure.h>
#include <gtest/gtest.h>
#include <posefusion/GetMap.h>

#include "chain_fixture.hpp"
#include "posefusion_ros/settings_server.hpp"

namespace posefusion_ros {
namespace {

using dynamic_reconfigure::Config;
using dynamic_reconfigure::Reconfigure;

class ChainServices : public testing::Test {
 protected:
  TrackingStatusMsg process(int index) {
    return chain.process(toMessages(emptyRoom().frame(index).frame));
  }

  /// Sets one number; whether that was accepted.
  bool set(const std::string& nodelet, const std::string& name, double value) {
    Reconfigure call;
    call.request.config.doubles.resize(1);
    call.request.config.doubles[0].name = name;
    call.request.config.doubles[0].value = value;
    return ros::service::call(chain.space() + "/" + nodelet + "/set_parameters", call);
  }

  /// The value in force, as published on the latched topic.
  double inForce(const std::string& nodelet, const std::string& name) {
    const auto config = ros::topic::waitForMessage<Config>(
        chain.space() + "/" + nodelet + "/parameter_updates", ros::Duration(10));
    if (!config) return -1;
    for (const auto& each : config->doubles) {
      if (each.name == name) return each.value;
    }
    return -1;
  }

  /// What became of the last change, for editors.
  std::string statusOf(const std::string& nodelet) {
    const auto config = ros::topic::waitForMessage<Config>(
        chain.space() + "/" + nodelet + "/parameter_updates", ros::Duration(10));
    if (!config) return "no values were published";
    for (const auto& each : config->strs) {
      if (each.name == kSettingsStatus) return each.value;
    }
    return "no status among the values";
  }

  posefusion::GetMapResponse map(std::uint32_t max_points) {
    posefusion::GetMap call;
    call.request.max_points = max_points;
    EXPECT_TRUE(ros::service::call(chain.space() + "/fusion/get_map", call));
    return call.response;
  }

  // Settings stay on the parameter server: a namespace for each test.
  Chain chain{testing::UnitTest::GetInstance()->current_test_info()->name()};
};

TEST_F(ChainServices, SettingsChangeBetweenFramesAndArePublished) {
  ASSERT_TRUE(chain.load());
  EXPECT_EQ(outcome(process(0)), TrackingStatusMsg::FUSED);
  ASSERT_TRUE(set("blur_gate", "blur/threshold", 1e6));
  EXPECT_EQ(inForce("blur_gate", "blur/threshold"), 1e6);
  EXPECT_EQ(statusOf("blur_gate"), "changed");
  EXPECT_EQ(outcome(process(1)), TrackingStatusMsg::BLURRED);
  ASSERT_TRUE(set("blur_gate", "blur/threshold", 0));
  EXPECT_EQ(outcome(process(2)), TrackingStatusMsg::FUSED);
  ASSERT_TRUE(set("fusion", "tracking/min_view_fraction", 1.0));
  EXPECT_EQ(outcome(process(3)), TrackingStatusMsg::NO_DEPTH);
  double on_server = 0;
  EXPECT_TRUE(ros::param::get(chain.space() + "/fusion/tracking/min_view_fraction", on_server));
  EXPECT_EQ(on_server, 1.0);
}

TEST_F(ChainServices, ARefusedValueChangesNothing) {
  ASSERT_TRUE(chain.load());
  const double before = inForce("segmenter", "segmentation/sigma_m");
  EXPECT_EQ(statusOf("segmenter"), "");
  EXPECT_FALSE(set("segmenter", "segmentation/sigma_m", 1e9));
  EXPECT_EQ(
      statusOf("segmenter").rfind("nothing is changed: segmentation/sigma_m is 1e+09, expected", 0),
      0U)
      << statusOf("segmenter");
  EXPECT_FALSE(set("pose_detector", "pose/nothing", 1));
  EXPECT_EQ(statusOf("pose_detector"),
            "nothing is changed: there is no setting pose/nothing that may change while this runs");
  EXPECT_EQ(inForce("segmenter", "segmentation/sigma_m"), before);
  EXPECT_FALSE(ros::param::has(chain.space() + "/segmenter/segmentation/sigma_m"));
  EXPECT_EQ(outcome(process(0)), TrackingStatusMsg::FUSED);
}

TEST_F(ChainServices, AnEditorMaySendTheStatusBack) {
  ASSERT_TRUE(chain.load({"blur_gate"}));
  Reconfigure call;
  call.request.config.strs.resize(1);
  call.request.config.strs[0].name = kSettingsStatus;
  call.request.config.strs[0].value = "anything";
  ASSERT_TRUE(ros::service::call(chain.space() + "/blur_gate/set_parameters", call));
  EXPECT_EQ(statusOf("blur_gate"), "changed");
  EXPECT_FALSE(ros::param::has(chain.space() + "/blur_gate/" + kSettingsStatus));
}

TEST_F(ChainServices, TheMapIsThereForLateSubscribers) {
  ASSERT_TRUE(chain.load());
  EXPECT_FALSE(map(0).success) << "there is none yet";
  TrackingStatusMsg status;
  for (int i = 0; i < 10; ++i) status = process(i);
  const auto whole = map(0);
  ASSERT_TRUE(whole.success) << whole.message;
  EXPECT_EQ(whole.cloud.header.frame_id, "map");
  EXPECT_EQ(whole.cloud.header.stamp, status.header.stamp);
  EXPECT_GT(whole.cloud.width, 1000U);
  EXPECT_LE(whole.cloud.width, status.surfels);
  const auto some = map(100);
  EXPECT_LE(some.cloud.width, 100U);
  EXPECT_GT(some.cloud.width, 50U);
  // On the topic too: no frame comes any more.
  const auto sent = ros::topic::waitForMessage<sensor_msgs::PointCloud2>(
      chain.space() + "/" + topics::kSurfels, ros::Duration(10));
  ASSERT_TRUE(sent);
  EXPECT_EQ(sent->data, whole.cloud.data);
}

}  // namespace
}  // namespace posefusion_ros
