// SPDX-License-Identifier: BSD-3-Clause
#include "posefusion/loop/features.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <opencv2/imgproc.hpp>

#include "posefusion/core/error.hpp"
#include "posefusion/core/se3.hpp"
#include "posefusion/frame/working_frame.hpp"
#include "simulated_sequence.hpp"

namespace pf {
namespace {

constexpr int kLast = 15;
const DepthSensor kKinect;

const SimulatedSequence& featureRoom() {
  static const SimulatedSequence sequence("empty_box", kLast + 1);
  return sequence;
}

Features featuresOf(int index) {
  const TrueFrame truth = featureRoom().frame(index);
  FeatureImage image;
  cv::cvtColor(truth.frame.color, image.intensity, cv::COLOR_RGB2GRAY);
  depthInMetres(truth.frame, 0.3, 5.0, image.depth_m);
  image.camera = truth.frame.camera;
  return findFeatures(image);
}

TEST(Features, FindTheMotionBetweenTwoViews) {
  const FeatureMatch match = matchFeatures(featuresOf(0), featuresOf(kLast), kKinect);
  ASSERT_TRUE(match.found);
  EXPECT_LE(match.inliers, match.matches);
  const Eigen::Isometry3d off =
      match.T_first_second.inverse() * featureRoom().pose(0).inverse() * featureRoom().pose(kLast);
  EXPECT_LT(off.translation().norm(), 0.05);
  EXPECT_LT(logSo3(off.linear()).norm(), 0.03);
}

TEST(Features, TheWayBackIsTheInverse) {
  const Features a = featuresOf(0), b = featuresOf(kLast);
  const FeatureMatch forth = matchFeatures(a, b, kKinect), back = matchFeatures(b, a, kKinect);
  ASSERT_TRUE(forth.found && back.found);
  EXPECT_LT((forth.T_first_second * back.T_first_second).translation().norm(), 0.03);
}

TEST(Features, AreOnlyWhereThereIsDepth) {
  const TrueFrame truth = featureRoom().frame(0);
  FeatureImage image;
  cv::cvtColor(truth.frame.color, image.intensity, cv::COLOR_RGB2GRAY);
  image.depth_m = cv::Mat::zeros(image.intensity.size(), CV_32FC1);
  image.camera = truth.frame.camera;
  EXPECT_EQ(findFeatures(image).size(), 0U);
  EXPECT_FALSE(matchFeatures(findFeatures(image), featuresOf(0), kKinect).found);
}

TEST(Features, UnrelatedOnesDoNotMatch) {
  Features shuffled = featuresOf(0);
  std::reverse(shuffled.points.begin(), shuffled.points.end());
  const FeatureMatch match = matchFeatures(featuresOf(0), shuffled, kKinect);
  EXPECT_GT(match.matches, 12);
  EXPECT_FALSE(match.found);
}

TEST(Features, ComeBackFromTheirBytes) {
  const Features features = featuresOf(0);
  ASSERT_GT(features.size(), 12U);
  const std::string bytes = toBytes(features);
  EXPECT_EQ(toBytes(featuresFromBytes(bytes)), bytes);
  EXPECT_THROW(featuresFromBytes(bytes.substr(0, bytes.size() - 1)), InputError);
  EXPECT_THROW(featuresFromBytes(bytes + "x"), InputError);
  EXPECT_THROW(featuresFromBytes(""), InputError);
  std::string endless = bytes;
  endless[11] = 127;
  EXPECT_THROW(featuresFromBytes(endless), InputError);
}

}  // namespace
}  // namespace pf
