// SPDX-License-Identifier: BSD-3-Clause
#include "posefusion_ros/exact_matcher.hpp"

#include <gtest/gtest.h>
#include <sensor_msgs/Image.h>

#include <boost/make_shared.hpp>
#include <vector>

namespace posefusion_ros {
namespace {

using sensor_msgs::Image;
using Matcher = ExactMatcher<Image, Image, Image>;

Image::ConstPtr at(double seconds) {
  auto image = boost::make_shared<Image>();
  image->header.stamp = ros::Time(seconds);
  return image;
}

struct Collector {
  std::vector<double> stamps;
  Matcher matcher{3, [this](const Matcher::Set& set) {
                    EXPECT_EQ(std::get<0>(set)->header.stamp, std::get<1>(set)->header.stamp);
                    EXPECT_EQ(std::get<0>(set)->header.stamp, std::get<2>(set)->header.stamp);
                    stamps.push_back(std::get<0>(set)->header.stamp.toSec());
                  }};
};

TEST(ExactMatcher, WholeSetsComeOnceAndByPointer) {
  Image::ConstPtr seen;
  Matcher matcher(3, [&](const Matcher::Set& set) { seen = std::get<1>(set); });
  const auto image = at(1);
  matcher.add<0>(at(1));
  matcher.add<1>(image);
  EXPECT_FALSE(seen);
  matcher.add<2>(at(1));
  EXPECT_EQ(seen, image);
  EXPECT_EQ(matcher.waiting(), 0U);
}

TEST(ExactMatcher, TopicsMayRunAheadOfEachOther) {
  Collector c;
  for (int i = 1; i <= 3; ++i) c.matcher.add<0>(at(i));
  for (int i = 1; i <= 3; ++i) {
    c.matcher.add<1>(at(i));
    c.matcher.add<2>(at(i));
  }
  EXPECT_EQ(c.stamps, (std::vector<double>{1, 2, 3}));
  EXPECT_EQ(c.matcher.lost(), 0U);
}

TEST(ExactMatcher, OlderIncompleteSetsAreForgotten) {
  Collector c;
  c.matcher.add<0>(at(1));
  c.matcher.add<0>(at(2));
  c.matcher.add<1>(at(2));
  c.matcher.add<2>(at(2));
  EXPECT_EQ(c.stamps, std::vector<double>{2});
  EXPECT_EQ(c.matcher.waiting(), 0U);
}

TEST(ExactMatcher, CapacityDropsTheOldest) {
  Collector c;
  for (int i = 1; i <= 10; ++i) c.matcher.add<0>(at(i));
  EXPECT_EQ(c.matcher.waiting(), 3U);
  EXPECT_EQ(c.matcher.lost(), 7U);
}

TEST(ExactMatcher, ATimeJumpForgetsWhatWaited) {
  Collector c;
  c.matcher.add<0>(at(100));
  c.matcher.add<1>(at(100));
  for (int i = 1; i <= 2; ++i) {
    c.matcher.add<0>(at(i));
    c.matcher.add<1>(at(i));
    c.matcher.add<2>(at(i));
  }
  EXPECT_EQ(c.stamps, (std::vector<double>{1, 2}));
  c.matcher.add<2>(at(100));  // its partners belong to the time before the jump
  EXPECT_EQ(c.stamps.size(), 2U);
}

}  // namespace
}  // namespace posefusion_ros
