// SPDX-License-Identifier: BSD-3-Clause
#include "posefusion_ros/status_output.hpp"

#include <gtest/gtest.h>

namespace posefusion_ros {
namespace {

TrackingStatusMsg statusOf(std::uint8_t state) {
  TrackingStatusMsg status;
  status.header.frame_id = "test_map";
  status.header.stamp = ros::Time(5);
  status.state = state;
  status.pose.position.x = 2;
  return status;
}

TEST(StateText, StandsAboveTheCameraInTheMapFrame) {
  const auto text = toStateText(statusOf(TrackingStatusMsg::TRACKING), 0);
  EXPECT_EQ(text.header.frame_id, "test_map");
  EXPECT_EQ(text.type, visualization_msgs::Marker::TEXT_VIEW_FACING);
  EXPECT_EQ(text.text, "tracking");
  EXPECT_EQ(text.pose.position.x, 2);
  EXPECT_GT(text.pose.position.z, 0);
  EXPECT_EQ(text.color.a, 1);
}

TEST(StateText, ShowsTheStateByWordsAndColour) {
  const auto good = toStateText(statusOf(TrackingStatusMsg::TRACKING), 0);
  const auto lost = toStateText(statusOf(TrackingStatusMsg::LOST), 12.4);
  const auto doubtful = toStateText(statusOf(TrackingStatusMsg::DOUBTFUL), 0);
  EXPECT_EQ(lost.text, "lost for 12 s");
  EXPECT_EQ(doubtful.text, "doubtful");
  EXPECT_GT(good.color.g, good.color.r);
  EXPECT_GT(lost.color.r, 2 * lost.color.g);
  EXPECT_GT(doubtful.color.r, 2 * doubtful.color.b);
  TrackingStatusMsg paused = statusOf(TrackingStatusMsg::TRACKING);
  paused.outcome = TrackingStatusMsg::PAUSED;
  EXPECT_EQ(toStateText(paused, 0).text, "paused");
}

}  // namespace
}  // namespace posefusion_ros
