// SPDX-License-Identifier: BSD-3-Clause
#include "posefusion_ros/bags/conversions.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <boost/make_shared.hpp>
#include <map>
#include <opencv2/imgproc.hpp>

#include "../temporary_folder.hpp"
#include "message_parts.hpp"
#include "posefusion/core/error.hpp"

namespace posefusion_ros {
namespace {

using pf::errorOf;

cv::Mat noise(int type) {
  cv::Mat pixels(8, 12, type);
  cv::theRNG().state = 7;
  cv::randu(pixels, 0, 250);
  return pixels;
}

pf::PinholeCamera someCamera() {
  pf::PinholeCamera camera;
  camera.width = 12;
  camera.height = 8;
  camera.fx = 10.5;
  camera.fy = 11.5;
  camera.cx = 5.25;
  camera.cy = 3.75;
  return camera;
}

TEST(RosConversions, StampsKeepTheirNanoseconds) {
  for (const std::int64_t ns : {0L, 1L, 999999999L, 1341845820819654321L}) {
    EXPECT_EQ(toNs(toTime(ns)), ns);
  }
}

TEST(RosConversions, FramesShareTheBytesOfTheMessages) {
  const auto color = toImage(noise(CV_8UC3), "rgb8", headerAt(5));
  for (const auto& depth : {toImage(noise(CV_16UC1), "16UC1", headerAt(6)),
                            toImage(noise(CV_32FC1), "32FC1", headerAt(6))}) {
    const pf::RgbdFrame frame = toFrame(color, depth, someCamera());
    EXPECT_EQ(frame.color.data, color->data.data());
    EXPECT_EQ(frame.depth.data, depth->data.data());
    EXPECT_EQ(frame.stamp_ns, 5);
  }
}

TEST(RosConversions, OtherColourOrdersGiveTheSamePixels) {
  const cv::Mat rgb = noise(CV_8UC3);
  cv::Mat bgr, rgba, bgra;
  cv::cvtColor(rgb, bgr, cv::COLOR_RGB2BGR);
  cv::cvtColor(rgb, rgba, cv::COLOR_RGB2RGBA);
  cv::cvtColor(rgb, bgra, cv::COLOR_RGB2BGRA);
  EXPECT_TRUE(samePixels(toColor(toImage(bgr, "bgr8", headerAt(0))), rgb));
  EXPECT_TRUE(samePixels(toColor(toImage(rgba, "rgba8", headerAt(0))), rgb));
  EXPECT_TRUE(samePixels(toColor(toImage(bgra, "bgra8", headerAt(0))), rgb));
}

TEST(RosConversions, GreyBecomesEqualChannels) {
  const cv::Mat grey = noise(CV_8UC1);
  const cv::Mat rgb = toColor(toImage(grey, "mono8", headerAt(0)));
  for (int i = 0; i < 3; ++i) {
    cv::Mat channel;
    cv::extractChannel(rgb, channel, i);
    EXPECT_TRUE(samePixels(channel, grey));
  }
}

/// One colour all over, as a mosaic: the pixels (0,0) (0,1) (1,0) (1,1) have the channels.
cv::Mat mosaic(const cv::Vec3b& color, const std::array<int, 4>& channels) {
  cv::Mat raw(8, 12, CV_8UC1);
  for (int v = 0; v < raw.rows; ++v) {
    for (int u = 0; u < raw.cols; ++u) {
      raw.at<unsigned char>(v, u) = color[channels[static_cast<std::size_t>(2 * (v % 2) + u % 2)]];
    }
  }
  return raw;
}

TEST(RosConversions, EachBayerPatternGivesItsColour) {
  const cv::Vec3b color(200, 120, 40);
  const cv::Mat expected(8, 12, CV_8UC3, cv::Scalar(200, 120, 40));
  const std::map<std::string, std::array<int, 4>> patterns = {{"bayer_rggb8", {0, 1, 1, 2}},
                                                              {"bayer_bggr8", {2, 1, 1, 0}},
                                                              {"bayer_gbrg8", {1, 2, 0, 1}},
                                                              {"bayer_grbg8", {1, 0, 2, 1}}};
  for (const auto& [encoding, channels] : patterns) {
    const auto image = toImage(mosaic(color, channels), "mono8", headerAt(0));
    image->encoding = encoding;
    EXPECT_TRUE(samePixels(toColor(image), expected)) << encoding;
  }
}

TEST(RosConversions, Yuv422GivesItsColourInBothOrders) {
  // ITU-R BT.601 of red (255, 0, 0): Y 82, U 90, V 240.
  const std::map<std::string, std::array<int, 4>> orders = {{"yuv422", {90, 82, 240, 82}},
                                                            {"yuv422_yuy2", {82, 90, 82, 240}}};
  for (const auto& [encoding, bytes] : orders) {
    const auto image = boost::make_shared<sensor_msgs::Image>();
    image->width = 12;
    image->height = 8;
    image->step = 24;
    image->encoding = encoding;
    for (int i = 0; i < 8 * 24; ++i) {
      image->data.push_back(static_cast<std::uint8_t>(bytes[static_cast<std::size_t>(i % 4)]));
    }
    const cv::Mat rgb = toColor(image);
    ASSERT_EQ(rgb.type(), CV_8UC3);
    const cv::Scalar mean = cv::mean(rgb);
    EXPECT_NEAR(mean[0], 255, 3) << encoding;
    EXPECT_NEAR(mean[1], 0, 3) << encoding;
    EXPECT_NEAR(mean[2], 0, 3) << encoding;
    image->data.resize(100);
    EXPECT_NE(errorOf([&] { toColor(image); }).find("12x8 of " + encoding), std::string::npos);
  }
}

TEST(RosConversions, RowsMayBePadded) {
  const auto image = toImage(noise(CV_8UC3), "rgb8", headerAt(0));
  const cv::Mat tight = toColor(image).clone();
  auto padded = *image;
  padded.step = image->step + 5;
  padded.data.assign(padded.step * 8, 99);
  for (std::size_t v = 0; v < 8; ++v) {
    std::copy_n(image->data.begin() + v * image->step, image->step,
                padded.data.begin() + v * padded.step);
  }
  EXPECT_TRUE(samePixels(toColor(boost::make_shared<sensor_msgs::Image>(padded)), tight));
}

TEST(RosConversions, ErrorsNameTheEncodingAndTheSizes) {
  const auto color = toImage(noise(CV_8UC3), "rgb8", headerAt(0));
  const auto depth = toImage(noise(CV_16UC1), "16UC1", headerAt(0));
  EXPECT_NE(errorOf([&] { toFrame(depth, depth, someCamera()); }).find("'16UC1', expected rgb8"),
            std::string::npos);
  EXPECT_NE(errorOf([&] { toFrame(color, color, someCamera()); }).find("'rgb8', expected 16UC1"),
            std::string::npos);
  auto large = someCamera();
  large.width = 13;
  EXPECT_NE(errorOf([&] { toFrame(color, depth, large); }).find("12x8 but the camera is 13x8"),
            std::string::npos);
}

TEST(RosConversions, AMessageWithTooFewBytesIsAnError) {
  const auto color = toImage(noise(CV_8UC3), "rgb8", headerAt(0));
  color->data.resize(color->data.size() / 2);
  EXPECT_THROW(toColor(color), pf::InputError);
  color->data.clear();
  EXPECT_TRUE(toColor(color).empty());
}

TEST(RosConversions, CameraGoesThereAndBack) {
  auto camera = someCamera();
  camera.distortion = {0.1, -0.2, 0.003, -0.004, 0.05};
  EXPECT_EQ(toCamera(toCameraInfo(camera, headerAt(0)), false), camera);
  camera.distortion = {};
  EXPECT_EQ(toCamera(toCameraInfo(camera, headerAt(0)), true), camera);
}

TEST(RosConversions, BinningAndRegionMoveTheCamera) {
  auto info = toCameraInfo(someCamera(), headerAt(0));
  info.roi.x_offset = 2;
  info.roi.y_offset = 1;
  info.roi.width = 8;
  info.roi.height = 6;
  info.binning_x = 2;
  info.binning_y = 2;
  const auto camera = toCamera(info, false);
  EXPECT_EQ(camera.width, 4);
  EXPECT_EQ(camera.height, 3);
  EXPECT_DOUBLE_EQ(camera.fx, 5.25);
  EXPECT_DOUBLE_EQ(camera.cx, 1.625);
  EXPECT_DOUBLE_EQ(camera.cy, 1.375);
}

TEST(RosConversions, UselessCameraInfoIsAnErrorThatNamesTheField) {
  const sensor_msgs::CameraInfo zero;
  EXPECT_NE(errorOf([&] { toCamera(zero, false); }).find("width is 0"), std::string::npos);
  auto info = toCameraInfo(someCamera(), headerAt(0));
  info.K[0] = 0;
  EXPECT_NE(errorOf([&] { toCamera(info, false); }).find("fx is 0"), std::string::npos);
  auto other = toCameraInfo(someCamera(), headerAt(0));
  other.distortion_model = "omni";
  other.D = {0.1, 0, 0, 0};
  EXPECT_NE(errorOf([&] { toCamera(other, false); }).find("'omni' with 4 coefficients, expected"),
            std::string::npos);
  EXPECT_EQ(errorOf([&] { toCamera(other, true); }), "");
  other.distortion_model = "equidistant";
  other.D = {0.1, 0, 0, 0, 0.1};
  EXPECT_NE(errorOf([&] { toCamera(other, false); }).find("'equidistant' with 5 coefficients"),
            std::string::npos);
}

TEST(RosConversions, EachLensModelGoesThereAndBack) {
  auto camera = someCamera();
  camera.distortion = {1, 2, 3, 4, 5, 6, 7, 8};
  auto info = toCameraInfo(camera, headerAt(0));
  EXPECT_EQ(info.distortion_model, "rational_polynomial");
  EXPECT_EQ(info.D.size(), 8U);
  EXPECT_EQ(toCamera(info, false), camera);
  camera.lens = pf::LensModel::kEquidistant;
  camera.distortion = {1, 2, 3, 4};
  info = toCameraInfo(camera, headerAt(0));
  EXPECT_EQ(info.distortion_model, "equidistant");
  EXPECT_EQ(info.D.size(), 4U);
  EXPECT_EQ(toCamera(info, false), camera);
  EXPECT_FALSE(toCamera(info, true).isDistorted());
  // Drivers send this with images that they rectify.
  info.D.assign(4, 0.0);
  EXPECT_FALSE(toCamera(info, false).isDistorted());
}

TEST(RosConversions, DepthInOtherUnitsBecomesTheMetresThatTheCoreUses) {
  pf::RgbdFrame frame;
  frame.depth = noise(CV_16UC1) * 37;
  frame.depth_unit_m = 1.0 / 5000;
  const auto image = toDepthImage(frame, headerAt(0));
  ASSERT_EQ(image->encoding, "32FC1");
  pf::RgbdFrame again = frame;
  again.depth = toDepth(image);
  cv::Mat expected, actual;
  depthInMetres(frame, 0.01, 100, expected);
  depthInMetres(again, 0.01, 100, actual);
  EXPECT_TRUE(samePixels(actual, expected));
}

}  // namespace
}  // namespace posefusion_ros
