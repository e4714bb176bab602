// SPDX-License-Identifier: BSD-3-Clause
#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>
#include <opencv2/imgcodecs.hpp>

#include "posefusion/core/error.hpp"
#include "posefusion/run/mask_folders.hpp"

namespace pf {
namespace {

cv::Mat boxMask(const cv::Rect& box) {
  cv::Mat mask = cv::Mat::zeros(100, 200, CV_8UC1);
  mask(box).setTo(255);
  return mask;
}

TEST(MaskCheck, CountsByHand) {
  MaskCheck check;
  check.add(boxMask({0, 0, 100, 100}), boxMask({50, 0, 100, 100}));  // half of each
  EXPECT_NEAR(check.crowded().iou, 1.0 / 3, 1e-12);
  EXPECT_NEAR(check.crowded().recall, 0.5, 1e-12);
  EXPECT_NEAR(check.crowded().precision, 0.5, 1e-12);
  EXPECT_NEAR(check.falseFraction(), 0.25, 1e-12);
  check.add(boxMask({0, 0, 100, 100}), cv::Mat::zeros(100, 200, CV_8UC1));
  EXPECT_NEAR(check.crowded().iou, 1.0 / 6, 1e-12);
  EXPECT_NEAR(check.crowded().precision, 0.5, 1e-12);       // nothing masked: no precision
  check.add(boxMask({0, 0, 2, 2}), boxMask({0, 0, 2, 2}));  // under 2 %
  EXPECT_EQ(check.crowded().frames, 2);
  EXPECT_EQ(check.frames(), 3);
}

TEST(MaskCheck, OnlyFoundPartsCount) {
  // Two people that overlap in the image, one metre apart.
  cv::Mat truth = boxMask({20, 20, 80, 60}), depth(100, 200, CV_32FC1, cv::Scalar(3));
  depth(cv::Rect(20, 20, 40, 60)).setTo(1);
  depth(cv::Rect(60, 20, 40, 60)).setTo(2);
  People people{1, true, std::vector<Person>(1)};
  for (int i = 0; i < 3; ++i) people.people[0].joints[i] = {30, 30.0F + 10 * i, 0.5F};
  const cv::Mat found = foundParts(truth, depth, people);
  EXPECT_EQ(cv::countNonZero(found != boxMask({20, 20, 40, 60})), 0);
  people.people[0].joints[2].p = 0;  // two joints are too few
  EXPECT_EQ(cv::countNonZero(foundParts(truth, depth, people)), 0);

  MaskCheck check;
  check.addFound(truth, truth, found);  // the other person does not count against the mask
  EXPECT_DOUBLE_EQ(check.found().iou, 1.0);
  check.addFound(truth, truth, cv::Mat::zeros(100, 200, CV_8UC1));
  EXPECT_EQ(check.found().frames, 1);
}

TEST(MaskCheck, ReadsFolders) {
  namespace fs = std::filesystem;
  std::string folder = (fs::temp_directory_path() / "posefusion_XXXXXX").string();
  ASSERT_NE(mkdtemp(folder.data()), nullptr);
  fs::create_directories(folder + "/truth/mask");
  fs::create_directories(folder + "/run/mask");
  EXPECT_THROW(checkMasks(folder + "/none", folder + "/run"), InputError);
  cv::imwrite(folder + "/run/mask/1.000000.png", boxMask({0, 0, 100, 100}));
  EXPECT_THROW(checkMasks(folder + "/truth", folder + "/run"), InputError);
  cv::imwrite(folder + "/truth/mask/1.000000.png", boxMask({0, 0, 100, 100}));
  EXPECT_DOUBLE_EQ(checkMasks(folder + "/truth", folder + "/run").crowded().iou, 1.0);
  // A sequence without masks has no people in it.
  fs::remove_all(folder + "/truth/mask");
  std::ofstream(folder + "/truth/rgb.txt") << "1.0 rgb/1.png\n";
  EXPECT_DOUBLE_EQ(checkMasks(folder + "/truth", folder + "/run").falseFraction(), 0.5);
  fs::remove_all(folder);
}

}  // namespace
}  // namespace pf
