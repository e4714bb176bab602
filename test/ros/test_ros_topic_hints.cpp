// SPDX-License-Identifier: BSD-3-Clause
#include "posefusion_ros/topic_hints.hpp"

#include <gtest/gtest.h>

namespace posefusion_ros {
namespace {

constexpr char kImage[] = "sensor_msgs/Image";

const std::vector<NamedType> kPublished = {{"/camera/aligned_depth_to_color/image_raw", kImage},
                                           {"/camera/color/image_raw", kImage},
                                           {"/camera/rgb/camera_info", "sensor_msgs/CameraInfo"},
                                           {"/camera/rgb/image_raw", kImage},
                                           {"/posefusion/mask", kImage},
                                           {"/scan", "sensor_msgs/LaserScan"}};

std::string hint(const std::string& name, const std::string& type, std::size_t most = 4) {
  return topicHint({name, type}, kPublished, "/posefusion", most);
}

TEST(TopicHints, TopicsOfTheTypeComeByTheLikenessOfTheirNames) {
  EXPECT_EQ(hint("/camera/rgb/image_rect_color", kImage, 2),
            "; of its type there are /camera/color/image_raw, /camera/rgb/image_raw");
  EXPECT_EQ(hint("/camera/depth_registered/image_raw", kImage, 1).find("/camera/aligned"),
            std::string("; of its type there are ").size());
}

TEST(TopicHints, OurOwnTopicsAreNoCamera) {
  EXPECT_EQ(hint("/mask", kImage).find("/posefusion"), std::string::npos);
}

TEST(TopicHints, NoneOfTheTypeOrAnotherTypeIsReported) {
  EXPECT_EQ(hint("/x", "sensor_msgs/Imu"), "; no topic of type sensor_msgs/Imu is published");
  EXPECT_EQ(hint("/scan", kImage), "; it is published as a sensor_msgs/LaserScan");
}

}  // namespace
}  // namespace posefusion_ros
