// SPDX-License-Identifier: BSD-3-Clause
#include "posefusion/pose/person_model.hpp"

#include <gtest/gtest.h>
#include <tbb/global_control.h>

#include <cstring>
#include <filesystem>
#include <fstream>
#include <limits>

#include "posefusion/core/error.hpp"
#include "posefusion/pose/detector.hpp"
#include "temporary_folder.hpp"

namespace pf {
namespace {

// Networks without weights, of the model's inputs and outputs. Of the first, mask, joints and
// centre are sigmoid(20 (1/z - 1/2)) of the depth, shrunk, joint j times 0.2 + 0.04 j: what is
// nearer than 2 m is a person. The second gives a mask of half the size.
const char* const kNear = "test/models/near_is_person.onnx";
const char* const kOtherShape = "test/models/other_shape.onnx";

PoseConfig configOf(const std::string& model) {
  PoseConfig config;
  config.detector = "embedded";
  config.embedded_model = model;
  return config;
}

RgbdFrame frameOf(const cv::Mat& depth, int width = 640, int height = 480) {
  RgbdFrame frame;
  frame.stamp_ns = 7;
  frame.color = cv::Mat(height, width, CV_8UC3, cv::Scalar::all(90));
  frame.depth = depth;
  frame.camera = {width, height, 0.82 * width, 0.82 * width, 0.5 * width, 0.5 * height, {}};
  return frame;
}

cv::Mat box(float z, int width = 640, int height = 480) {
  cv::Mat depth(height, width, CV_32FC1, cv::Scalar(4.0));
  depth(cv::Rect(width / 4, height / 4, width / 8, height / 2)).setTo(z);
  return depth;
}

TEST(PersonModel, SeesTheDepthWhereItIs) {
  PersonModel model(kNear);
  cv::Mat small_m(kDepthInputHeight, kDepthInputWidth, CV_32FC1, cv::Scalar(4.0));
  small_m(cv::Rect(40, 20, 20, 40)).setTo(1.0F);
  const PersonMaps maps = model.infer(small_m);
  ASSERT_EQ(maps.mask.size(), cv::Size(kMaskWidth, kMaskHeight));
  ASSERT_EQ(maps.joints[17].size(), cv::Size(kMapWidth, kMapHeight));
  EXPECT_GT(maps.mask.at<float>(20, 25), 0.99);
  EXPECT_LT(maps.mask.at<float>(20, 10), 0.01);
  EXPECT_NEAR(maps.joints[17].at<float>(10, 12), 0.2 + 0.04 * 17, 1e-2);
  EXPECT_GT(maps.centre.at<float>(10, 12), 0.99);
}

TEST(PersonModel, NamesAFileThatIsNoModel) {
  const TemporaryFolder folder;
  const auto size = std::filesystem::file_size(kNear);
  std::filesystem::copy_file(kNear, folder / "half.onnx");
  std::filesystem::resize_file(folder / "half.onnx", size / 2);
  std::filesystem::create_directory(folder / "folder.onnx");
  for (const std::string& path : {folder / "missing.onnx", folder / "half.onnx",
                                  folder / "folder.onnx", folder.write("text.onnx", "no network"),
                                  folder.write("empty.onnx", ""), std::string(kOtherShape)}) {
    const std::string said = errorOf([&] { makePoseDetector(configOf(path), {}); });
    EXPECT_NE(said.find(path), std::string::npos) << path << ": " << said;
  }
  EXPECT_NE(errorOf([] { PersonModel model(kOtherShape); }).find("1x1x60x80"), std::string::npos);
}

TEST(EmbeddedDetector, LooksAtEveryFrameOfAnySize) {
  const auto detector = makePoseDetector(configOf(kNear), {});
  for (const cv::Size size : {cv::Size(640, 480), cv::Size(320, 240), cv::Size(848, 480),
                              cv::Size(160, 120), cv::Size(512, 424)}) {
    const People people =
        detector->detect(frameOf(box(1.0F, size.width, size.height), size.width, size.height));
    EXPECT_TRUE(people.detected);
    EXPECT_EQ(people.stamp_ns, 7);
    ASSERT_EQ(people.people.size(), 1U) << size;
    for (const Keypoint& joint : people.people[0].joints) {
      if (joint.p <= 0.0F) continue;
      EXPECT_GT(joint.u, 0.2F * size.width);
      EXPECT_LT(joint.u, 0.4F * size.width);
    }
  }
}

TEST(EmbeddedDetector, EmptyDepthShowsNoPerson) {
  const auto detector = makePoseDetector(configOf(kNear), {});
  const float nan = std::numeric_limits<float>::quiet_NaN();
  const float infinite = std::numeric_limits<float>::infinity();
  for (const float z : {0.0F, nan, infinite, -1.0F, 0.01F, 1000.0F}) {
    const People people = detector->detect(frameOf(cv::Mat(480, 640, CV_32FC1, cv::Scalar(z))));
    EXPECT_TRUE(people.detected) << z;
    EXPECT_TRUE(people.people.empty()) << z;
  }
  EXPECT_TRUE(detector->detect(frameOf(cv::Mat(480, 640, CV_16UC1, cv::Scalar(0)))).people.empty());
  EXPECT_TRUE(
      detector->detect(frameOf(cv::Mat(480, 640, CV_16UC1, cv::Scalar(65535)))).people.empty());
}

TEST(EmbeddedDetector, DoesNotDependOnThreads) {
  const auto detector = makePoseDetector(configOf(kNear), {});
  const RgbdFrame frame = frameOf(box(1.2F));
  const People one = [&] {
    const tbb::global_control control(tbb::global_control::max_allowed_parallelism, 1);
    return detector->detect(frame);
  }();
  const People other = detector->detect(frame);
  ASSERT_EQ(one.people.size(), other.people.size());
  EXPECT_EQ(cv::countNonZero(one.mask.probability != other.mask.probability), 0);
  EXPECT_EQ(std::memcmp(one.people.data(), other.people.data(), one.people.size() * sizeof(Person)),
            0);
}

TEST(PoseConfig, ANetworkThatIsNamedWorksBesideTheEmbeddedModel) {
  PoseConfig config;
  EXPECT_EQ(chosenDetector(config), kDefaultDetector);
  config.model = "some.pb";
  EXPECT_EQ(chosenDetector(config), "network+embedded");
  config.detector = "network";
  EXPECT_EQ(chosenDetector(config), "network");
}

TEST(PoseConfig, ANetworkLooksOftenerWhereItIsAlone) {
  PoseConfig config;
  config.model = "some.pb";
  EXPECT_EQ(lookInterval_frames(config), kLookBeside_frames);
  config.detector = "network";
  EXPECT_EQ(lookInterval_frames(config), kLookAlone_frames);
  config.every_nth_frame = 7;
  EXPECT_EQ(lookInterval_frames(config), 7);
}

/// The weights that come with the package are complete and find no person in an empty image.
TEST(PersonModel, ThePackagesOwnIsThere) {
  PersonModel model(packagedPersonModel());
  const cv::Mat wall(kDepthInputHeight, kDepthInputWidth, CV_32FC1, cv::Scalar(3.0));
  double most = 0.0;
  cv::minMaxLoc(model.infer(wall).mask, nullptr, &most);
  EXPECT_LT(most, 0.5);
}

}  // namespace
}  // namespace pf
