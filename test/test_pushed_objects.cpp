// SPDX-License-Identifier: BSD-3-Clause
// An object that a person pushes is no part of the person, and stands still again once it is left.
#include <gtest/gtest.h>

#include "segmenter_scene.hpp"

namespace pf {
namespace {

constexpr int kPushed_px = 110, kTop_px = 270;
constexpr int kBegin_px = 560, kEnd_px = 335, kStep_px = 5;  // left side of the box; on the body
constexpr float kPushed_m = 1.9F;
constexpr int kRest = (kBegin_px - kEnd_px) / kStep_px;  // frame in which it touches the body

constexpr int kBeside_px = 385;  // there it is beside the body

/// A person before a mapped wall, and a thing of the clothes' colour before or beside the body.
class Pushing {
 public:
  /// A flat box that comes up to the body and rests before it.
  Segmentation seeBox(int number) {
    place(std::max(kEnd_px, kBegin_px - kStep_px * number));
    scene_.frame.depth(thing_).setTo(kPushed_m);
    return see(number);
  }

  /// A round bag that stands beside the body. `taken`: the detector takes it for the person's.
  Segmentation seeBag(int number, bool taken) {
    place(kBeside_px);
    cv::Mat bag = cv::Mat::zeros(480, 640, CV_8UC1);
    bag(thing_).setTo(255);
    putBody(scene_.frame.depth, bag, kPushed_m, thing_.x + kPushed_px / 2);
    if (taken) scene_.truth |= bag;
    scene_.people.mask = maskOf(scene_);
    return see(number);
  }

  /// Part of the thing that is masked.
  double masked(const cv::Mat& mask) const {
    return mask.empty() ? 0.0 : cv::countNonZero(mask(thing_)) / static_cast<double>(thing_.area());
  }

 private:
  void place(int left_px) {
    scene_ = Scene();
    thing_ = cv::Rect(left_px, kTop_px, kPushed_px, kPushed_px) & cv::Rect(0, 0, 640, 480);
    scene_.frame.color(thing_).setTo(cv::Scalar(30, 60, 120));
  }

  Segmentation see(int number) {
    scene_.frame.depth_unit_m = 1.0;
    scene_.frame.stamp_ns = scene_.people.stamp_ns = kFrame_ns * (number + 1);
    scene_.room.stamp_ns = kFrame_ns * number;
    scene_.room.T_world_map = Eigen::Isometry3d::Identity();
    return segmenter_.segment(scene_.frame, scene_.people, &scene_.room);
  }

  SegmenterChain segmenter_;
  Scene scene_;
  cv::Rect thing_;
};

/// Width (m) of the objects that are no people.
double widthOfObjects(const Segmentation& result) {
  double width_m = 0;
  for (const MovingObject& object : result.moving) {
    if (!object.is_person) width_m += object.box_m().sizes().x();
  }
  return width_m;
}

TEST(PushedObjects, AreFoundBesideThePersonAndLeftOutOnceAtRest) {
  const double true_m = kPushed_px * kPushed_m / kCamera.fx;
  Pushing scene;
  for (int i = 0; i < kRest + 35; ++i) {
    const Segmentation result = scene.seeBox(i);
    if (i > 15 && i < kRest + 10) {
      EXPECT_GT(scene.masked(result.mask), 0.9) << i;
      EXPECT_GT(widthOfObjects(result), 0.5 * true_m) << i;
    }
    if (i >= kRest + 20) {
      EXPECT_LT(scene.masked(result.mask), 0.1) << i;
    }
  }
}

TEST(PushedObjects, TakenForThePersonAtFirstAreLeftOutWhereTheyHaveStoodForASecond) {
  Pushing scene;
  for (int i = 0; i < 60; ++i) {
    const double masked = scene.masked(scene.seeBag(i, i < 10).mask);
    if (i < 20) {
      EXPECT_GT(masked, 0.5) << i;
    }
    if (i >= 45) {
      EXPECT_LT(masked, 0.2) << i;
    }
  }
}

}  // namespace
}  // namespace pf
