// SPDX-License-Identifier: BSD-3-Clause
#include "posefusion_ros/conversions.hpp"

#include <gtest/gtest.h>

#include <boost/make_shared.hpp>
#include <opencv2/imgproc.hpp>

#include "posefusion/core/error.hpp"

namespace posefusion_ros {
namespace {

using pf::InputError;

std_msgs::Header headerAt(std::int64_t stamp_ns) {
  std_msgs::Header header;
  header.stamp = toTime(stamp_ns);
  header.frame_id = "optical";
  return header;
}

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

template <typename Function>
std::string errorOf(Function function) {
  try {
    function();
  } catch (const InputError& error) {
    return error.what();
  }
  return "";
}

bool same(const cv::Mat& a, const cv::Mat& b) {
  return a.size() == b.size() && a.type() == b.type() && cv::norm(a, b, cv::NORM_INF) == 0;
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
  EXPECT_TRUE(same(toColor(toImage(bgr, "bgr8", headerAt(0))), rgb));
  EXPECT_TRUE(same(toColor(toImage(rgba, "rgba8", headerAt(0))), rgb));
  EXPECT_TRUE(same(toColor(toImage(bgra, "bgra8", headerAt(0))), rgb));
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
  EXPECT_THROW(toColor(color), InputError);
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
  auto fisheye = toCameraInfo(someCamera(), headerAt(0));
  fisheye.distortion_model = "equidistant";
  fisheye.D = {0.1, 0, 0, 0};
  EXPECT_NE(errorOf([&] { toCamera(fisheye, false); }).find("equidistant"), std::string::npos);
  EXPECT_EQ(errorOf([&] { toCamera(fisheye, true); }), "");
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
  EXPECT_TRUE(same(actual, expected));
}

}  // namespace
}  // namespace posefusion_ros
