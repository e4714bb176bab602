// SPDX-License-Identifier: BSD-3-Clause
#include <gtest/gtest.h>
#include <posefusion/TrackingStatus.h>
#include <ros/ros.h>
#include <sensor_msgs/CameraInfo.h>

#include <algorithm>
#include <set>
#include <vector>

namespace {

using posefusion::TrackingStatus;

/// Statuses of the chain, and the stamps of the colour images that the driver sent.
class Slam : public ::testing::Test {
 protected:
  Slam() {
    status_ = nh_.subscribe<TrackingStatus>(
        "/posefusion/status", 100,
        boost::function<void(const TrackingStatus::ConstPtr&)>(
            [this](const TrackingStatus::ConstPtr& s) { statuses.push_back(*s); }));
    info_ = nh_.subscribe<sensor_msgs::CameraInfo>(
        "/camera/rgb/camera_info", 100,
        boost::function<void(const sensor_msgs::CameraInfoConstPtr&)>(
            [this](const sensor_msgs::CameraInfoConstPtr& i) { stamps.insert(i->header.stamp); }));
  }

  std::size_t fused() const {
    return static_cast<std::size_t>(
        std::count_if(statuses.begin(), statuses.end(),
                      [](const TrackingStatus& s) { return s.outcome == TrackingStatus::FUSED; }));
  }
  /// A busy machine drops most frames.
  bool waitFor(std::size_t status_count, std::size_t fused_count) {
    const ros::WallTime end = ros::WallTime::now() + ros::WallDuration(80);
    while (statuses.size() < status_count || fused() < fused_count) {
      if (ros::WallTime::now() > end) return false;
      ros::spinOnce();
      ros::WallDuration(0.01).sleep();
    }
    return true;
  }

  ros::NodeHandle nh_;
  ros::Subscriber status_, info_;
  std::vector<TrackingStatus> statuses;
  std::set<ros::Time> stamps;
};

TEST_F(Slam, MapsWhatTheDriverPublishes) {
  ASSERT_TRUE(waitFor(20, 5)) << statuses.size() << " statuses, fused " << fused();
  std::size_t known = 0;
  std::set<ros::Time> answered;
  for (const TrackingStatus& s : statuses) {
    known += stamps.count(s.header.stamp);
    EXPECT_TRUE(answered.insert(s.header.stamp).second) << "two statuses of one frame";
  }
  EXPECT_GT(known, 10U) << "statuses carry the driver's stamps";
  EXPECT_EQ(statuses.back().state, TrackingStatus::TRACKING) << statuses.back().reason;
  EXPECT_GT(statuses.back().surfels, 1000U);
}

}  // namespace

int main(int argc, char** argv) {
  testing::InitGoogleTest(&argc, argv);
  ros::init(argc, argv, "test_openni2_slam");
  return RUN_ALL_TESTS();
}
