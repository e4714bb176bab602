// SPDX-License-Identifier: BSD-3-Clause
#include <gtest/gtest.h>

#include <cmath>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <opencv2/imgcodecs.hpp>
#include <opencv2/imgproc.hpp>

#include "posefusion/core/error.hpp"
#include "posefusion/pose/assembly.hpp"
#include "posefusion/pose/detector.hpp"
#include "posefusion/pose/network.hpp"
#include "test_data.hpp"

namespace pf {
namespace {

cv::Mat blobAt(float x, float y, float height, cv::Size size = {54, 40}) {
  cv::Mat map(size, CV_32FC1);
  for (int v = 0; v < size.height; ++v) {
    for (int u = 0; u < size.width; ++u) {
      const float d2 = (u - x) * (u - x) + (v - y) * (v - y);
      map.at<float>(v, u) = height * std::exp(-d2 / 4.0F);
    }
  }
  return map;
}

TEST(PeakFinder, FindsPeaksBetweenPixels) {
  PeakFinder finder;
  std::vector<Peak> peaks;
  for (const float x : {10.0F, 10.3F, 20.5F, 30.8F}) {
    for (const float y : {7.0F, 12.4F, 30.6F}) {
      finder.find(blobAt(x, y, 0.8F), 0.1F, 10, peaks);
      ASSERT_EQ(peaks.size(), 1U) << x << " " << y;
      EXPECT_NEAR(peaks[0].x, x, 0.15);
      EXPECT_NEAR(peaks[0].y, y, 0.15);
      EXPECT_NEAR(peaks[0].p, 0.8, 0.05);
    }
  }
}

TEST(PeakFinder, OrdersByHeightAndKeepsTheBest) {
  PeakFinder finder;
  std::vector<Peak> peaks;
  const cv::Mat map = blobAt(10, 10, 0.5F) + blobAt(30, 20, 0.9F) + blobAt(45, 30, 0.2F);
  finder.find(map, 0.05F, 10, peaks);
  ASSERT_EQ(peaks.size(), 3U);
  EXPECT_NEAR(peaks[0].x, 30, 0.2);
  EXPECT_NEAR(peaks[2].x, 45, 0.2);
  finder.find(map, 0.3F, 10, peaks);
  EXPECT_EQ(peaks.size(), 2U);
  finder.find(map, 0.05F, 1, peaks);
  ASSERT_EQ(peaks.size(), 1U);
  EXPECT_NEAR(peaks[0].x, 30, 0.2);
}

TEST(PeakFinder, FlatMapsHaveNone) {
  PeakFinder finder;
  std::vector<Peak> peaks{{1, 1, 1}};
  finder.find(cv::Mat(40, 54, CV_32FC1, cv::Scalar(0.5)), 0.1F, 10, peaks);
  EXPECT_TRUE(peaks.empty());
}

TEST(LimbScore, IsTheFieldAlongTheLimb) {
  const cv::Mat along(40, 54, CV_32FC1, cv::Scalar(0.6)), none(40, 54, CV_32FC1, cv::Scalar(0));
  const Peak a{10, 10, 1}, b{30, 10, 1}, c{10, 30, 1};
  EXPECT_NEAR(limbScore(along, none, a, b), 0.6, 1e-5);
  EXPECT_EQ(limbScore(along, none, b, a), 0);  // against the field
  EXPECT_EQ(limbScore(along, none, a, c), 0);  // across it
  EXPECT_EQ(limbScore(along, none, a, a), 0);
  cv::Mat gap = along.clone();
  gap.colRange(18, 23).setTo(0);  // a limb must be there all along
  EXPECT_EQ(limbScore(gap, none, a, b), 0);
}

/// Two upright people side by side, drawn as the network would: neck and nose, neck and shoulder.
struct DrawnPeople {
  ModelSettings settings;
  PoseMaps maps;
  std::vector<std::vector<Peak>> peaks{{}, {}, {}};

  explicit DrawnPeople(const std::vector<float>& columns) {
    settings.parts = {{"neck", 0, 1}, {"nose", 1, 0}, {"right_shoulder", 2, 2}};
    settings.limbs = {{0, 1, 3, 4}, {0, 2, 5, 6}};
    const int shape[] = {1, 7, 40, 60};
    maps.blob = cv::Mat(4, shape, CV_32F, cv::Scalar(0));
    for (const float x : columns) {
      peaks[0].push_back({x, 20, 0.7F});
      peaks[1].push_back({x, 10, 0.7F});
      peaks[2].push_back({x - 5, 20, 0.7F});
      const int column = static_cast<int>(x);
      maps.plane(4)(cv::Rect(column - 1, 9, 3, 13)).setTo(-0.8);  // upwards
      maps.plane(5)(cv::Rect(column - 6, 19, 7, 3)).setTo(-0.8);  // to the left
    }
  }
};

TEST(Assembly, KeepsPeopleApart) {
  const DrawnPeople drawn({15, 40});
  PoseConfig config;
  const auto people = assemblePeople(drawn.maps, drawn.settings, drawn.peaks, {600, 400}, config);
  ASSERT_EQ(people.size(), 2U);
  for (const Person& person : people) {
    const Keypoint& neck = person.joints[1];
    EXPECT_GT(neck.p, 0);
    EXPECT_NEAR(person.joints[0].u, neck.u, 1e-3);       // the nose above its own neck
    EXPECT_NEAR(person.joints[2].u, neck.u - 50, 1e-3);  // 5 map pixels = 50 image pixels
    EXPECT_NEAR(neck.v, (20 + 0.5) * 10 - 0.5, 1e-3);
    // Three peaks of 0.7 and two limbs of 0.8 over three parts.
    EXPECT_NEAR(person.score, (3 * 0.7 + 2 * 0.8) / 3, 1e-4);
    EXPECT_EQ(person.joints[5].p, 0);
  }
}

TEST(Assembly, HoldsToItsLimits) {
  const DrawnPeople drawn({10, 20, 30, 40, 50});
  PoseConfig config;
  config.max_people = 3;
  const auto count = [&] {
    return assemblePeople(drawn.maps, drawn.settings, drawn.peaks, {600, 400}, config).size();
  };
  EXPECT_EQ(count(), 3U);
  config.max_people = 15;
  EXPECT_EQ(count(), 5U);
  config.min_person_joints = 4;
  EXPECT_EQ(count(), 0U);
  config.min_person_joints = 3;
  config.min_person_score = 1.0;
  EXPECT_EQ(count(), 5U);
  for (auto& part : const_cast<DrawnPeople&>(drawn).peaks) {
    for (Peak& peak : part) peak.p = 0.1F;
  }
  EXPECT_EQ(count(), 0U);
}

std::string messageOf(const PoseConfig& config) {
  try {
    makePoseDetector(config, {});
  } catch (const InputError& error) {
    return error.what();
  }
  return "";
}

TEST(ModelSettings, ShippedFilesAreWhole) {
  int files = 0;
  for (const auto& entry : std::filesystem::directory_iterator("config/models")) {
    const ModelSettings settings = loadModelSettings(entry.path().string());
    int joints = 0;
    for (const NetworkPart& part : settings.parts) joints += part.joint >= 0;
    EXPECT_EQ(joints, kJointCount) << entry.path();
    EXPECT_GE(settings.limbs.size(), settings.parts.size()) << entry.path();
    ++files;
  }
  EXPECT_EQ(files, 4);
}

TEST(Detector, NamesAMissingModelAndTheWayToGetOne) {
  PoseConfig config;
  config.model = "/no/such/model.pb";
  EXPECT_NE(messageOf(config).find("/no/such/model.pb"), std::string::npos);
  EXPECT_NE(messageOf(config).find("scripts/get_models"), std::string::npos);
  config.model = "config/posefusion.yaml";
  EXPECT_NE(messageOf(config).find(".onnx"), std::string::npos);
}

TEST(Detector, NamesAnUnreadableModel) {
  std::string folder = (std::filesystem::temp_directory_path() / "posefusion_XXXXXX").string();
  ASSERT_NE(mkdtemp(folder.data()), nullptr);
  const std::string model = folder + "/unknown.pb";
  std::ofstream(model) << "no network";
  PoseConfig config;
  config.model = model;
  EXPECT_NE(messageOf(config).find("unknown.yaml"), std::string::npos) << messageOf(config);
  std::filesystem::copy("config/models/tf_pose_mobilenet_v2_small.yaml", folder + "/unknown.yaml");
  EXPECT_NE(messageOf(config).find(model), std::string::npos) << messageOf(config);
  EXPECT_NE(messageOf(config).find("scripts/get_models"), std::string::npos) << messageOf(config);
  std::ofstream(folder + "/unknown.yaml") << "input: {height: many}\n";
  EXPECT_NE(messageOf(config).find("unknown.yaml"), std::string::npos) << messageOf(config);
  std::filesystem::remove_all(folder);
}

TEST(Detector, RecordedPeopleComeByStamp) {
  PoseConfig config;
  config.detector = "recorded";
  RecordedPeople recorded;
  recorded[5] = {5, true, std::vector<Person>(2)};
  const auto detector = makePoseDetector(config, recorded);
  RgbdFrame frame;
  frame.stamp_ns = 5;
  EXPECT_EQ(detector->detect(frame).people.size(), 2U);
  frame.stamp_ns = 6;
  EXPECT_FALSE(detector->detect(frame).detected);
}

std::string modelPath() {
  const auto data = std::filesystem::path(testData(""));
  return (data.parent_path().parent_path() / "models/tf_pose_mobilenet_v2_small.opencv.pb")
      .string();
}

RgbdFrame photo(const std::string& name) {
  RgbdFrame frame;
  const cv::Mat image = cv::imread(testData(name));
  if (!image.empty()) cv::cvtColor(image, frame.color, cv::COLOR_BGR2RGB);
  return frame;
}

PoseConfig networkConfig(int every_nth_frame) {
  PoseConfig config;
  config.detector = "network";
  config.model = modelPath();
  config.every_nth_frame = every_nth_frame;
  return config;
}

TEST(Network, FindsPeopleOnPhotographs) {
  POSEFUSION_REQUIRE_DATA(modelPath());
  POSEFUSION_REQUIRE_DATA(testData("people_rgb/p1.jpg"));
  const auto detector = makePoseDetector(networkConfig(1), {});
  const auto count = [&](const std::string& name) {
    const People people = detector->detect(photo(name));
    EXPECT_TRUE(people.detected);
    return people.people.size();
  };
  EXPECT_EQ(count("people_rgbd/five_people/color.png"), 5U);
  EXPECT_EQ(count("people_rgb/p1.jpg"), 1U);  // another shape of input
  EXPECT_EQ(count("people_rgb/p3.jpg"), 3U);
  EXPECT_GE(count("people_rgb/ski.jpg"), 4U);
  EXPECT_EQ(count("people_rgbd/five_people/color.png"), 5U);  // and back
}

TEST(Network, SeesEveryNthFrame) {
  POSEFUSION_REQUIRE_DATA(modelPath());
  const auto detector = makePoseDetector(networkConfig(3), {});
  RgbdFrame frame;
  frame.color = cv::Mat(64, 64, CV_8UC3, cv::Scalar::all(90));
  for (int i = 0; i < 7; ++i) EXPECT_EQ(detector->detect(frame).detected, i % 3 == 0);
}

TEST(Network, DoesNotDependOnThreads) {
  POSEFUSION_REQUIRE_DATA(modelPath());
  const RgbdFrame frame = photo("people_rgbd/five_people/color.png");
  POSEFUSION_REQUIRE_DATA(testData("people_rgbd/five_people/color.png"));
  PoseNetwork network(modelPath());
  cv::setNumThreads(1);
  const cv::Mat one = network.infer(frame.color).blob.clone();
  for (const int threads : {2, 3}) {
    cv::setNumThreads(threads);
    const cv::Mat other = network.infer(frame.color).blob;
    ASSERT_EQ(one.total(), other.total());
    EXPECT_EQ(std::memcmp(one.data, other.data, one.total() * sizeof(float)), 0) << threads;
  }
  cv::setNumThreads(-1);
}

}  // namespace
}  // namespace pf
