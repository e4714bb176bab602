// SPDX-License-Identifier: BSD-3-Clause
#include <geometry_msgs/PoseStamped.h>
#include <sensor_msgs/CompressedImage.h>

#include <cmath>
#include <cstring>
#include <opencv2/imgcodecs.hpp>
#include <opencv2/imgproc.hpp>

#include "bag_fixture.hpp"

namespace posefusion_ros {
namespace {

TEST_F(BagSourceTest, ReadsFramesPeopleAndTruth) {
  BagFile bag(path());
  for (int i = 1; i <= 5; ++i) {
    bag.info();
    bag.depth(i * 33 * kMs + 4 * kMs);
    bag.color(i * 33 * kMs);
    pf::People people{i * 33 * kMs, true, std::vector<pf::Person>(1)};
    people.people[0].joints[3] = {10, 20, 0.5F};
    bag.write("/people", toMessage(people, headerAt(people.stamp_ns)));
    geometry_msgs::PoseStamped pose;
    pose.header = headerAt(i * 33 * kMs);
    pose.pose.position.x = i;
    pose.pose.orientation.w = 1;
    bag.write("/truth", pose);
  }
  bag.close();
  const auto source = openInput(path());
  EXPECT_EQ(source->frameCount(), 5U);
  const auto frames = readAll(*source);
  ASSERT_EQ(frames.size(), 5U);
  for (int i = 1; i <= 5; ++i) {
    const auto& [frame, defect] = frames[static_cast<std::size_t>(i - 1)];
    EXPECT_EQ(defect, "");
    EXPECT_EQ(frame.stamp_ns, i * 33 * kMs);
    EXPECT_EQ(frame.camera, camera());
    EXPECT_TRUE(samePixels(frame.color, colorAt(i * 33 * kMs)));
    EXPECT_TRUE(samePixels(frame.depth, depthAt(i * 33 * kMs + 4 * kMs)));
  }
  EXPECT_EQ(source->people().at(66 * kMs).people.at(0).joints[3].v, 20);
  ASSERT_EQ(source->truth().size(), 5U);
  EXPECT_EQ(source->truth()[2].T_world_camera.translation().x(), 3);
  EXPECT_EQ(source->report().color_without_depth + source->report().depth_without_color, 0U);
}

TEST_F(BagSourceTest, ReadsCompressedAndFloatImages) {
  BagFile bag(path());
  bag.info();
  sensor_msgs::CompressedImage color;
  color.header = headerAt(kMs);
  color.format = "bgr8; png compressed bgr8";
  cv::Mat bgr;
  cv::cvtColor(colorAt(kMs), bgr, cv::COLOR_RGB2BGR);
  cv::imencode(".png", bgr, color.data);
  bag.write("/camera/rgb/image_color/compressed", color);

  // 32FC1 as inverse depth: raw = a / depth + b.
  const float a = 1000.0F, b = 3.0F;
  sensor_msgs::CompressedImage depth;
  depth.header = headerAt(kMs);
  depth.format = "32FC1; compressedDepth png";
  cv::Mat raw(48, 64, CV_16UC1, cv::Scalar(503));
  raw.at<std::uint16_t>(0, 0) = 0;
  std::vector<unsigned char> png;
  cv::imencode(".png", raw, png);
  depth.data.resize(12);
  std::memcpy(&depth.data[4], &a, 4);
  std::memcpy(&depth.data[8], &b, 4);
  depth.data.insert(depth.data.end(), png.begin(), png.end());
  bag.write("/camera/depth_registered/image_raw/compressedDepth", depth);
  bag.close();

  const auto frames = readAll(*openInput(path()));
  ASSERT_EQ(frames.size(), 1U);
  EXPECT_EQ(frames[0].defect, "");
  EXPECT_TRUE(samePixels(frames[0].frame.color, colorAt(kMs)));
  EXPECT_FLOAT_EQ(frames[0].frame.depth.at<float>(5, 5), 2.0F);
  EXPECT_TRUE(std::isnan(frames[0].frame.depth.at<float>(0, 0)));
}

TEST_F(BagSourceTest, DepthOfAnotherSizeIsReadWithItsCamera) {
  BagFile bag(path());
  bag.info();
  bag.color(33 * kMs);
  cv::Mat half;
  cv::resize(depthAt(33 * kMs), half, {}, 0.5, 0.5, cv::INTER_NEAREST);
  bag.write("/camera/depth_registered/image", *toImage(half, enc::TYPE_16UC1, headerAt(33 * kMs)));
  bag.write("/camera/depth_registered/camera_info",
            toCameraInfo(camera().shrunk(2), headerAt(33 * kMs)));
  bag.close();
  const auto frames = readAll(*openInput(path()));
  ASSERT_EQ(frames.size(), 1U);
  EXPECT_EQ(frames[0].defect, "");
  EXPECT_EQ(frames[0].frame.camera, camera().shrunk(2));
  EXPECT_TRUE(samePixels(frames[0].frame.depth, half));
  EXPECT_EQ(frames[0].frame.color.size(), half.size());
}

TEST_F(BagSourceTest, AnOffsetOfDepthIsTakenAwayBeforePairing) {
  BagFile bag(path());
  bag.info();
  for (int i = 1; i <= 3; ++i) {
    bag.color(i * 33 * kMs);
    bag.depth(i * 33 * kMs + 33 * kMs);  // one frame late: else paired with the next colour image
  }
  bag.close();
  InputOptions options;
  options.depth_stamp_offset_s = -0.033;
  const auto frames = readAll(*openInput(path(), options));
  ASSERT_EQ(frames.size(), 3U);
  for (int i = 1; i <= 3; ++i) {
    const pf::RgbdFrame& frame = frames[static_cast<std::size_t>(i - 1)].frame;
    EXPECT_EQ(frame.stamp_ns, i * 33 * kMs);
    EXPECT_TRUE(samePixels(frame.depth, depthAt((i + 1) * 33 * kMs)));
  }
}

TEST_F(BagSourceTest, TheFrameIdIsThatOfTheColorImages) {
  BagFile bag(path());
  bag.info();
  bag.color(33 * kMs);
  bag.depth(33 * kMs);
  bag.close();
  EXPECT_EQ(recordedFrameId(path(), {}), "camera");
}

TEST_F(BagSourceTest, ErrorsListWhatTheBagHas) {
  BagFile bag(path());
  bag.info();
  bag.color(33 * kMs, "/eye");
  bag.depth(33 * kMs);
  bag.close();
  const std::string error = openError();
  EXPECT_TRUE(has(error, "x.bag: no topic has a usual name of a color image")) << error;
  EXPECT_TRUE(has(error, "/eye [sensor_msgs/Image]")) << error;
  InputOptions options;
  options.topics.color = "/eyes";
  EXPECT_TRUE(has(openError(options), "topic /eyes is not in the bag, which has"));
  options.topics.color = "/camera/rgb/camera_info";
  EXPECT_TRUE(has(openError(options), "is a sensor_msgs/CameraInfo, expected sensor_msgs/Image"));
  options.topics.color = "/eye";
  EXPECT_EQ(readAll(*openInput(path(), options)).size(), 1U);
}

TEST_F(BagSourceTest, AMissingOrZeroCameraIsAnErrorUnlessAFileIsGiven) {
  BagFile without(path());
  without.color(33 * kMs);
  without.depth(33 * kMs);
  without.close();
  EXPECT_TRUE(has(openError(), "there is no camera_info for /camera/rgb/image_color"));
  InputOptions options;
  options.camera_file =
      folder.write("camera.yaml", "{width: 64, height: 48, fx: 60, fy: 60, cx: 31.5, cy: 23.5}");
  EXPECT_EQ(readAll(*openInput(path(), options)).at(0).frame.camera, camera());

  BagFile zero(path());
  zero.color(33 * kMs);
  zero.depth(33 * kMs);
  sensor_msgs::CameraInfo info;
  info.width = 64;
  info.height = 48;
  zero.write("/camera/rgb/camera_info", info);
  zero.close();
  const std::string error = openError();
  EXPECT_TRUE(has(error, "x.bag: topic /camera/rgb/camera_info: camera_info: camera: fx is 0"))
      << error;
}

}  // namespace
}  // namespace posefusion_ros
