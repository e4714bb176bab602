// SPDX-License-Identifier: BSD-3-Clause
#include <gtest/gtest.h>

#include "posefusion/core/se3.hpp"
#include "posefusion/run/map_picture.hpp"
#include "posefusion/run/people_picture.hpp"
#include "posefusion/run/plan_picture.hpp"
#include "posefusion/run/plot.hpp"
#include "small_camera.hpp"

namespace pf {
namespace {

int countColor(const cv::Mat& image, const cv::Vec3b& color) {
  cv::Mat same;
  cv::inRange(image, cv::Scalar(color), cv::Scalar(color), same);
  return cv::countNonZero(same);
}

ProcessedFrame frameAt(int i, bool person) {
  ProcessedFrame frame;
  frame.seen.frame.color = cv::Mat(240, 320, CV_8UC3, cv::Scalar(100, 100, 100));
  frame.status.stamp_ns = i * 33'000'000LL;
  if (!person) return frame;
  frame.segmentation.mask = cv::Mat::zeros(240, 320, CV_8UC1);
  frame.segmentation.mask(cv::Rect(0, 0, 160, 240)) = 255;
  return frame;
}

TEST(DrawPeople, TintsTheMaskAndDrawsTheJoints) {
  const cv::Mat color(120, 160, CV_8UC3, cv::Scalar(100, 100, 100));
  cv::Mat mask = cv::Mat::zeros(120, 160, CV_8UC1);
  mask(cv::Rect(0, 0, 40, 40)) = 255;
  People people;
  people.people.resize(1);
  people.people[0].joints[0] = {100, 60, 0.9F};
  const cv::Mat picture = drawPeople(color, people, mask);
  EXPECT_NE(picture.at<cv::Vec3b>(20, 20), cv::Vec3b(100, 100, 100));
  EXPECT_NE(picture.at<cv::Vec3b>(60, 100), cv::Vec3b(100, 100, 100));
  EXPECT_EQ(picture.at<cv::Vec3b>(100, 20), cv::Vec3b(100, 100, 100));
  EXPECT_EQ(color.at<cv::Vec3b>(20, 20), cv::Vec3b(100, 100, 100)) << "the input is left alone";
}

TEST(PeopleStrip, PrefersFramesWithPeopleAndSpreadsThem) {
  PeopleStrip strip;
  EXPECT_TRUE(strip.draw().empty());
  for (int i = 0; i < 20; ++i) strip.add(frameAt(i, false));
  EXPECT_EQ(strip.draw().size(), cv::Size(4 * 320, 240));
  EXPECT_LT(countColor(strip.draw(), {165, 60, 80}), 10);
  for (int i = 0; i < 100; ++i) strip.add(frameAt(i, true));
  const cv::Mat full = strip.draw();
  EXPECT_EQ(full.cols, 4 * 320);
  // Half of each picture is tinted, but for the stamp written over it.
  EXPECT_GT(countColor(full, {165, 60, 80}), static_cast<int>(full.total()) * 4 / 10);
}

TEST(PeopleStrip, TakesFewFramesAsTheyAre) {
  PeopleStrip strip;
  strip.add(frameAt(0, true));
  EXPECT_EQ(strip.draw().size(), cv::Size(320, 240));
}

TEST(MapPicture, ShowsTheMapFromThreeSides) {
  SurfelMap map{MapConfig{}};
  SurfelArrays s;
  // A red wall 2 m ahead and, nearer, a green surface that turns its back on the first camera.
  for (int i = -60; i <= 60; ++i) {
    for (int j = -60; j <= 60; ++j) {
      for (const bool front : {true, false}) {
        s.forEachArray([](auto& array) { array.push_back(0); });
        s.x.back() = 0.02F * static_cast<float>(i);
        s.y.back() = 0.02F * static_cast<float>(j);
        s.z.back() = front ? 2.0F : -1.0F;
        s.nz.back() = -1.0F;
        (front ? s.r : s.g).back() = 250.0F;
        s.radius.back() = 0.02F;
        s.odds.back() = static_odds::kMost;
      }
    }
  }
  map.add(s);
  const PinholeCamera camera = vga();
  const Trajectory still = {{0, Eigen::Isometry3d::Identity()}};
  const cv::Mat picture = drawMap(map, still, camera);
  ASSERT_EQ(picture.size(), cv::Size(3 * 640, 480));
  const cv::Mat last = picture.colRange(1280, 1920);
  EXPECT_GT(countColor(last, {250, 0, 0}), 640 * 480 / 2) << "the wall fills the last view";
  EXPECT_GT(countColor(picture.colRange(640, 1280), {250, 0, 0}), 2000);
  EXPECT_TRUE(drawMap(SurfelMap{MapConfig{}}, still, camera).empty());
  SurfelMap elsewhere{MapConfig{}};
  elsewhere.add(s, kFirstFragment + 1);
  EXPECT_TRUE(drawMap(elsewhere, still, camera).empty()) << "the first fragment has no stable one";
}

TEST(Plot, ShowsTruthEstimateAndDifference) {
  Trajectory truth, estimate;
  for (int i = 0; i < 60; ++i) {
    StampedPose pose;
    pose.stamp_ns = i * 33'000'000LL;
    pose.T_world_camera.translation() = Eigen::Vector3d(0.1 * i, std::sin(0.1 * i), 0);
    truth.push_back(pose);
    pose.T_world_camera.translation().y() += i % 2 == 0 ? 0.2 : -0.2;
    estimate.push_back(pose);
  }
  const auto pairs = matchPoses(truth, estimate);
  const cv::Mat plot = plotTrajectories(truth, pairs, align(pairs, false));
  EXPECT_GT(countColor(plot, {120, 120, 120}), 200);
  EXPECT_GT(countColor(plot, {20, 90, 220}), 500);
  cv::Mat reddish;  // thin lines are blended with what is below them
  cv::inRange(plot, cv::Scalar(180, 0, 0), cv::Scalar(255, 130, 130), reddish);
  EXPECT_GT(cv::countNonZero(reddish), 50);
}

/// A floor of 4 x 3 m in the plane z = 0 and a ceiling over it, z up.
std::vector<SurfacePoint> flatRoom() {
  std::vector<SurfacePoint> points;
  for (int i = 0; i < 400; ++i) {
    for (int j = 0; j < 300; ++j) {
      SurfacePoint point;
      point.position =
          Eigen::Vector3f(0.01F * static_cast<float>(i), 0.01F * static_cast<float>(j), 0);
      point.normal = Eigen::Vector3f::UnitZ();
      point.color = {0, 200, 0};
      points.push_back(point);
      point.position.z() = 2.5F;
      point.normal = -Eigen::Vector3f::UnitZ();
      point.color = {200, 0, 0};
      points.push_back(point);
    }
  }
  return points;
}

/// Looks along x, the image's y down, walks along the x axis at y = 1.
Trajectory straightWalk(double y) {
  Trajectory walk;
  for (int i = 0; i < 90; ++i) {
    Eigen::Isometry3d T = Eigen::Isometry3d::Identity();
    T.linear() << 0, 0, 1, -1, 0, 0, 0, -1, 0;
    T.translation() = Eigen::Vector3d(0.5 + 0.03 * i, y, 1.2);
    walk.push_back({i * 33'000'000LL, T});
  }
  return walk;
}

TEST(Plan, UpIsThatOfTheCameraOnTheNearestAxis) {
  Trajectory walk = straightWalk(1);
  EXPECT_TRUE(upOf(walk).isApprox(Eigen::Vector3d::UnitZ(), 0));
  for (auto& pose : walk) pose.T_world_camera.rotate(expSo3({0.3, 0, 0}));  // looks down a little
  EXPECT_TRUE(upOf(walk).isApprox(Eigen::Vector3d::UnitZ(), 0));
  const Eigen::Matrix3d R = expSo3({0.7, 0.4, 0});  // a world that is not level
  walk = straightWalk(1);
  for (auto& pose : walk) pose.T_world_camera = R * pose.T_world_camera;
  EXPECT_TRUE(upOf(walk).isApprox(R.col(2), 1e-9));
}

TEST(Plan, ShowsTheFloorBothPathsAndWrongPoses) {
  Plan plan{flatRoom(), straightWalk(1), straightWalk(1.5), {}, "a title"};
  const cv::Mat right = drawPlan(plan);
  EXPECT_EQ(right.cols, 1200);
  const int floor = countColor(right, {120, 226, 120});
  EXPECT_GT(floor, 1000 * 700) << "the ceiling does not hide it";
  EXPECT_GT(countColor(right, {30, 30, 30}), 500) << "truth";
  EXPECT_GT(countColor(right, {0, 104, 210}), 500) << "estimate";
  const int in_legend = countColor(right, {222, 30, 40});
  plan.wrong = {10, 11, 60};
  EXPECT_GT(countColor(drawPlan(plan), {222, 30, 40}), 2 * in_legend);
}

TEST(Plan, NeedsNoTruth) {
  const Plan plan{flatRoom(), {}, straightWalk(1), {}, "a map"};
  const cv::Mat picture = drawPlan(plan);
  EXPECT_EQ(picture.cols, 1200);
  EXPECT_EQ(countColor(picture, {222, 30, 40}), 0) << "nor a legend for wrong poses";
  EXPECT_GT(countColor(picture, {0, 104, 210}), 200);
}

TEST(Plan, TheLongSideLiesAcross) {
  Plan plan{flatRoom(), straightWalk(1), straightWalk(1), {}, ""};
  const cv::Mat lying = drawPlan(plan);
  const Eigen::Isometry3d turn(Eigen::AngleAxisd(M_PI / 2, Eigen::Vector3d::UnitZ()));
  for (auto* path : {&plan.truth, &plan.estimate}) {
    for (auto& pose : *path) pose.T_world_camera = turn * pose.T_world_camera;
  }
  for (auto& point : plan.surface) point.position = turn.cast<float>() * point.position;
  const cv::Mat standing = drawPlan(plan);
  EXPECT_NEAR(standing.rows, lying.rows, 2);
  plan.surface.clear();
  EXPECT_EQ(drawPlan(plan).cols, 1200) << "a path alone";
}

}  // namespace
}  // namespace pf
