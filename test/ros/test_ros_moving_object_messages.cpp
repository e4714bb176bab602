// SPDX-License-Identifier: BSD-3-Clause
#include "posefusion_ros/moving_object_messages.hpp"

#include <gtest/gtest.h>

#include <cmath>

namespace posefusion_ros {
namespace {

using visualization_msgs::Marker;

pf::MovingObject object(int id, bool is_person, double speed_m_s) {
  pf::MovingObject made;
  made.id = id;
  made.is_person = is_person;
  made.placeAt({{1, 2, 0}, {2, 3, 2}}, 0);
  made.velocity_m_s.y() = speed_m_s;
  if (is_person) made.joints_m[4] = {1, 2.5F, 1};
  return made;
}

std_msgs::Header mapHeader() {
  std_msgs::Header header;
  header.frame_id = "map";
  header.stamp = ros::Time(5, 6);
  return header;
}

TEST(MovingObjectMessages, HoldPlacesAndVelocities) {
  const auto message = toMessage({object(2, true, 0.5), object(9, false, 0)}, mapHeader());
  EXPECT_EQ(message.header.frame_id, "map");
  EXPECT_EQ(message.header.stamp, ros::Time(5, 6));
  ASSERT_EQ(message.objects.size(), 2U);
  const auto& person = message.objects[0];
  EXPECT_EQ(person.id, 2);
  EXPECT_TRUE(person.is_person != 0);
  EXPECT_DOUBLE_EQ(person.centre.x, 1.5);
  EXPECT_DOUBLE_EQ(person.box_min.y, 2);
  EXPECT_DOUBLE_EQ(person.box_max.z, 2);
  EXPECT_DOUBLE_EQ(person.velocity.y, 0.5);
  ASSERT_EQ(person.joints.size(), static_cast<std::size_t>(pf::kJointCount));
  EXPECT_DOUBLE_EQ(person.joints[4].y, 2.5);
  EXPECT_TRUE(std::isnan(person.joints[5].x));
  EXPECT_FALSE(message.objects[1].is_person != 0);
  EXPECT_TRUE(message.objects[1].joints.empty());
}

TEST(MovingObjectMessages, MarkersReplaceThoseOfTheFrameBefore) {
  const auto markers = toMarkers({object(2, true, 0.5), object(2, false, 0)}, mapHeader()).markers;
  ASSERT_EQ(markers.size(), 6U) << "an arrow for the one that moves alone";
  EXPECT_EQ(markers[0].action, Marker::DELETEALL);
  const Marker &box = markers[1], &arrow = markers[3];
  EXPECT_EQ(box.type, Marker::CUBE);
  EXPECT_DOUBLE_EQ(box.pose.position.y, 2.5);
  EXPECT_DOUBLE_EQ(box.scale.z, 2);
  EXPECT_EQ(arrow.type, Marker::ARROW);
  EXPECT_NEAR(arrow.points[1].y - arrow.points[0].y, 0.25, 1e-9);
  for (std::size_t i = 1; i < markers.size(); ++i) {
    EXPECT_EQ(markers[i].header.frame_id, "map");
    for (std::size_t k = 1; k < i; ++k) {
      EXPECT_FALSE(markers[i].ns == markers[k].ns && markers[i].id == markers[k].id)
          << "numbers of people and of objects may be the same";
    }
  }
}

}  // namespace
}  // namespace posefusion_ros
