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

/// A person before a mapped wall, and a box of the clothes' colour that comes before the body and
/// rests there.
class Pushing {
 public:
  Segmentation see(int number) {
    Scene scene;
    box_ = {std::max(kEnd_px, kBegin_px - kStep_px * number), kTop_px, kPushed_px, kPushed_px};
    box_ &= cv::Rect(0, 0, 640, 480);
    scene.frame.depth(box_).setTo(kPushed_m);
    scene.frame.color(box_).setTo(cv::Scalar(30, 60, 120));
    scene.frame.depth_unit_m = 1.0;
    scene.frame.stamp_ns = scene.people.stamp_ns = kFrame_ns * (number + 1);
    scene.room.stamp_ns = kFrame_ns * number;
    scene.room.T_world_map = Eigen::Isometry3d::Identity();
    return segmenter_.segment(scene.frame, scene.people, &scene.room);
  }

  /// Part of the box that is masked.
  double maskedBox(const cv::Mat& mask) const {
    return mask.empty() ? 0.0 : cv::countNonZero(mask(box_)) / static_cast<double>(box_.area());
  }

 private:
  SegmenterChain segmenter_;
  cv::Rect box_;
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
    const Segmentation result = scene.see(i);
    if (i > 15 && i < kRest + 10) {
      EXPECT_GT(scene.maskedBox(result.mask), 0.9) << i;
      EXPECT_GT(widthOfObjects(result), 0.5 * true_m) << i;
    }
    if (i >= kRest + 20) EXPECT_LT(scene.maskedBox(result.mask), 0.1) << i;
  }
}

}  // namespace
}  // namespace pf
