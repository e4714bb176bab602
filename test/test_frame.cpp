// SPDX-License-Identifier: BSD-3-Clause
#include "posefusion/core/frame.hpp"

#include <gtest/gtest.h>

#include <limits>
#include <vector>

#include "posefusion/core/error.hpp"

namespace pf {
namespace {

PinholeCamera camera() {
  PinholeCamera c;
  c.width = 64;
  c.height = 48;
  c.fx = 60;
  c.fy = 61;
  c.cx = 31;
  c.cy = 24;
  return c;
}

RgbdFrame frame() {
  RgbdFrame f;
  f.camera = camera();
  f.color = cv::Mat(48, 64, CV_8UC3, cv::Scalar(1, 2, 3));
  f.depth = cv::Mat(48, 64, CV_16UC1, cv::Scalar(1500));
  return f;
}

TEST(PinholeCamera, UnprojectInvertsProject) {
  const Eigen::Vector3d p(0.3, -0.2, 1.7);
  const Eigen::Vector2d pixel = camera().project(p);
  EXPECT_LT((camera().unproject(pixel.x(), pixel.y(), p.z()) - p).norm(), 1e-12);
}

TEST(PinholeCamera, ShrunkSeesTheMiddleOfEachBlock) {
  const PinholeCamera small = camera().shrunk(4);
  EXPECT_EQ(small.width, 16);
  EXPECT_EQ(small.height, 12);
  // Pixel (2, 3) covers pixels 8..11 and 12..15, whose middle is (9.5, 13.5).
  const Eigen::Vector3d p = camera().unproject(9.5, 13.5, 2.0);
  EXPECT_LT((small.project(p) - Eigen::Vector2d(2, 3)).norm(), 1e-12);
}

TEST(PinholeCamera, ValidateNamesTheField) {
  EXPECT_NO_THROW(validate(camera()));
  const auto message = [](const PinholeCamera& c) -> std::string {
    try {
      validate(c);
    } catch (const InputError& error) {
      return error.what();
    }
    return "";
  };
  PinholeCamera c = camera();
  c.fx = 0;
  EXPECT_EQ(message(c), "camera: fx is 0.000000, expected a focal length above 0");
  c = camera();
  c.cy = 99;
  EXPECT_EQ(message(c), "camera: cy is 99.000000, expected a row of the image");
  c = camera();
  c.distortion[2] = std::numeric_limits<double>::quiet_NaN();
  EXPECT_NE(message(c).find("distortion"), std::string::npos);
}

TEST(DefectOf, NamesWhatIsWrong) {
  EXPECT_EQ(defectOf(frame()), "");
  RgbdFrame f = frame();
  f.color = cv::Mat();
  EXPECT_EQ(defectOf(f), "there is no colour image");
  f = frame();
  f.depth.convertTo(f.depth, CV_64F);
  EXPECT_NE(defectOf(f).find("neither 16-bit"), std::string::npos);
  f = frame();
  f.camera.width = 128;
  EXPECT_EQ(defectOf(f), "the images are 64x48 but the camera is 128x48");
}

TEST(DepthInMetres, DropsWhatIsNoDistance) {
  RgbdFrame f = frame();
  f.depth = cv::Mat(48, 64, CV_32FC1, cv::Scalar(1.5));
  f.depth.at<float>(0, 0) = std::numeric_limits<float>::quiet_NaN();
  f.depth.at<float>(0, 1) = std::numeric_limits<float>::infinity();
  f.depth.at<float>(0, 2) = -std::numeric_limits<float>::infinity();
  f.depth.at<float>(0, 3) = -1;
  f.depth.at<float>(0, 4) = 7;
  f.depth.at<float>(0, 5) = 0.1F;
  cv::Mat metres;
  depthInMetres(f, 0.3, 5.0, metres);
  for (int u = 0; u < 6; ++u) EXPECT_EQ(metres.at<float>(0, u), 0) << u;
  EXPECT_EQ(metres.at<float>(0, 6), 1.5F);
}

TEST(DepthInMetres, UsesTheUnitOfTheInput) {
  RgbdFrame f = frame();
  f.depth_unit_m = 0.0002;  // TUM: 5000 steps a metre
  f.depth.setTo(7500);
  cv::Mat metres;
  depthInMetres(f, 0.3, 5.0, metres);
  EXPECT_FLOAT_EQ(metres.at<float>(10, 10), 1.5F);
}

TEST(Rectifier, PassesAnUndistortedFrameOnUntouched) {
  const RgbdFrame in = frame();
  const RgbdFrame out = Rectifier().rectify(in);
  EXPECT_EQ(out.color.data, in.color.data);
  EXPECT_EQ(out.depth.data, in.depth.data);
}

/// A bright spot of depth where the lens puts the ray (0.3, 0.2, 1), at `bend` times the
/// pinhole's distance from the centre, has to be where the pinhole sees it.
void expectStraight(const PinholeCamera& bent, double bend) {
  RgbdFrame in = frame();
  in.camera = bent;
  const double x = 0.3, y = 0.2;
  const int u = static_cast<int>(std::lround(60 * x * bend + 31));
  const int v = static_cast<int>(std::lround(61 * y * bend + 24));
  in.depth.at<std::uint16_t>(v, u) = 999;
  const RgbdFrame out = Rectifier().rectify(in);
  EXPECT_FALSE(out.camera.isDistorted());
  const Eigen::Vector2d expected = in.camera.project({x, y, 1});
  std::vector<cv::Point> found;
  cv::findNonZero(out.depth == 999, found);
  ASSERT_FALSE(found.empty());
  EXPECT_NEAR(cv::mean(found)[0], expected.x(), 0.9);
  EXPECT_NEAR(cv::mean(found)[1], expected.y(), 0.9);
  EXPECT_GT(std::abs(bend - 1), 0.06) << "a pixel: else the test could not fail";
}

TEST(Rectifier, MovesPixelsToWhereAPinholeCameraSeesThem) {
  const double r2 = 0.3 * 0.3 + 0.2 * 0.2;
  PinholeCamera bent = camera();
  bent.distortion = {-0.8, 0.1};
  expectStraight(bent, 1 - 0.8 * r2 + 0.1 * r2 * r2);
  bent.distortion = {0.2, 0, 0, 0, 0, 1.5, 0.3, 0};
  EXPECT_EQ(bent.lensName(), std::string("rational_polynomial"));
  expectStraight(bent, (1 + 0.2 * r2) / (1 + 1.5 * r2 + 0.3 * r2 * r2));
}

TEST(Rectifier, AnEquidistantLensGrowsWithTheAngle) {
  const double r = std::sqrt(0.3 * 0.3 + 0.2 * 0.2), angle = std::atan(r);
  PinholeCamera fisheye = camera();
  fisheye.lens = LensModel::kEquidistant;
  EXPECT_TRUE(fisheye.isDistorted()) << "without coefficients too";
  EXPECT_NE(fisheye, camera());
  fisheye.distortion = {-0.6, 0.1};
  expectStraight(fisheye, angle * (1 - 0.6 * angle * angle + 0.1 * std::pow(angle, 4)) / r);
}

}  // namespace
}  // namespace pf
