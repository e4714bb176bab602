// SPDX-License-Identifier: BSD-3-Clause
#include "posefusion/pose/depth_input.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <vector>

namespace pf {
namespace {

const cv::Size kInputSize(kDepthInputWidth, kDepthInputHeight);

/// Depth with holes, NaN and values out of range, of a given size.
cv::Mat randomDepth(const cv::Size& size, int seed) {
  cv::RNG rng(static_cast<std::uint64_t>(seed));
  cv::Mat depth(size, CV_32FC1);
  for (int y = 0; y < size.height; ++y) {
    for (int x = 0; x < size.width; ++x) {
      const double dice = rng.uniform(0.0, 1.0);
      float& z = depth.at<float>(y, x);
      z = static_cast<float>(rng.uniform(0.1, 9.0));
      if (dice < 0.5) z = 0.0F;
      if (dice < 0.1) z = std::numeric_limits<float>::quiet_NaN();
      if (dice < 0.05) z = std::numeric_limits<float>::infinity();
    }
  }
  return depth;
}

float medianOfBlock(const cv::Mat& depth, const cv::Rect& block) {
  std::vector<float> values;
  for (int y = block.y; y < block.y + block.height; ++y) {
    for (int x = block.x; x < block.x + block.width; ++x) {
      const float z = depth.at<float>(y, x);
      if (z > 0.25F && z < 8.0F) values.push_back(z);
    }
  }
  std::sort(values.begin(), values.end());
  return values.size() < 2 ? 0.0F : values[(values.size() - 1) / 2];
}

TEST(DepthInput, EachCellIsTheLowerMedianOfItsBlock) {
  for (const int step : {2, 4, 8}) {
    const cv::Mat depth = randomDepth(kInputSize * step, step);
    cv::Mat small;
    shrinkDepth(depth, small);
    ASSERT_EQ(small.size(), kInputSize);
    for (int y = 0; y < small.rows; ++y) {
      for (int x = 0; x < small.cols; ++x) {
        ASSERT_EQ(small.at<float>(y, x), medianOfBlock(depth, {step * x, step * y, step, step}))
            << step << " " << x << " " << y;
      }
    }
  }
}

TEST(DepthInput, AnyShapeLiesInTheMiddleWithSquareCells) {
  for (const cv::Size size : {cv::Size(848, 480), cv::Size(512, 424), cv::Size(77, 200),
                              cv::Size(160, 120), cv::Size(1, 1)}) {
    const DepthInputGrid grid = depthInputGrid(size);
    const cv::Point2f middle = grid.toImage({79.5F, 59.5F});
    EXPECT_NEAR(middle.x, 0.5 * (size.width - 1), 1e-3);
    EXPECT_NEAR(middle.y, 0.5 * (size.height - 1), 1e-3);
    cv::Mat small;
    shrinkDepth(cv::Mat(size, CV_32FC1, cv::Scalar(2.0F)), small);
    const double part = cv::countNonZero(small) / static_cast<double>(small.total());
    const double expected = size.area() / (grid.step_px * grid.step_px * small.total());
    if (size.area() > 1) {
      EXPECT_NEAR(part, expected, 0.05) << size;
    }
    cv::Mat other = small.clone();
    other.setTo(2.0F, small > 0.0F);
    EXPECT_EQ(cv::norm(other, small, cv::NORM_INF), 0.0);
  }
}

TEST(DepthInput, NothingSeenIsNothingShown) {
  for (const float z : {0.0F, std::numeric_limits<float>::quiet_NaN(), -1.0F, 8.0F, 0.25F}) {
    cv::Mat small, blob;
    shrinkDepth(cv::Mat(480, 640, CV_32FC1, cv::Scalar(z)), small);
    EXPECT_EQ(cv::countNonZero(small), 0);
    depthInput(small, blob);
    EXPECT_EQ(cv::norm(blob, cv::NORM_INF), 0.0);
  }
  cv::Mat small;
  shrinkDepth(cv::Mat(), small);
  EXPECT_EQ(cv::countNonZero(small), 0);
}

TEST(DepthInput, ChannelsAreInverseLogarithmAndValidity) {
  cv::Mat small(kInputSize, CV_32FC1, cv::Scalar(0.0F));
  small.at<float>(7, 31) = 4.0F;
  cv::Mat blob;
  depthInput(small, blob);
  ASSERT_EQ(blob.dims, 4);
  const auto at = [&](int channel, int y, int x) { return blob.ptr<float>(0, channel, y)[x]; };
  EXPECT_FLOAT_EQ(at(0, 7, 31), 0.25F);
  EXPECT_FLOAT_EQ(at(1, 7, 31), std::log(4.0F));
  EXPECT_FLOAT_EQ(at(2, 7, 31), 1.0F);
  EXPECT_NEAR(cv::norm(blob, cv::NORM_L1), 0.25 + std::log(4.0) + 1.0, 1e-6);
}

}  // namespace
}  // namespace pf
