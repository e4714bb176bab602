// SPDX-License-Identifier: BSD-3-Clause
#include <geometry_msgs/PoseStamped.h>
#include <gtest/gtest.h>
#include <rosbag/bag.h>
#include <sensor_msgs/CompressedImage.h>
#include <sensor_msgs/image_encodings.h>

#include <cstring>
#include <filesystem>
#include <opencv2/imgcodecs.hpp>
#include <opencv2/imgproc.hpp>

#include "../../src/ros/stamp_pairer.hpp"
#include "../temporary_folder.hpp"
#include "posefusion/io/files.hpp"
#include "posefusion_ros/bag_source.hpp"
#include "posefusion_ros/conversions.hpp"

namespace posefusion_ros {
namespace {

namespace enc = sensor_msgs::image_encodings;
using posefusion::errorOf;
using posefusion::SourceFrame;

constexpr std::int64_t kMs = 1'000'000;

posefusion::PinholeCamera camera() {
  posefusion::PinholeCamera c;
  c.width = 64;
  c.height = 48;
  c.fx = c.fy = 60;
  c.cx = 31.5;
  c.cy = 23.5;
  return c;
}

std_msgs::Header headerAt(std::int64_t stamp_ns) {
  std_msgs::Header header;
  header.stamp = toTime(stamp_ns);
  header.frame_id = "camera";
  return header;
}

cv::Mat colorAt(std::int64_t stamp_ns) {
  cv::Mat image(48, 64, CV_8UC3);
  cv::RNG(static_cast<std::uint64_t>(stamp_ns)).fill(image, cv::RNG::UNIFORM, 0, 256);
  return image;
}

cv::Mat depthAt(std::int64_t stamp_ns) {
  cv::Mat image(48, 64, CV_16UC1);
  cv::RNG(static_cast<std::uint64_t>(stamp_ns) + 1).fill(image, cv::RNG::UNIFORM, 500, 4000);
  return image;
}

/// Writes messages 1 ms apart in recording time, whatever their stamps.
class BagFile {
 public:
  explicit BagFile(const std::string& path) : bag_(path, rosbag::bagmode::Write) {}

  template <typename Message>
  void write(const std::string& topic, const Message& message) {
    now_ns_ += kMs;
    bag_.write(topic, toTime(now_ns_), message);
  }
  void color(std::int64_t stamp_ns, const std::string& topic = "/camera/rgb/image_color") {
    write(topic, *toImage(colorAt(stamp_ns), enc::RGB8, headerAt(stamp_ns)));
  }
  void depth(std::int64_t stamp_ns, const std::string& topic = "/camera/depth_registered/image") {
    write(topic, *toImage(depthAt(stamp_ns), enc::TYPE_16UC1, headerAt(stamp_ns)));
  }
  void info(const std::string& topic = "/camera/rgb/camera_info") {
    write(topic, toCameraInfo(camera(), headerAt(now_ns_)));
  }
  void close() { bag_.close(); }

 private:
  rosbag::Bag bag_;
  std::int64_t now_ns_ = 1'000'000'000;
};

std::vector<SourceFrame> readAll(posefusion::FrameSource& source) {
  std::vector<SourceFrame> frames;
  while (auto frame = source.next()) frames.push_back(*frame);
  return frames;
}

bool samePixels(const cv::Mat& a, const cv::Mat& b) {
  return a.size() == b.size() && a.type() == b.type() && cv::norm(a, b, cv::NORM_INF) == 0;
}

class BagSourceTest : public testing::Test {
 protected:
  std::string path() const { return folder / "x.bag"; }
  std::string openError(const InputOptions& options = {}) const {
    return errorOf([&] { openInput(path(), options); });
  }
  static bool has(const std::string& text, const std::string& part) {
    return text.find(part) != std::string::npos;
  }
  posefusion::TemporaryFolder folder;
};

TEST_F(BagSourceTest, ReadsFramesPeopleAndTruth) {
  BagFile bag(path());
  for (int i = 1; i <= 5; ++i) {
    bag.info();
    bag.depth(i * 33 * kMs + 4 * kMs);
    bag.color(i * 33 * kMs);
    posefusion::People people{i * 33 * kMs, true, std::vector<posefusion::Person>(1)};
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

TEST_F(BagSourceTest, DepthWithoutColorAndTheReverseAreCounted) {
  BagFile bag(path());
  bag.info();
  for (int i = 1; i <= 30; ++i) {
    if (i % 5 != 0) bag.color(i * 33 * kMs);
    if (i % 6 != 0) bag.depth(i * 33 * kMs + 2 * kMs);
  }
  bag.close();
  const auto source = openInput(path());
  const auto frames = readAll(*source);
  EXPECT_EQ(frames.size(), 20U);  // neither a multiple of 5 nor of 6
  EXPECT_EQ(source->report().color_without_depth, 4U);
  EXPECT_EQ(source->report().depth_without_color, 5U);
}

TEST_F(BagSourceTest, DepthThatStopsDoesNotHoldBackTheRest) {
  BagFile bag(path());
  bag.info();
  bag.depth(33 * kMs);
  for (int i = 1; i <= 300; ++i) bag.color(i * 33 * kMs);
  bag.close();
  const auto source = openInput(path());
  EXPECT_EQ(readAll(*source).size(), 1U);
  EXPECT_EQ(source->report().color_without_depth, 299U);
}

TEST_F(BagSourceTest, StampsGoingBackAreReported) {
  BagFile bag(path());
  bag.info();
  for (const int ms : {33, 66, 40, 100, 133}) {
    bag.color(ms * kMs);
    bag.depth(ms * kMs);
  }
  bag.close();
  const auto source = openInput(path());
  std::size_t good = 0;
  std::string defects;
  for (const auto& frame : readAll(*source)) {
    good += frame.defect.empty() ? 1 : 0;
    defects += frame.defect;
  }
  EXPECT_EQ(good, 4U);
  EXPECT_EQ(defects, "stamp 0.040000 is not later than 0.066000 before it");
  ASSERT_EQ(source->report().notes.size(), 1U);
  EXPECT_TRUE(has(source->report().notes[0], "1 depth images have stamps that go back"));
}

TEST_F(BagSourceTest, UnusableImagesAreDefectsOfTheirFrames) {
  BagFile bag(path());
  bag.info();
  bag.write("/camera/rgb/image_color",
            *toImage(cv::Mat(24, 32, CV_8UC3, cv::Scalar()), enc::RGB8, headerAt(33 * kMs)));
  bag.depth(33 * kMs);
  bag.write("/camera/rgb/image_color",
            *toImage(cv::Mat(48, 64, CV_16UC1, cv::Scalar()), enc::TYPE_16UC1, headerAt(66 * kMs)));
  bag.depth(66 * kMs);
  bag.color(100 * kMs);
  bag.depth(100 * kMs);
  bag.close();
  const auto frames = readAll(*openInput(path()));
  ASSERT_EQ(frames.size(), 3U);
  EXPECT_TRUE(has(frames[0].defect, "colour is 32x24 but depth is 64x48"));
  EXPECT_TRUE(has(frames[1].defect, "encoding '16UC1', expected rgb8"));
  EXPECT_EQ(frames[2].defect, "");
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

TEST_F(BagSourceTest, ADamagedBagIsAnErrorThatNamesIt) {
  BagFile bag(path());
  bag.info();
  for (int i = 1; i <= 20; ++i) {
    bag.color(i * 33 * kMs);
    bag.depth(i * 33 * kMs);
  }
  bag.close();
  const std::string whole = posefusion::readFile(path());
  for (const std::size_t size : {whole.size() / 2, whole.size() - 10, std::size_t{100}}) {
    folder.write("x.bag", whole.substr(0, size));
    const std::string error = openError();
    EXPECT_TRUE(has(error, "x.bag: the bag ")) << size << ": " << error;
    EXPECT_TRUE(has(error, "rosbag reindex")) << size << ": " << error;
  }
  folder.write("x.bag", "");
  EXPECT_TRUE(has(openError(), "x.bag: the bag cannot be read"));
  folder.write("x.bag", "no bag at all");
  EXPECT_TRUE(has(openError(), "x.bag: the bag cannot be read"));
  std::filesystem::remove(path());
  EXPECT_TRUE(has(openError(), "does not exist"));
}

TEST_F(BagSourceTest, AHoleInTheDataKeepsTheFramesBeforeIt) {
  BagFile bag(path());
  bag.info();
  for (int i = 1; i <= 200; ++i) {
    bag.color(i * 33 * kMs);
    bag.depth(i * 33 * kMs);
  }
  bag.close();
  std::string whole = posefusion::readFile(path());
  // Within a chunk of messages; the index between chunks stays whole.
  std::fill_n(whole.begin() + static_cast<std::ptrdiff_t>(whole.size() * 5 / 8), 20'000, '\xFF');
  folder.write("x.bag", whole);
  const auto source = openInput(path());
  std::size_t read = 0;
  const std::string error = errorOf([&] {
    while (source->next()) ++read;
  });
  EXPECT_TRUE(has(error, "x.bag: the bag cannot be read")) << error;
  EXPECT_GT(read, 10U);
}

struct Stamped {
  std::int64_t stamp_ns;
};

TEST(StampPairer, TakesTheNearerOfTwoNeighbours) {
  StampPairer<Stamped> pairer(20);
  for (const int s : {100, 133, 166}) pairer.addFirst({s});
  for (const int s : {95, 119, 131, 190}) pairer.addSecond({s});
  pairer.finish();
  std::vector<std::pair<std::int64_t, std::int64_t>> pairs;
  while (auto pair = pairer.next()) pairs.emplace_back(pair->first.stamp_ns, pair->second.stamp_ns);
  const std::vector<std::pair<std::int64_t, std::int64_t>> expected = {{100, 95}, {133, 131}};
  EXPECT_EQ(pairs, expected);
  EXPECT_EQ(pairer.unpairedFirst(), 1U);
  EXPECT_EQ(pairer.unpairedSecond(), 2U);
}

TEST(StampPairer, DoesNotDependOnHowTheStreamsInterleave) {
  cv::RNG random(5);
  std::vector<Stamped> first, second;
  for (int i = 0; i < 60; ++i) {
    if (random.uniform(0, 5) > 0) first.push_back({i * 33 + random.uniform(-3, 4)});
    if (random.uniform(0, 5) > 0) second.push_back({i * 33 + random.uniform(-3, 4)});
  }
  std::vector<std::pair<std::int64_t, std::int64_t>> expected;
  for (int run = 0; run < 20; ++run) {
    StampPairer<Stamped> pairer(20);
    std::vector<std::pair<std::int64_t, std::int64_t>> pairs;
    const auto drain = [&] {
      while (auto p = pairer.next()) pairs.emplace_back(p->first.stamp_ns, p->second.stamp_ns);
    };
    std::size_t i = 0, j = 0;
    while (i < first.size() || j < second.size()) {
      const bool take_first = j == second.size() || (i < first.size() && random.uniform(0, 2) == 0);
      take_first ? pairer.addFirst(first[i++]) : pairer.addSecond(second[j++]);
      drain();
    }
    pairer.finish();
    drain();
    if (run == 0) expected = pairs;
    EXPECT_EQ(pairs, expected) << run;
    EXPECT_EQ(pairer.unpairedFirst() + pairs.size(), first.size());
    EXPECT_EQ(pairer.unpairedSecond() + pairs.size(), second.size());
  }
}

}  // namespace
}  // namespace posefusion_ros
