// SPDX-License-Identifier: BSD-3-Clause
#include "synthetic/sequence.hpp"

#include <gtest/gtest.h>
#include <tbb/global_control.h>

#include <opencv2/imgproc.hpp>

#include "posefusion/core/error.hpp"
#include "posefusion/core/se3.hpp"

namespace pf {
namespace {

SyntheticOptions small() {
  SyntheticOptions options;
  options.width = 160;
  options.height = 120;
  return options;
}

/// Made once: the textures take most of the time.
const SyntheticSequence& smallSequence() {
  static const SyntheticSequence sequence(small());
  return sequence;
}

bool sameBytes(const cv::Mat& a, const cv::Mat& b) {
  return a.size() == b.size() && a.type() == b.type() && cv::norm(a, b, cv::NORM_INF) == 0;
}

TEST(SyntheticSequence, SameSeedSameBytesForAnyThreadCount) {
  const SyntheticFrame many = smallSequence().frame(7);
  const tbb::global_control one(tbb::global_control::max_allowed_parallelism, 1);
  const SyntheticSequence sequence(small());
  sequence.frame(3);
  const SyntheticFrame single = sequence.frame(7);
  EXPECT_TRUE(sameBytes(many.frame.color, single.frame.color));
  EXPECT_TRUE(sameBytes(many.frame.depth, single.frame.depth));
  EXPECT_TRUE(sameBytes(many.mask, single.mask));
  EXPECT_TRUE(many.T_map_camera.isApprox(single.T_map_camera, 0));
}

TEST(SyntheticSequence, OtherSeedOtherSequence) {
  SyntheticOptions other = small();
  other.seed = 2;
  const SyntheticSequence& a = smallSequence();
  const SyntheticSequence b(other);
  EXPECT_FALSE(sameBytes(a.frame(0).frame.color, b.frame(0).frame.color));
  EXPECT_GT((a.pose(30).translation() - b.pose(30).translation()).norm(), 1e-3);
}

TEST(SyntheticSequence, FramesAreUsable) {
  const SyntheticFrame f = smallSequence().frame(0);
  EXPECT_EQ(defectOf(f.frame), "");
  EXPECT_GT(cv::countNonZero(f.frame.depth), 0.85 * f.frame.depth.total());
  EXPECT_TRUE(f.T_map_camera.isApprox(Eigen::Isometry3d::Identity(), 1e-12));
}

TEST(SyntheticSequence, MovesLikeAHeldCamera) {
  const SyntheticSequence& sequence = smallSequence();
  double path_m = 0, turned_rad = 0;
  for (int i = 1; i < sequence.frameCount(); ++i) {
    const Eigen::Isometry3d step = sequence.pose(i - 1).inverse() * sequence.pose(i);
    path_m += step.translation().norm();
    turned_rad += logSo3(step.rotation()).norm();
    EXPECT_LT(step.translation().norm(), 0.035) << "frame " << i;
  }
  const double seconds = (sequence.stamp(sequence.frameCount() - 1) - sequence.stamp(0)) * 1e-9;
  EXPECT_NEAR(path_m / seconds, 0.3, 0.12);
  EXPECT_NEAR(turned_rad / seconds * 180 / M_PI, 20, 8);
}

/// Depth of one frame, carried into another by the true poses, lies on what that one sees.
TEST(SyntheticSequence, PosesAndDepthAgree) {
  SyntheticOptions options = small();
  options.figure = false;
  const SyntheticSequence sequence(options);
  const SyntheticFrame a = sequence.frame(0), b = sequence.frame(20);
  const Eigen::Isometry3d T_b_a = b.T_map_camera.inverse() * a.T_map_camera;
  std::vector<double> errors;
  for (int v = 0; v < options.height; v += 2)
    for (int u = 0; u < options.width; u += 2) {
      const Eigen::Vector3d p =
          T_b_a * sequence.camera().unproject(u, v, a.true_depth.at<float>(v, u));
      const Eigen::Vector2d q = sequence.camera().project(p);
      const cv::Point pixel(cvRound(q.x()), cvRound(q.y()));
      if (p.z() < 0.1 || !cv::Rect({0, 0}, b.true_depth.size()).contains(pixel)) continue;
      errors.push_back(std::abs(p.z() - b.true_depth.at<float>(pixel)));
    }
  ASSERT_GT(errors.size(), 2000U);
  std::nth_element(errors.begin(), errors.begin() + errors.size() / 2, errors.end());
  EXPECT_LT(errors[errors.size() / 2], 0.006) << "half a pixel of slanted surface";
}

TEST(SyntheticSequence, FigureWalksThroughTheView) {
  const SyntheticSequence& sequence = smallSequence();
  double covered = 0;
  int seen = 0, joints_on_body = 0, joints = 0;
  for (int i = 0; i < sequence.frameCount(); i += 10, ++seen) {
    const SyntheticFrame f = sequence.frame(i);
    covered += cv::countNonZero(f.mask) / static_cast<double>(f.mask.total());
    cv::Mat wide;
    cv::dilate(f.mask, wide, cv::Mat::ones(5, 5, CV_8U));
    for (const Person& person : f.people.people)
      for (const Keypoint& k : person.joints) {
        const cv::Point at(cvRound(k.u), cvRound(k.v));
        if (k.p == 0 || !cv::Rect({0, 0}, wide.size()).contains(at)) continue;
        ++joints;
        joints_on_body += wide.at<std::uint8_t>(at) != 0;
      }
  }
  EXPECT_GT(covered / seen, 0.05);
  EXPECT_LT(covered / seen, 0.25);
  ASSERT_GT(joints, 100);
  EXPECT_GT(joints_on_body, 0.97 * joints);
}

TEST(SyntheticSequence, WithoutFigureTheRoomIsTheSame) {
  SyntheticOptions empty = small();
  empty.figure = false;
  const SyntheticFrame with = smallSequence().frame(60);
  const SyntheticFrame without = SyntheticSequence(empty).frame(60);
  EXPECT_EQ(cv::countNonZero(without.mask), 0);
  EXPECT_TRUE(without.people.detected);
  EXPECT_TRUE(without.people.people.empty());
  ASSERT_GT(cv::countNonZero(with.mask), 0);
  const cv::Mat difference = with.true_depth != without.true_depth;
  EXPECT_EQ(cv::norm(difference, with.mask, cv::NORM_INF), 0);
}

TEST(SyntheticSequence, DepthNoiseGrowsWithTheSquareOfTheDistance) {
  SyntheticOptions options;
  options.figure = false;
  const SyntheticFrame f = SyntheticSequence(options).frame(0);
  double sum[2] = {0, 0};
  int count[2] = {0, 0};
  for (int i = 0; i < static_cast<int>(f.true_depth.total()); ++i) {
    const double z = reinterpret_cast<const float*>(f.true_depth.data)[i];
    const double measured = reinterpret_cast<const std::uint16_t*>(f.frame.depth.data)[i] * 1e-3;
    const double error = measured - z;
    const bool known = measured > 0 && std::abs(error) < 0.02 * z;  // no wavering edge
    if (!known || (z > 2.8 && z < 3.4)) continue;
    const int far = z >= 3.4;
    sum[far] += error * error / (z * z * z * z);
    ++count[far];
  }
  ASSERT_GT(count[0], 1000);
  ASSERT_GT(count[1], 1000);
  EXPECT_NEAR(std::sqrt(sum[0] / count[0]), 1.65e-3, 4e-4);
  EXPECT_NEAR(std::sqrt(sum[1] / count[1]), 1.65e-3, 4e-4);
}

TEST(SyntheticSequence, ImpossibleOptionsAreNamed) {
  SyntheticOptions options;
  options.frames = 0;
  try {
    const SyntheticSequence sequence(options);
    FAIL() << "accepted";
  } catch (const InputError& error) {
    EXPECT_NE(std::string(error.what()).find("frames is 0"), std::string::npos) << error.what();
  }
}

}  // namespace
}  // namespace pf
