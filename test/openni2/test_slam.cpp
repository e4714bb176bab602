// SPDX-License-Identifier: BSD-3-Clause
#include <gtest/gtest.h>
#include <posefusion/TrackingStatus.h>
#include <ros/ros.h>
#include <sensor_msgs/Image.h>

#include <set>
#include <vector>

namespace {

using posefusion::TrackingStatus;

/// Statuses of the chain, and the stamps of the colour images that went into it.
class Slam : public ::testing::Test {
 protected:
  Slam() {
    status_ = nh_.subscribe<TrackingStatus>(
        "/posefusion/status", 100,
        boost::function<void(const TrackingStatus::ConstPtr&)>(
            [this](const TrackingStatus::ConstPtr& s) { statuses.push_back(*s); }));
    color_ = nh_.subscribe<sensor_msgs::Image>(
        "/camera/rgb/image_raw", 100,
        boost::function<void(const sensor_msgs::ImageConstPtr&)>(
            [this](const sensor_msgs::ImageConstPtr& image) { stamps.insert(image->header.stamp); }));
  }

  void waitForStatuses(std::size_t count) {
    const ros::WallTime end = ros::WallTime::now() + ros::WallDuration(80);
    while (statuses.size() < count && ros::WallTime::now() < end) {
      ros::spinOnce();
      ros::WallDuration(0.01).sleep();
    }
  }

  ros::NodeHandle nh_;
  ros::Subscriber status_, color_;
  std::vector<TrackingStatus> statuses;
  std::set<ros::Time> stamps;
};

TEST_F(Slam, MapsWhatTheDriverPublishes) {
  waitForStatuses(60);
  ASSERT_GE(statuses.size(), 60U);
  std::size_t fused = 0, known = 0;
  std::set<ros::Time> answered;
  for (const TrackingStatus& s : statuses) {
    fused += s.outcome == TrackingStatus::FUSED ? 1 : 0;
    known += stamps.count(s.header.stamp);
    EXPECT_TRUE(answered.insert(s.header.stamp).second) << "two statuses of one frame";
  }
  EXPECT_GT(fused, 5U) << "last reason: " << statuses.back().reason;
  EXPECT_GT(known, 30U) << "statuses carry the driver's stamps";
  EXPECT_EQ(statuses.back().state, TrackingStatus::TRACKING) << statuses.back().reason;
  EXPECT_GT(statuses.back().surfels, 1000U);
}

}  // namespace

int main(int argc, char** argv) {
  testing::InitGoogleTest(&argc, argv);
  ros::init(argc, argv, "test_openni2_slam");
  return RUN_ALL_TESTS();
}
