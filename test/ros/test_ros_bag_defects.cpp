// SPDX-License-Identifier: BSD-3-Clause
// Bags that are damaged or lack something.
#include <algorithm>
#include <filesystem>

#include "bag_fixture.hpp"
#include "posefusion/io/files.hpp"

namespace posefusion_ros {

/// The message of another version of posefusion.
struct OldPeople {};

}  // namespace posefusion_ros

namespace ros {
namespace message_traits {

template <>
struct MD5Sum<posefusion_ros::OldPeople> {
  static const char* value() { return "0123456789abcdef0123456789abcdef"; }
  static const char* value(const posefusion_ros::OldPeople&) { return value(); }
};
template <>
struct DataType<posefusion_ros::OldPeople> {
  static const char* value() { return "posefusion/People"; }
  static const char* value(const posefusion_ros::OldPeople&) { return value(); }
};
template <>
struct Definition<posefusion_ros::OldPeople> {
  static const char* value() { return ""; }
  static const char* value(const posefusion_ros::OldPeople&) { return value(); }
};

}  // namespace message_traits

namespace serialization {

template <>
struct Serializer<posefusion_ros::OldPeople> {
  template <typename Stream>
  static void write(Stream&, const posefusion_ros::OldPeople&) {}
  static std::uint32_t serializedLength(const posefusion_ros::OldPeople&) { return 0; }
};

}  // namespace serialization
}  // namespace ros

namespace posefusion_ros {
namespace {

TEST_F(BagSourceTest, PeopleOfAnotherVersionAreRefused) {
  BagFile bag(path());
  bag.info();
  bag.color(33 * kMs);
  bag.depth(33 * kMs);
  bag.write("/people", OldPeople());
  bag.close();
  const auto source = openInput(path());
  EXPECT_EQ(readAll(*source).size(), 1U) << "without them the rest can be read";
  const std::string error = errorOf([&] { source->people(); });
  EXPECT_TRUE(has(error, path())) << error;
  EXPECT_TRUE(has(error, "/people has messages posefusion/People of another version")) << error;
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

TEST_F(BagSourceTest, AStampOfTheFutureCostsItsOwnFrameAloneAndAPauseNone) {
  BagFile bag(path());
  bag.info();
  for (const int ms : {33, 66, 7'000'000, 100, 133, 60'000, 60'033}) {
    bag.color(ms * kMs);
    bag.depth(ms * kMs);
  }
  bag.close();
  std::size_t good = 0;
  std::string defects;
  for (const auto& frame : readAll(*openInput(path()))) {
    good += frame.defect.empty() ? 1 : 0;
    defects += frame.defect;
  }
  EXPECT_EQ(good, 6U);
  EXPECT_EQ(defects, "stamp 7000.000000 is later than those of the frames after it");
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

TEST_F(BagSourceTest, ADamagedBagIsAnErrorThatNamesIt) {
  BagFile bag(path());
  bag.info();
  for (int i = 1; i <= 20; ++i) {
    bag.color(i * 33 * kMs);
    bag.depth(i * 33 * kMs);
  }
  bag.close();
  const std::string whole = pf::readFile(path());
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
  std::string whole = pf::readFile(path());
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

}  // namespace
}  // namespace posefusion_ros
