// SPDX-License-Identifier: BSD-3-Clause
#include "posefusion_ros/compressed_frame.hpp"

#include <gtest/gtest.h>

#include <boost/make_shared.hpp>
#include <cmath>
#include <limits>
#include <opencv2/imgproc.hpp>

#include "../temporary_folder.hpp"
#include "posefusion_ros/bags/conversions.hpp"

namespace posefusion_ros {
namespace {

constexpr double kInterval_s = 0.02;
constexpr int kQuality = 80;

pf::PinholeCamera cameraOf(int width, int height) {
  pf::PinholeCamera camera;
  camera.width = width;
  camera.height = height;
  camera.fx = camera.fy = 0.9 * width;
  camera.cx = 0.5 * width - 0.5;
  camera.cy = 0.5 * height - 0.5;
  return camera;
}

std_msgs::Header headerAtSecond(double stamp_s) {
  std_msgs::Header header;
  header.stamp = ros::Time(stamp_s);
  header.frame_id = "eye";
  return header;
}

/// Smooth colour, as a camera sees it; noise does not survive JPEG.
cv::Mat slopes(int width, int height) {
  cv::Mat image(height, width, CV_8UC3);
  for (int v = 0; v < height; ++v)
    for (int u = 0; u < width; ++u)
      image.at<cv::Vec3b>(v, u) = cv::Vec3b(2 * u, 3 * v, 200 - u - v);
  return image;
}

/// All values of 16 bits, with holes.
cv::Mat allDepths(int width, int height) {
  cv::Mat image(height, width, CV_16UC1);
  cv::theRNG().state = 5;
  cv::randu(image, 0, 65536);
  image.row(2).setTo(0);
  image.at<std::uint16_t>(0, 0) = 65535;
  return image;
}

InputImage raw(const cv::Mat& pixels, const char* encoding, double stamp_s, double offset_s = 0) {
  return InputImage(sensor_msgs::ImageConstPtr(toImage(pixels, encoding, headerAtSecond(stamp_s))),
                    offset_s);
}

sensor_msgs::CameraInfoConstPtr infoOf(int width, int height) {
  return boost::make_shared<sensor_msgs::CameraInfo>(
      toCameraInfo(cameraOf(width, height), headerAtSecond(7)));
}

InputPairing::Set someSet() {
  return {raw(slopes(48, 32), "rgb8", 10), raw(allDepths(48, 32), "16UC1", 10), infoOf(48, 32),
          infoOf(48, 32)};
}

CompressedFrameMsg pack(const InputPairing::Set& set) { return packFrame(set, 1e-3, kQuality); }

UnpackedFrame unpack(const CompressedFrameMsg& frame) {
  return unpackFrame(boost::make_shared<const CompressedFrameMsg>(frame), kInterval_s);
}

std::string unpackError(const CompressedFrameMsg& frame) {
  return pf::errorOf([&] { unpack(frame); });
}

bool has(const std::string& text, const std::string& part) {
  return text.find(part) != std::string::npos;
}

cv::Mat depthOf(const UnpackedFrame& frame) {
  return toDepth(sensor_msgs::ImageConstPtr(frame.depth));
}

TEST(CompressedFrame, DepthComesBackToTheBitAndColourAsJpegLeavesIt) {
  const auto frame = unpack(pack(someSet()));
  EXPECT_EQ(frame.depth->encoding, "16UC1");
  EXPECT_EQ(cv::norm(depthOf(frame), allDepths(48, 32), cv::NORM_INF), 0.0);
  EXPECT_EQ(frame.color->encoding, "rgb8");
  const cv::Mat color = toColor(sensor_msgs::ImageConstPtr(frame.color));
  cv::Mat error;
  cv::absdiff(color, slopes(48, 32), error);
  EXPECT_LT(cv::mean(error)[0], 4.0);
  EXPECT_LT(cv::norm(error, cv::NORM_INF), 40.0);
  for (const auto& header :
       {frame.color->header, frame.depth->header, frame.info->header, frame.depth_info->header}) {
    EXPECT_EQ(header.stamp, ros::Time(10));
    EXPECT_EQ(header.frame_id, "eye");
  }
  EXPECT_EQ(toCamera(*frame.info, true), cameraOf(48, 32));
}

TEST(CompressedFrame, QualityIsThatOfTheJpeg) {
  const auto set = someSet();
  EXPECT_LT(packFrame(set, 1e-3, 20).color.data.size(), packFrame(set, 1e-3, 95).color.data.size());
}

TEST(CompressedFrame, MetresComeBackWithinHalfAStepAndHolesAsHoles) {
  cv::Mat metres(32, 48, CV_32FC1);
  cv::randu(metres, 0.3, 16.0);
  metres.at<float>(1, 1) = std::numeric_limits<float>::quiet_NaN();
  metres.at<float>(2, 1) = std::numeric_limits<float>::infinity();
  metres.at<float>(3, 1) = -1.0F;
  metres.at<float>(4, 1) = 17.0F;  // beyond 16 bits
  auto set = someSet();
  set.depth = raw(metres, "32FC1", 10);
  const auto frame = unpack(pack(set));
  ASSERT_EQ(frame.depth->encoding, "32FC1");
  const cv::Mat back = depthOf(frame);
  for (int v = 1; v <= 4; ++v) {
    EXPECT_EQ(back.at<float>(v, 1), 0.0F) << v;
    metres.at<float>(v, 1) = 0.0F;
  }
  EXPECT_LT(cv::norm(back, metres, cv::NORM_INF), 0.51 * kMetricDepthStep_m);
}

TEST(CompressedFrame, AnotherUnitOfDepthIsSentAlong) {
  const auto packed = packFrame(someSet(), 2e-3, kQuality);
  EXPECT_EQ(packed.depth_unit_m, 2e-3);
  const auto frame = unpack(packed);
  ASSERT_EQ(frame.depth->encoding, "32FC1");
  EXPECT_FLOAT_EQ(depthOf(frame).at<float>(0, 0), 65535 * 2e-3F);
}

TEST(CompressedFrame, DepthOfAnotherSizeNeedsItsCamera) {
  auto set = someSet();
  set.depth = raw(allDepths(24, 16), "16UC1", 10);
  set.depth_info = nullptr;
  EXPECT_TRUE(has(pf::errorOf([&] { pack(set); }),
                  "depth is 24x16 and colour 48x32: expected a camera_info of depth"));
  set.depth_info = infoOf(24, 16);
  const auto frame = unpack(pack(set));
  EXPECT_EQ(frame.depth->width, 24U);
  EXPECT_EQ(toCamera(*frame.depth_info, true), cameraOf(24, 16));
}

TEST(CompressedFrame, WhatDoesNotFitIsNotPacked) {
  auto set = someSet();
  set.info = infoOf(40, 30);
  EXPECT_EQ(pf::errorOf([&] { pack(set); }),
            "colour is 48x32, expected the 40x30 of its camera_info");
  set.info = boost::make_shared<sensor_msgs::CameraInfo>();
  EXPECT_TRUE(has(pf::errorOf([&] { pack(set); }), "colour comes with an empty camera_info"));
  set.info = nullptr;
  EXPECT_EQ(pf::errorOf([&] { pack(set); }), "no camera_info of colour");
  set = someSet();
  set.depth = raw(slopes(48, 32), "rgb8", 10);
  EXPECT_TRUE(has(pf::errorOf([&] { pack(set); }), "encoding 'rgb8', expected 16UC1"));
  set = someSet();
  set.color = InputImage(boost::make_shared<const sensor_msgs::Image>());
  EXPECT_EQ(pf::errorOf([&] { pack(set); }), "colour image has no pixels");
}

TEST(CompressedFrame, OfCutImagesNothingIsUsed) {
  const auto good = pack(someSet());
  for (const double share : {0.0, 0.1, 0.5, 0.9, 0.99}) {
    auto cut = good;
    cut.color.data.resize(static_cast<std::size_t>(share * good.color.data.size()));
    EXPECT_TRUE(has(unpackError(cut), "a compressed colour image is not whole")) << share;
    EXPECT_TRUE(has(unpackError(cut), std::to_string(cut.color.data.size()) + " bytes")) << share;
    cut = good;
    cut.depth.data.resize(static_cast<std::size_t>(share * good.depth.data.size()));
    EXPECT_TRUE(has(unpackError(cut), "a compressed depth image")) << share;
  }
  auto crossed = good;
  crossed.depth.data = good.color.data;
  EXPECT_TRUE(has(unpackError(crossed), "a compressed depth image is not a whole 16-bit PNG"));
}

TEST(CompressedFrame, SizesAndUnitsHaveToBeThoseOfTheMessage) {
  auto frame = pack(someSet());
  frame.camera_info = *infoOf(64, 48);
  EXPECT_EQ(unpackError(frame), "colour is 48x32, expected the 64x48 of its camera_info");
  frame = pack(someSet());
  frame.depth_camera_info = sensor_msgs::CameraInfo();
  EXPECT_TRUE(has(unpackError(frame), "depth comes with an empty camera_info"));
  for (const double unit : {0.0, -1.0, 2.0, std::nan("")}) {
    frame = pack(someSet());
    frame.depth_unit_m = unit;
    EXPECT_TRUE(has(unpackError(frame), "depth_unit_m is ")) << unit;
  }
}

TEST(CompressedFrame, ImagesOfDifferentFramesAreNotPutTogether) {
  auto frame = pack(someSet());
  frame.depth.header.stamp = ros::Time(10.033);
  EXPECT_TRUE(has(unpackError(frame), "of different frames, expected at most 0.02"));
  frame.depth.header.stamp = ros::Time();
  EXPECT_TRUE(has(unpackError(frame), "of different frames"));
  frame.depth.header.stamp = ros::Time(10.02);
  EXPECT_EQ(unpackError(frame), "");
  frame.color.header.stamp = ros::Time(11);
  EXPECT_TRUE(has(unpackError(frame), "colour has the stamp 11.000000000, expected 10.000000000"));
}

TEST(CompressedFrame, AnOffsetOfTheStampsOfDepthIsTakenIn) {
  auto set = someSet();
  set.depth = raw(allDepths(48, 32), "16UC1", 10.1, -0.1);
  EXPECT_EQ(pack(set).depth.header.stamp, ros::Time(10));
}

}  // namespace
}  // namespace posefusion_ros
