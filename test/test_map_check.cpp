// SPDX-License-Identifier: BSD-3-Clause
#include <gtest/gtest.h>

#include "posefusion/evaluation/map_check.hpp"

namespace pf {
namespace {

PinholeCamera camera() {
  PinholeCamera c;
  c.width = 80;
  c.height = 60;
  c.fx = c.fy = 70;
  c.cx = 39.5;
  c.cy = 29.5;
  return c;
}

/// Adds a disc for each pixel of `area` at depth z, facing a camera at the origin.
void addWall(SurfelArrays& s, const cv::Rect& area, double z) {
  for (int v = area.y; v < area.y + area.height; ++v) {
    for (int u = area.x; u < area.x + area.width; ++u) {
      const Eigen::Vector3f p = camera().unproject(u, v, z).cast<float>();
      s.forEachArray([](auto& array) { array.push_back(0); });
      s.x.back() = p.x();
      s.y.back() = p.y();
      s.z.back() = p.z();
      s.nz.back() = -1.0F;
      s.radius.back() = static_cast<float>(1.5 * z / camera().fx);
      s.odds.back() = static_odds::kMost;
    }
  }
}

RgbdFrame frameOf(double z) {
  RgbdFrame frame;
  frame.camera = camera();
  frame.color = cv::Mat(60, 80, CV_8UC3, cv::Scalar());
  frame.depth = cv::Mat(60, 80, CV_32FC1, cv::Scalar(z));
  return frame;
}

const cv::Rect kAll(0, 0, 80, 60);
const cv::Rect kBody(20, 10, 20, 40);

SurfelMap wallMap(double z) {
  SurfelArrays surfels;
  addWall(surfels, kAll, z);
  SurfelMap map{MapConfig{}};
  map.add(surfels);
  return map;
}

TEST(DepthCheck, IsTheOffsetOfAWall) {
  const SurfelMap map = wallMap(2.0);
  DepthCheck check(map);
  check.add(frameOf(2.004), cv::Mat(), Eigen::Isometry3d::Identity());
  EXPECT_NEAR(check.medianM(), 0.004, 1.1e-4);
  EXPECT_NEAR(check.coverage(), 1.0, 0.02);
  // Two of three frames 9 mm away: the median follows them.
  check.add(frameOf(2.009), cv::Mat(), Eigen::Isometry3d::Identity());
  check.add(frameOf(1.991), cv::Mat(), Eigen::Isometry3d::Identity());
  EXPECT_NEAR(check.medianM(), 0.009, 1.1e-4);
  EXPECT_EQ(check.frames(), 3U);
}

TEST(DepthCheck, UsesThePoseAndLeavesMaskedPixelsOut) {
  const SurfelMap map = wallMap(2.0);
  Eigen::Isometry3d back = Eigen::Isometry3d::Identity();
  back.translation().z() = -0.5;
  RgbdFrame frame = frameOf(2.5);
  frame.depth(kBody) = 1.0;
  cv::Mat mask = cv::Mat::zeros(60, 80, CV_8UC1);
  mask(kBody) = 255;
  DepthCheck check(map);
  check.add(frame, mask, back);
  EXPECT_LT(check.medianM(), 2e-4);
  EXPECT_LT(check.pixels(), static_cast<std::size_t>(80 * 60 - kBody.area()) + 1);
}

TEST(DepthCheck, OfNothingIsZero) {
  SurfelMap map{MapConfig{}};
  DepthCheck check(map);
  EXPECT_EQ(check.medianM(), 0.0);
  EXPECT_EQ(check.coverage(), 0.0);
}

TEST(PeopleCheck, FindsTheGhostAndNotTheWall) {
  SurfelArrays surfels;
  addWall(surfels, kAll, 2.0);
  const std::size_t wall = surfels.size();
  addWall(surfels, kBody, 1.0);
  PeopleCheck check(surfels);
  // The person stands in the body's place, then is gone; later one leans on the wall.
  RgbdFrame with = frameOf(2.0);
  with.depth(kBody) = 1.01;
  cv::Mat mask = cv::Mat::zeros(60, 80, CV_8UC1);
  mask(kBody) = 255;
  const cv::Mat none = cv::Mat::zeros(60, 80, CV_8UC1);
  const Eigen::Isometry3d T = Eigen::Isometry3d::Identity();
  check.add(with, mask, T);
  check.add(frameOf(2.0), none, T);
  check.add(frameOf(2.0), none, T);
  check.add(frameOf(1.98), mask, T);
  for (std::size_t i = 0; i < surfels.size(); ++i) {
    EXPECT_EQ(check.isOnPerson(i), i >= wall) << i;
  }
  EXPECT_EQ(check.onPeople(), static_cast<std::size_t>(kBody.area()));
  EXPECT_DOUBLE_EQ(check.part(), kBody.area() / static_cast<double>(surfels.size()));
}

TEST(PeopleCheck, OfAnEmptyMapIsZero) {
  SurfelArrays none;
  EXPECT_EQ(PeopleCheck(none).part(), 0.0);
}

TEST(ViewCheck, CountsFramesOfWhichPeopleLeaveAQuarter) {
  const RgbdFrame frame = frameOf(2.0);
  cv::Mat person(60, 80, CV_8UC1, cv::Scalar(0));
  person.colRange(0, 56).setTo(255);
  ViewCheck check;
  check.add(frame, person, true);
  check.add(frame, person, false);
  person.colRange(0, 64).setTo(255);
  check.add(frame, person, true);
  EXPECT_EQ(check.frames(), 2U);
  EXPECT_EQ(check.posed(), 1U);
}

}  // namespace
}  // namespace pf
