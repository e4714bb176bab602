// SPDX-License-Identifier: BSD-3-Clause
#include "posefusion/segmentation/moving_objects.hpp"

#include <gtest/gtest.h>
#include <tbb/global_control.h>

#include <algorithm>
#include <functional>
#include <opencv2/imgproc.hpp>
#include <random>

namespace pf {
namespace {

constexpr float kBackWall_m = 3.0F, kBoxFront_m = 2.0F;
constexpr double kSide_m = 0.5;
constexpr double kNever = 1e9;
constexpr std::int64_t kStep_ns = 33'333'333;

const PinholeCamera kCamera{640, 480, 525, 525, 319.5, 239.5, {}};

/// The left side (m, map frame) of a box at kBoxFront_m, 0.5 m wide and high, at a time (s).
using Way = std::function<double(double)>;

/// Before a mapped wall stands a box. The camera looks straight at the wall.
class Room {
 public:
  explicit Room(Way box) : box_(std::move(box)), objects_(DepthSensor()) {
    view_.camera = kCamera;
    view_.depth_m = cv::Mat(480, 640, CV_32FC1, cv::Scalar(kBackWall_m));
  }

  /// Frames until `end_s`; the camera is at (x, 0, 0) with x = camera(time).
  void runUntil(
      double end_s, const Way& camera = [](double) { return 0.0; }) {
    for (; 1e-9 * static_cast<double>(stamp_ns_) < end_s; stamp_ns_ += frames_ * kStep_ns) {
      const double now_s = 1e-9 * static_cast<double>(stamp_ns_);
      see(box_(now_s), camera(now_s));
    }
  }

  void lose() { objects_.reset(); }

  /// From now on one of so many frames is seen.
  void seeOneOf(int frames) { frames_ = frames; }

  const std::vector<MovingObject>& objects() const { return found_; }
  double maskedPart() const {
    const auto& labels = objects_.labels();
    return static_cast<double>(std::count(labels.begin(), labels.end(), 1)) /
           static_cast<double>(labels.size());
  }
  /// Part of the picture that the box takes.
  double boxPart() const { return boxPart_; }
  double worstMasked() const { return worst_; }
  const std::vector<std::uint8_t>& labels() const { return objects_.labels(); }

 private:
  void see(double left_m, double camera_m) {
    RgbdFrame frame;
    frame.camera = kCamera;
    frame.color = cv::Mat(480, 640, CV_8UC3, cv::Scalar::all(100));
    cv::Mat depth_m(480, 640, CV_32FC1, cv::Scalar(kBackWall_m));
    const auto pixelOf = [&](double x_m) {
      return cvRound(kCamera.cx + kCamera.fx * (x_m - camera_m) / kBoxFront_m);
    };
    const int high = cvRound(kCamera.fy * kSide_m / kBoxFront_m);
    const cv::Rect box(pixelOf(left_m), 240, pixelOf(left_m + kSide_m) - pixelOf(left_m), high);
    const cv::Rect seen = box & cv::Rect(0, 0, 640, 480);
    depth_m(seen).setTo(kBoxFront_m);
    boxPart_ = static_cast<double>(seen.area()) / (640.0 * 480.0);
    addNoise(depth_m);
    sampleGrid(frame, depth_m, 160, grid_);
    Eigen::Isometry3d T_map_camera = Eigen::Isometry3d::Identity();
    T_map_camera.translation().x() = camera_m;
    std::vector<Background> background;
    compareWithModel(grid_, view_, view_.T_map_camera.inverse() * T_map_camera, DepthSensor(),
                     background);
    const std::vector<std::uint8_t> no_people(static_cast<std::size_t>(grid_.size()), 0);
    const MovingScene scene{grid_, kCamera, view_, T_map_camera, background, no_people, stamp_ns_};
    objects_.expect(scene);
    found_ = objects_.find(scene);
    worst_ = std::max(worst_, maskedPart());
    view_.T_map_camera = T_map_camera;  // it was tracked
    view_.stamp_ns = stamp_ns_;
  }

  void addNoise(cv::Mat& depth_m) {
    std::normal_distribution<float> normal;
    const DepthSensor sensor;
    for (float& z : cv::Mat_<float>(depth_m)) z += sensor.sigma(z) * normal(random_);
  }

  Way box_;
  MovingObjects objects_;
  ModelView view_;
  SceneGrid grid_;
  std::vector<MovingObject> found_;
  std::int64_t stamp_ns_ = kStep_ns;
  int frames_ = 1;
  std::mt19937 random_{7};
  double boxPart_ = 0, worst_ = 0;
};

Way moving(double from_m, double speed_m_s, double begin_s = 0, double end_s = kNever) {
  return [=](double t) { return from_m + speed_m_s * (std::clamp(t, begin_s, end_s) - begin_s); };
}

TEST(MovingObjects, WhatMovesIsFoundWithItsVelocityUnderOneNumber) {
  for (const double speed_m_s : {0.15, 0.5, 1.0}) {
    Room room(moving(-1.0, speed_m_s, 1.0));
    room.runUntil(1.8);
    ASSERT_EQ(room.objects().size(), 1U) << speed_m_s;
    const int id = room.objects()[0].id;
    EXPECT_NEAR(room.maskedPart(), room.boxPart(), 0.1 * room.boxPart()) << speed_m_s;
    room.runUntil(2.4);
    ASSERT_EQ(room.objects().size(), 1U) << speed_m_s;
    const MovingObject& object = room.objects()[0];
    EXPECT_EQ(object.id, id);
    EXPECT_NEAR(object.velocity_m_s.x(), speed_m_s, 0.1 + 0.15 * speed_m_s);
    EXPECT_NEAR(object.velocity_m_s.tail<2>().norm(), 0.0, 0.1);
    EXPECT_NEAR(object.box_m().sizes().x(), kSide_m, 0.08);
    EXPECT_NEAR(object.centre_m.z(), kBoxFront_m, 0.03);
  }
}

TEST(MovingObjects, WhatRestsIsOfTheStaticWorldAfterAWhile) {
  Room room(moving(-1.0, 0.8, 1.0, 2.0));
  room.runUntil(2.0);
  EXPECT_NEAR(room.maskedPart(), room.boxPart(), 0.1 * room.boxPart());
  room.runUntil(3.7);
  EXPECT_EQ(room.maskedPart(), 0.0);
}

TEST(MovingObjects, WhatStopsIsStaticSoonerThanTheOldestMomentForgetsIt) {
  for (const double speed_m_s : {0.15, 0.25, 0.5, 1.0}) {
    Room room(moving(-1.0, speed_m_s, 1.0, 2.2));
    room.runUntil(2.2);
    ASSERT_EQ(room.objects().size(), 1U) << speed_m_s;
    room.runUntil(3.0);
    EXPECT_EQ(room.maskedPart(), 0.0) << speed_m_s;
  }
}

TEST(MovingObjects, WhatStopsIsStaticAsSoonWhereMostFramesAreBlurred) {
  for (const double speed_m_s : {0.25, 1.0}) {
    Room room(moving(-1.0, speed_m_s, 1.0, 2.2));
    room.runUntil(2.2);
    ASSERT_EQ(room.objects().size(), 1U) << speed_m_s;
    room.seeOneOf(4);
    room.runUntil(3.1);
    EXPECT_EQ(room.maskedPart(), 0.0) << speed_m_s;
  }
}

TEST(MovingObjects, WhatAlwaysStoodThereIsNeverMasked) {
  Room room(moving(-0.2, 0.0));
  room.runUntil(2.0);
  EXPECT_EQ(room.worstMasked(), 0.0);
  EXPECT_GT(room.boxPart(), 0.05);
}

TEST(MovingObjects, WhatACameraComesToSeeIsNoneThatMoves) {
  // The box enters the picture as the camera moves on, with the known wall behind it.
  Room room(moving(1.3, 0.0));
  room.runUntil(3.0, [](double t) { return 0.4 * t; });
  EXPECT_EQ(room.worstMasked(), 0.0);
  EXPECT_GT(room.boxPart(), 0.05);
}

TEST(MovingObjects, ACameraThatMovesFollowsThem) {
  Room room(moving(-0.5, 0.5, 1.0));
  room.runUntil(2.0, [](double t) { return 0.3 * t; });
  ASSERT_EQ(room.objects().size(), 1U);
  EXPECT_NEAR(room.objects()[0].velocity_m_s.x(), 0.5, 0.15);
  EXPECT_NEAR(room.maskedPart(), room.boxPart(), 0.15 * room.boxPart());
}

TEST(MovingObjects, DoNotDependOnThreads) {
  std::vector<std::uint8_t> labels[2];
  for (const std::size_t threads : {1, 2}) {
    const tbb::global_control limit(tbb::global_control::max_allowed_parallelism, threads);
    Room room(moving(-1.0, 0.5, 1.0));
    room.runUntil(2.0);
    labels[threads - 1] = room.labels();
  }
  EXPECT_EQ(labels[0], labels[1]);
}

TEST(MovingObjects, AreForgottenWithTheCamerasPlace) {
  Room room(moving(-1.0, 0.5, 1.0));
  room.runUntil(2.0);
  EXPECT_GT(room.maskedPart(), 0.0);
  room.lose();
  room.runUntil(2.1);
  EXPECT_EQ(room.maskedPart(), 0.0);
}

}  // namespace
}  // namespace pf
