// SPDX-License-Identifier: BSD-3-Clause
#include "posefusion_ros/input_pairing.hpp"

#include <gtest/gtest.h>

#include <boost/make_shared.hpp>
#include <vector>

namespace posefusion_ros {
namespace {

template <typename Message>
boost::shared_ptr<const Message> at(double seconds) {
  auto message = boost::make_shared<Message>();
  message->header.stamp = ros::Time(seconds);
  return message;
}

class Pairing : public ::testing::Test {
 protected:
  void SetUp() override {
    ros::Time::init();
    make(PairingSettings{});
  }

  void make(const PairingSettings& settings) {
    InputPairing::Handlers handlers;
    handlers.set = [this](const InputPairing::Set& set) {
      sets.push_back(set.color.header.stamp.toSec());
      last = set;
    };
    handlers.unused = [this](const std_msgs::Header& header, const std::string& reason) {
      unused.push_back(header.stamp.toSec());
      reasons.push_back(reason);
    };
    handlers.jump = [this](double seconds) { jumps.push_back(seconds); };
    pairing = std::make_unique<InputPairing>(settings, handlers);
  }

  void addAll(double stamp, double depth_lag = 0) {
    pairing->addInfo(at<sensor_msgs::CameraInfo>(stamp));
    addPair(stamp, depth_lag);
  }

  void addPair(double stamp, double depth_lag = 0, double offset = 0) {
    pairing->addDepth(InputImage(at<sensor_msgs::Image>(stamp + depth_lag), offset));
    pairing->addColor(InputImage(at<sensor_msgs::Image>(stamp)));
  }

  std::unique_ptr<InputPairing> pairing;
  std::vector<double> sets, unused, jumps;
  std::vector<std::string> reasons;
  InputPairing::Set last;
};

TEST_F(Pairing, EqualStampsPassAtOnceByPointer) {
  for (int i = 1; i <= 5; ++i) {
    const auto color = at<sensor_msgs::Image>(i);
    pairing->addColor(InputImage(color));
    pairing->addInfo(at<sensor_msgs::CameraInfo>(i));
    const auto depth = at<sensor_msgs::Image>(i);
    pairing->addDepth(InputImage(depth));
    ASSERT_EQ(sets.size(), static_cast<std::size_t>(i)) << "nothing may wait for the next frame";
    EXPECT_EQ(last.color.raw(), color);
    EXPECT_EQ(last.depth.raw(), depth);
    EXPECT_EQ(last.info->header.stamp.toSec(), i);
    EXPECT_FALSE(last.depth_info);
  }
  EXPECT_TRUE(unused.empty());
}

TEST_F(Pairing, EveryColourImageIsAccountedFor) {
  PairingSettings settings;
  settings.max_interval_s = 0.02;
  make(settings);
  for (int i = 1; i <= 30; ++i) addAll(i, i % 3 == 0 ? 0.3 : 0.005);
  addAll(31);
  for (int i = 32; i <= 60; ++i) pairing->addColor(InputImage(at<sensor_msgs::Image>(i)));
  EXPECT_EQ(sets.size(), 21U);
  EXPECT_EQ(sets.size() + unused.size(), 60U - settings.queue_size);
}

TEST_F(Pairing, ReportsWhatIsMissing) {
  for (int i = 1; i <= 11; ++i) addPair(i);
  ASSERT_EQ(unused.size(), 1U);
  EXPECT_EQ(reasons[0], "no camera_info has come yet");
  const std::string text = pairing->describeArrivals({"/rgb", "/depth", "/info"});
  EXPECT_NE(text.find("/rgb: 11, newest stamp 11"), std::string::npos) << text;
  EXPECT_NE(text.find("/info: nothing"), std::string::npos) << text;
}

TEST_F(Pairing, FramesWaitForTheFirstCameraInfo) {
  for (int i = 1; i <= 3; ++i) addPair(i);
  EXPECT_TRUE(sets.empty());
  pairing->addInfo(at<sensor_msgs::CameraInfo>(0));
  EXPECT_EQ(sets, (std::vector<double>{1, 2, 3}));
  EXPECT_TRUE(unused.empty());
}

TEST_F(Pairing, ACameraInfoThatIsSentOnceHoldsFromThenOn) {
  const auto once = at<sensor_msgs::CameraInfo>(0);
  pairing->addInfo(once);
  pairing->addDepthInfo(once);
  for (int i = 100; i < 150; ++i) addPair(i);
  EXPECT_EQ(sets.size(), 50U);
  for (int i = 1; i < 5; ++i) addPair(i);  // a bag that is played again
  EXPECT_EQ(sets.size(), 54U);
  EXPECT_EQ(jumps.size(), 1U);
  EXPECT_EQ(last.info, once);
  EXPECT_EQ(last.depth_info, once);
}

TEST_F(Pairing, TheCameraInfoOfTheStampCountsElseTheNewest) {
  pairing->addInfo(at<sensor_msgs::CameraInfo>(1));
  pairing->addInfo(at<sensor_msgs::CameraInfo>(2));
  addPair(1);
  EXPECT_EQ(last.info->header.stamp.toSec(), 1);
  addPair(1.5);
  EXPECT_EQ(last.info->header.stamp.toSec(), 2);
}

TEST_F(Pairing, AnOffsetOfDepthIsTakenAway) {
  PairingSettings settings;
  settings.max_interval_s = 0.005;
  make(settings);
  pairing->addInfo(at<sensor_msgs::CameraInfo>(0));
  for (int i = 1; i <= 3; ++i) addPair(i, 0.04, -0.04);
  EXPECT_EQ(sets.size(), 3U);
  EXPECT_NEAR(last.depth.header.stamp.toSec(), 3.04, 1e-6) << "the message is as it was";
  for (int i = 4; i <= 6; ++i) addPair(i, 0.04);
  EXPECT_EQ(sets.size(), 3U);
}

TEST_F(Pairing, OffsetsAndStampsAtTheEndsOfTimeDoNoHarm) {
  pairing->addInfo(at<sensor_msgs::CameraInfo>(0));
  pairing->addDepth(InputImage(at<sensor_msgs::Image>(1), -10));
  pairing->addDepth(InputImage(at<sensor_msgs::Image>(4294967294.0), 10));
  pairing->addColor(InputImage(at<sensor_msgs::Image>(1)));
  EXPECT_TRUE(sets.empty());
  addPair(2);
  addPair(3);
  EXPECT_EQ(sets, (std::vector<double>{2, 3})) << "it goes on";
  EXPECT_EQ(unused, std::vector<double>{1}) << "every colour image is accounted for";
}

TEST_F(Pairing, StampsThatGoBackALittleAreRefused) {
  addAll(10);
  addAll(9.5);
  addAll(10);
  addAll(11);
  EXPECT_EQ(sets, (std::vector<double>{10, 11}));
  EXPECT_EQ(unused, (std::vector<double>{9.5, 10}));
  EXPECT_EQ(reasons[0], "colour image: the stamp went back by 0.500 s");
  EXPECT_TRUE(jumps.empty());
}

TEST_F(Pairing, ATimeJumpBeginsAnew) {
  for (int i = 100; i < 105; ++i) addAll(i);
  pairing->addColor(InputImage(at<sensor_msgs::Image>(105)));
  for (int i = 1; i < 5; ++i) addAll(i);
  EXPECT_EQ(sets, (std::vector<double>{100, 101, 102, 103, 104, 1, 2, 3, 4}));
  EXPECT_EQ(unused, std::vector<double>{105});
  EXPECT_EQ(jumps.size(), 1U);
}

TEST_F(Pairing, StampZeroIsRefused) {
  addAll(0);
  EXPECT_TRUE(sets.empty());
  EXPECT_EQ(reasons, std::vector<std::string>{"colour image: the stamp is 0"});
}

TEST_F(Pairing, ExactSyncTakesEqualStampsOnly) {
  PairingSettings settings;
  settings.approximate = false;
  make(settings);
  addAll(1, 0.001);
  addAll(2);
  EXPECT_EQ(sets, std::vector<double>{2});
  EXPECT_EQ(unused, std::vector<double>{1});
}

}  // namespace
}  // namespace posefusion_ros
