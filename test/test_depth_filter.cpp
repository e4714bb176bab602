// SPDX-License-Identifier: BSD-3-Clause
#include <gtest/gtest.h>
#include <tbb/global_control.h>

#include <cmath>
#include <opencv2/core.hpp>

#include "posefusion/frame/depth_filter.hpp"
#include "posefusion/frame/working_frame.hpp"

namespace pf {
namespace {

const DepthSensor kKinect;

PinholeCamera smallCamera() {
  PinholeCamera camera;
  camera.width = 80;
  camera.height = 60;
  camera.fx = camera.fy = 70;
  camera.cx = 39.5;
  camera.cy = 29.5;
  return camera;
}

/// Depth of the plane n . p = offset.
cv::Mat planeDepth(const PinholeCamera& camera, const Eigen::Vector3d& n, double offset) {
  cv::Mat depth(camera.height, camera.width, CV_32FC1);
  for (int v = 0; v < depth.rows; ++v) {
    for (int u = 0; u < depth.cols; ++u) {
      depth.at<float>(v, u) = static_cast<float>(offset / n.dot(camera.unproject(u, v, 1.0)));
    }
  }
  return depth;
}

cv::Mat noisyDepth(int rows, int cols) {
  cv::Mat depth(rows, cols, CV_32FC1);
  cv::RNG random(3);
  random.fill(depth, cv::RNG::UNIFORM, 0.2, 5.0);
  depth.setTo(0, depth < 0.6F);
  return depth;
}

double largestDifference(const cv::Mat& a, const cv::Mat& b, const cv::Rect& region) {
  return cv::norm(a(region), b(region), cv::NORM_INF);
}

TEST(SmoothDepth, LeavesALeaningPlaneWhereItIs) {
  const PinholeCamera camera = smallCamera();
  const cv::Mat depth = planeDepth(camera, Eigen::Vector3d(0.1, 0.5, 0.6).normalized(), 1.5);
  cv::Mat smooth;
  smoothDepth(depth, kKinect, smooth);
  EXPECT_LT(largestDifference(depth, smooth, {5, 5, 70, 50}), 1e-4);
}

TEST(SmoothDepth, LowersNoiseAndKeepsSteps) {
  cv::Mat depth(60, 80, CV_32FC1, cv::Scalar(1.0));
  depth.colRange(40, 80).setTo(1.5);
  cv::Mat noise(depth.size(), CV_32FC1);
  cv::RNG random(5);
  random.fill(noise, cv::RNG::NORMAL, 0.0, 0.002);
  cv::Mat smooth;
  smoothDepth(depth + noise, kKinect, smooth);
  cv::Scalar mean, before, after;
  cv::meanStdDev((depth + noise)(cv::Rect(5, 5, 30, 50)), mean, before);
  cv::meanStdDev(smooth(cv::Rect(5, 5, 30, 50)), mean, after);
  EXPECT_LT(after[0], 0.4 * before[0]);
  EXPECT_LT(largestDifference(depth, smooth, {30, 5, 20, 50}), 0.01);
}

TEST(SmoothDepth, KeepsHolesAndFillsNone) {
  const cv::Mat depth = noisyDepth(48, 64);
  cv::Mat smooth;
  smoothDepth(depth, kKinect, smooth);
  EXPECT_EQ(cv::countNonZero((depth > 0) != (smooth > 0)), 0);
}

TEST(ShrinkDepth, TakesTheNearestSurfaceOfABlock) {
  cv::Mat depth = (cv::Mat_<float>(2, 4) << 1.0F, 2.0F, 0.0F, 3.0F, 1.002F, 2.0F, 3.0F, 0.0F);
  cv::Mat small;
  shrinkDepth(depth, 2, kKinect, small);
  ASSERT_EQ(small.size(), cv::Size(2, 1));
  EXPECT_NEAR(small.at<float>(0, 0), 1.001, 1e-5);
  EXPECT_NEAR(small.at<float>(0, 1), 3.0, 1e-5);
}

TEST(ShrinkDepth, OfAPlaneIsThePlaneOfTheShrunkCamera) {
  const PinholeCamera camera = smallCamera();
  const Eigen::Vector3d n = Eigen::Vector3d(0.1, -0.2, 0.9).normalized();  // flat enough for
  // blocks of 4 pixels to lie on one surface by the sensor's noise
  for (const int factor : {2, 4}) {
    cv::Mat small;
    shrinkDepth(planeDepth(camera, n, 2.0), factor, kKinect, small);
    const cv::Mat expected = planeDepth(camera.shrunk(factor), n, 2.0);
    EXPECT_LT(cv::norm(small, expected, cv::NORM_INF), 1e-4) << "factor " << factor;
  }
}

TEST(ShrinkDepth, OfNothingIsNothing) {
  cv::Mat small;
  shrinkDepth(cv::Mat::zeros(6, 9, CV_32FC1), 3, kKinect, small);
  EXPECT_EQ(cv::countNonZero(small), 0);
  EXPECT_EQ(small.size(), cv::Size(3, 2));
}

TEST(ComputeNormals, OfAPlaneIsItsNormalTowardsTheCamera) {
  const PinholeCamera camera = smallCamera();
  const Eigen::Vector3d n = Eigen::Vector3d(0.3, 0.4, 0.8).normalized();
  cv::Mat x, y, z;
  computeNormals(planeDepth(camera, n, 1.0), camera, kKinect, x, y, z);
  const cv::Rect inner(1, 1, camera.width - 2, camera.height - 2);
  EXPECT_LT(cv::norm(x(inner), cv::Mat(inner.size(), CV_32FC1, -n.x()), cv::NORM_INF), 1e-3);
  EXPECT_LT(cv::norm(y(inner), cv::Mat(inner.size(), CV_32FC1, -n.y()), cv::NORM_INF), 1e-3);
  EXPECT_LT(cv::norm(z(inner), cv::Mat(inner.size(), CV_32FC1, -n.z()), cv::NORM_INF), 1e-3);
}

TEST(ComputeNormals, AreMissingAtStepsHolesAndBorders) {
  const PinholeCamera camera = smallCamera();
  cv::Mat depth(camera.height, camera.width, CV_32FC1, cv::Scalar(1.0));
  depth.colRange(40, 80).setTo(2.0);
  depth.at<float>(20, 20) = 0;
  cv::Mat x, y, z;
  computeNormals(depth, camera, kKinect, x, y, z);
  EXPECT_EQ(z.at<float>(30, 39), 0);
  EXPECT_EQ(z.at<float>(30, 40), 0);
  EXPECT_EQ(z.at<float>(20, 21), 0);
  EXPECT_EQ(z.at<float>(0, 10), 0);
  EXPECT_LT(z.at<float>(30, 30), -0.99);
}

TEST(NoisyNormalsFrom, FollowsTheSensorAndTheSizeOfThePixels) {
  PinholeCamera camera = smallCamera();
  camera.fx = camera.fy = 262.5;  // a Kinect at 320x240
  const float from_m = noisyNormalsFrom(camera, kKinect);
  EXPECT_GT(from_m, 4.0F);
  EXPECT_LT(from_m, 5.5F);
  DepthSensor quiet = kKinect;
  quiet.axial_1_m /= 10;
  EXPECT_GT(noisyNormalsFrom(camera, quiet), 15.0F);
  camera.fx = camera.fy = 525.0;
  EXPECT_LT(noisyNormalsFrom(camera, kKinect), 0.8F * from_m);
}

TEST(TakeCoarseNormals, FarAwayWhereThereAreAny) {
  const cv::Mat depth = (cv::Mat_<float>(2, 4) << 1, 6, 6, 6, 1, 6, 6, 0);
  const std::array<cv::Mat, 3> coarse = {(cv::Mat_<float>(1, 2) << 0.6F, 0.0F),
                                         (cv::Mat_<float>(1, 2) << 0.0F, 0.0F),
                                         (cv::Mat_<float>(1, 2) << -0.8F, 0.0F)};
  std::array<cv::Mat, 3> fine = {cv::Mat::zeros(2, 4, CV_32FC1), cv::Mat::zeros(2, 4, CV_32FC1),
                                 cv::Mat(2, 4, CV_32FC1, cv::Scalar(-1.0F))};
  takeCoarseNormals(depth, 5.0F, coarse, 2, {&fine[0], &fine[1], &fine[2]});
  const cv::Mat x = (cv::Mat_<float>(2, 4) << 0, 0.6F, 0, 0, 0, 0.6F, 0, 0);
  const cv::Mat z = (cv::Mat_<float>(2, 4) << -1, -0.8F, -1, -1, -1, -0.8F, -1, -1);
  EXPECT_EQ(cv::norm(fine[0], x, cv::NORM_INF), 0);
  EXPECT_EQ(cv::countNonZero(fine[1]), 0);
  EXPECT_EQ(cv::norm(fine[2], z, cv::NORM_INF), 0);
}

TEST(WorkingFrame, FarNormalsAreThoseOfTheWallNotOfTheNoise) {
  PinholeCamera camera = smallCamera();
  camera.fx = camera.fy = 262.5;
  const Eigen::Vector3d n = Eigen::Vector3d(0.3, 0.0, 1.0).normalized();
  const auto turned = [&](double offset_m) {  // share of normals off by more than 0.7 rad
    RgbdFrame frame;
    frame.camera = camera;
    frame.color = cv::Mat(camera.height, camera.width, CV_8UC3, cv::Scalar(90, 90, 90));
    frame.depth = planeDepth(camera, n, offset_m);
    frame.depth_unit_m = 1.0;
    cv::RNG random(7);
    for (int v = 0; v < frame.depth.rows; ++v) {
      for (int u = 0; u < frame.depth.cols; ++u) {
        float& z = frame.depth.at<float>(v, u);
        z += static_cast<float>(random.gaussian(kKinect.sigma(z)));
      }
    }
    FrameConfig config;
    config.shrink = 1;
    WorkingFrame working;
    working.assign(frame, {}, config);
    int count = 0, off = 0;
    const FrameLevel& level = working.levels[0];
    for (int v = 4; v < camera.height - 4; ++v) {
      for (int u = 4; u < camera.width - 4; ++u) {
        const Eigen::Vector3d seen(level.normal_x.at<float>(v, u), level.normal_y.at<float>(v, u),
                                   level.normal_z.at<float>(v, u));
        if (seen.isZero()) continue;
        ++count;
        off += -seen.dot(n) < std::cos(0.7) ? 1 : 0;
      }
    }
    EXPECT_GT(count, 2000);
    return static_cast<double>(off) / count;
  };
  EXPECT_LT(turned(3.0), 0.02);
  EXPECT_LT(turned(6.5), 0.05);
}

TEST(DepthFilter, GivesTheSameBitsForAnyNumberOfThreads) {
  const cv::Mat depth = noisyDepth(240, 320);
  cv::Mat smooth[2], small[2];
  for (int i = 0; i < 2; ++i) {
    tbb::global_control limit(tbb::global_control::max_allowed_parallelism, i == 0 ? 1 : 4);
    smoothDepth(depth, kKinect, smooth[i]);
    shrinkDepth(depth, 2, kKinect, small[i]);
  }
  EXPECT_EQ(cv::norm(smooth[0], smooth[1], cv::NORM_INF), 0);
  EXPECT_EQ(cv::norm(small[0], small[1], cv::NORM_INF), 0);
}

TEST(ShrinkToIntensity, IsTheMeanGreyOfTheBlock) {
  cv::Mat color(2, 2, CV_8UC3, cv::Scalar(0, 0, 0));
  color.at<cv::Vec3b>(0, 0) = {100, 0, 0};
  color.at<cv::Vec3b>(1, 1) = {0, 100, 0};
  cv::Mat grey;
  shrinkToIntensity(color, 2, grey);
  EXPECT_NEAR(grey.at<float>(0, 0), (29.9 + 58.7) / 4, 1e-3);
}

}  // namespace
}  // namespace pf
