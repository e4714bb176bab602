// SPDX-License-Identifier: BSD-3-Clause
#include "posefusion_ros/bags/input_image.hpp"

#include <gtest/gtest.h>

#include <boost/make_shared.hpp>
#include <opencv2/imgproc.hpp>

#include "compressed_messages.hpp"
#include "message_parts.hpp"

namespace posefusion_ros {
namespace {

cv::Mat noise(int rows, int cols, int type) {
  cv::Mat pixels(rows, cols, type);
  cv::theRNG().state = 7;
  cv::randu(pixels, 1, 250);
  return pixels;
}

pf::PinholeCamera someCamera(int scale) {
  pf::PinholeCamera camera;
  camera.width = 12 * scale;
  camera.height = 8 * scale;
  camera.fx = camera.fy = 10.5 * scale;
  camera.cx = 6 * scale - 0.5;
  camera.cy = 4 * scale - 0.5;
  return camera;
}

std_msgs::Header header() {
  std_msgs::Header header;
  header.stamp = ros::Time(5, 6);
  return header;
}

InputImage raw(const cv::Mat& pixels, const char* encoding) {
  return InputImage(sensor_msgs::ImageConstPtr(toImage(pixels, encoding, header())));
}

std::string depthError(const sensor_msgs::CompressedImageConstPtr& message) {
  return pf::errorOf([&] { toDepth(InputImage(message)); });
}

TEST(InputImage, CompressedImagesGiveThePixelsThatWentIn) {
  const cv::Mat color = noise(8, 12, CV_8UC3), depth = noise(8, 12, CV_16UC1);
  EXPECT_TRUE(samePixels(toColor(InputImage(compressedColor(color, header()))), color));
  for (const auto& message : {compressedDepth(depth, header()), plainDepth(depth, header(), ".png"),
                              plainDepth(depth, header(), ".tiff")}) {
    EXPECT_TRUE(samePixels(toDepth(InputImage(message)), depth)) << message->format;
  }
}

TEST(InputImage, ThePngItselfShowsWhetherItHasAHeader) {
  const cv::Mat depth = noise(8, 12, CV_16UC1);
  for (const auto& message :
       {compressedDepth(depth, header()), plainDepth(depth, header(), ".png")}) {
    auto unnamed = boost::make_shared<sensor_msgs::CompressedImage>(*message);
    unnamed->format = "png";
    EXPECT_TRUE(
        samePixels(toDepth(InputImage(sensor_msgs::CompressedImageConstPtr(unnamed))), depth));
  }
}

TEST(InputImage, WhatIsNoWholeImageIsRefusedByItsFormat) {
  const cv::Mat depth = noise(8, 12, CV_16UC1);
  const auto cut = [](const sensor_msgs::CompressedImageConstPtr& message, std::size_t size) {
    auto copy = boost::make_shared<sensor_msgs::CompressedImage>(*message);
    copy->data.resize(size);
    return sensor_msgs::CompressedImageConstPtr(copy);
  };
  for (const std::size_t size : {0, 5, 12, 14, 40}) {
    EXPECT_NE(
        depthError(cut(compressedDepth(depth, header()), size)).find("16UC1; compressedDepth"),
        std::string::npos)
        << size;
    EXPECT_NE(depthError(cut(plainDepth(depth, header(), ".png"), size)).find("16UC1; png"),
              std::string::npos)
        << size;
  }
  EXPECT_NE(depthError(compressedColor(noise(8, 12, CV_8UC3), header())).find("16-bit PNG"),
            std::string::npos);
  auto bare =
      boost::make_shared<sensor_msgs::CompressedImage>(*plainDepth(depth, header(), ".png"));
  bare->format = "32FC1; png";
  EXPECT_NE(depthError(bare).find("lacks the header of compressedDepth"), std::string::npos);
  const auto color = cut(compressedColor(noise(8, 12, CV_8UC3), header()), 20);
  EXPECT_NE(pf::errorOf([&] { toColor(InputImage(color)); }).find("rgb8; png"), std::string::npos);
}

TEST(InputImage, RawImagesOfOneSizeAreNotCopied) {
  const InputImage color = raw(noise(8, 12, CV_8UC3), "rgb8");
  const InputImage depth = raw(noise(8, 12, CV_16UC1), "16UC1");
  InputCamera camera;
  camera.color = someCamera(1);
  camera.depth_info =
      boost::make_shared<sensor_msgs::CameraInfo>(toCameraInfo(someCamera(2), header()));
  const auto frame = toFrame(color, depth, camera);
  EXPECT_EQ(frame.color.data, color.raw()->data.data());
  EXPECT_EQ(frame.depth.data, depth.raw()->data.data());
  EXPECT_EQ(frame.camera, someCamera(1));
  EXPECT_EQ(frame.stamp_ns, 5'000'000'006);
}

TEST(InputImage, SizesThatDifferNeedTheCameraOfDepth) {
  const InputImage color = raw(noise(16, 24, CV_8UC3), "rgb8");
  const InputImage depth = raw(noise(8, 12, CV_16UC1), "16UC1");
  InputCamera camera;
  camera.color = someCamera(2);
  const auto error = [&] { return pf::errorOf([&] { toFrame(color, depth, camera); }); };
  EXPECT_EQ(error(),
            "colour is 24x16 but depth is 12x8, expected registered images of one size, or a "
            "camera_info of depth");
  auto info = toCameraInfo(someCamera(1), header());
  camera.depth_info = boost::make_shared<sensor_msgs::CameraInfo>(info);
  const auto frame = toFrame(color, depth, camera);
  EXPECT_EQ(frame.camera, someCamera(1));
  EXPECT_EQ(frame.color.size(), cv::Size(12, 8));
  EXPECT_EQ(frame.depth.data, depth.raw()->data.data());
  info.K = {};
  camera.depth_info = boost::make_shared<sensor_msgs::CameraInfo>(info);
  EXPECT_EQ(error().find("of depth: camera_info: camera: fx is 0"), 0U) << error();
}

}  // namespace
}  // namespace posefusion_ros
