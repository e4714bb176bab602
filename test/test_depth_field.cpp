// SPDX-License-Identifier: BSD-3-Clause
#include "posefusion/calibration/depth_field.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <opencv2/imgproc.hpp>
#include <stdexcept>

#include "calibration_room.hpp"
#include "posefusion/calibration/depth_correction.hpp"

namespace pf {
namespace {

/// All nodes the same.
DepthField flat(double per_m) { return {4, 4, std::vector<double>(16, per_m)}; }

TEST(DepthField, weighsAllOfItsNodesTogetherOnce) {
  for (const double x : {0.0, 0.31, 1.0}) EXPECT_NEAR(flat(0.002).at(x, 1 - x), 0.002, 1e-17);
  const DepthField field = test::roomField();
  EXPECT_DOUBLE_EQ(field.at(-3, 7), field.at(0, 1)) << "outside counts as on the border";
}

TEST(DepthField, followsASmoothFunctionWithFewNodes) {
  const auto d = [](double x, double y) { return 0.004 * std::sin(9 * x + 1) * std::cos(7 * y); };
  const DepthField field = fittedField(12, 9, d);
  for (int i = 0; i < 200; ++i) {
    const double x = (i % 20) / 19.0, y = (i / 20) / 9.0;
    EXPECT_NEAR(field.at(x, y), d(x, y), 0.0001) << x << " " << y;
  }
  const DepthField linear = fittedField(5, 4, [](double x, double y) { return x - 2 * y; });
  EXPECT_NEAR(linear.at(0.3, 0.7), 0.3 - 1.4, 1e-9);
}

TEST(DepthField, givesTheDerivativesOfItsWeights) {
  const DepthField field = test::roomField();
  const double x = 0.413, y = 0.777, h = 1e-6;
  const FieldWeights w = field.weights(x, y);
  const auto [by_x, by_y] = field.slopeAt(w);
  EXPECT_NEAR(by_x, (field.at(x + h, y) - field.at(x - h, y)) / (2 * h), 1e-9);
  EXPECT_NEAR(by_y, (field.at(x, y + h) - field.at(x, y - h)) / (2 * h), 1e-9);
}

TEST(DepthField, inverseUndoesIt) {
  const DepthField field = test::roomField();
  for (const double z : {0.6, 1.7, 4.9}) {
    const double bent = field.inverse().corrected(z, 0.3, 0.8);
    EXPECT_NE(bent, z);
    EXPECT_NEAR(field.corrected(bent, 0.3, 0.8), z, 1e-12);
  }
  EXPECT_EQ(field.corrected(0, 0.3, 0.8), 0);
}

TEST(DepthField, oneAfterAnotherIsTheirComposition) {
  const DepthField a = test::roomField(), b = test::roomField().inverse().then(DepthField());
  const DepthField both = a.then(b);
  for (int i = 0; i < 12; ++i) {
    const double x = i / 11.0, z = 3.1;  // on nodes of a
    EXPECT_NEAR(both.corrected(z, x, 0.5), b.corrected(a.corrected(z, x, 0.5), x, 0.5), 1e-12);
  }
  EXPECT_NEAR(a.then(a.inverse()).rms(), 0, 1e-15);
}

TEST(DepthField, centredHasNoMean) {
  const DepthField field =
      test::roomField().then(DepthField(12, 9, std::vector<double>(108, 0.002)));
  EXPECT_NEAR(field.centred().mean(), 0, 1e-18);
  EXPECT_NEAR(compare(field, field.centred()).rms_difference, 0, 1e-15);
  EXPECT_NEAR(compare(field, field.inverse()).correlation, -1, 1e-12);
}

TEST(DepthField, anotherGridIsTakenByItsNext) {
  const DepthField coarse = test::roomField();
  const DepthField fine = fittedField(49, 37, [&](double x, double y) { return coarse.at(x, y); });
  const DepthField both = fine.then(coarse);
  EXPECT_EQ(both.columns(), coarse.columns());
  EXPECT_LT(compare(both, coarse.then(coarse)).rms_difference, 0.01 * coarse.rms());
}

TEST(DepthField, refusesWhatIsNoGrid) {
  EXPECT_THROW(DepthField(3, 9), std::invalid_argument);
  EXPECT_THROW(DepthField(4, 4, std::vector<double>(15)), std::invalid_argument);
  EXPECT_THROW(flat(std::nan("")), std::invalid_argument);
}

TEST(DepthCorrection, correctsEachPixelByTheField) {
  const DepthField field = test::roomField();
  const cv::Size size(64, 48);
  const DepthCorrection table(field, size);
  cv::Mat metres(size, CV_32FC1), units(size, CV_16UC1), out;
  for (int i = 0; i < size.area(); ++i) {
    metres.at<float>(i / 64, i % 64) = 0.5F + 0.0014F * static_cast<float>(i);
    units.at<std::uint16_t>(i / 64, i % 64) = static_cast<std::uint16_t>(2500 + 7 * i);
  }
  const auto wanted = [&](double z, int i) {
    return field.corrected(z, (i % 64 + 0.5) / 64, (i / 64 + 0.5) / 48);
  };
  table.apply(metres, 0, out);
  ASSERT_EQ(out.type(), CV_32FC1);
  for (int i = 0; i < size.area(); ++i) {
    EXPECT_NEAR(out.at<float>(i / 64, i % 64), wanted(metres.at<float>(i / 64, i % 64), i), 1e-5);
  }
  table.apply(units, 0.0002, out);
  ASSERT_EQ(out.type(), CV_16UC1);
  for (int i = 0; i < size.area(); ++i) {
    const double z = 0.0002 * units.at<std::uint16_t>(i / 64, i % 64);
    EXPECT_NEAR(0.0002 * out.at<std::uint16_t>(i / 64, i % 64), wanted(z, i), 0.000102);
  }
}

TEST(DepthCorrection, whatIsNoDepthStaysNone) {
  const float infinite = std::numeric_limits<float>::infinity();
  const cv::Mat metres = (cv::Mat_<float>(2, 3) << 0, -1, std::nanf(""), infinite, 1e30F, 400.0F);
  cv::Mat out;
  DepthCorrection(flat(-0.003), {3, 2}).apply(metres, 0, out);
  EXPECT_EQ(cv::countNonZero(out), 0) << "beyond 1/0.003 m there is nothing: " << out;
  const cv::Mat units = (cv::Mat_<std::uint16_t>(2, 2) << 0, 1000, 60000, 65535);
  DepthCorrection(flat(-0.003), {2, 2}).apply(units, 0.001, out);
  EXPECT_EQ(out.at<std::uint16_t>(0, 0), 0);
  EXPECT_EQ(out.at<std::uint16_t>(0, 1), 1003);
  EXPECT_EQ(out.at<std::uint16_t>(1, 0), 0) << "73 m does not fit";
  EXPECT_THROW(DepthCorrection(DepthField(), {3, 3}).apply(units, 0.001, out),
               std::invalid_argument);
}

TEST(DepthCorrection, noFieldChangesNothing) {
  cv::Mat depth(48, 64, CV_16UC1), out;
  cv::randu(depth, 0, 65535);
  DepthCorrection(DepthField(), depth.size()).apply(depth, 0.001, out);
  EXPECT_EQ(cv::norm(depth, out, cv::NORM_INF), 0);
}

TEST(DepthCorrection, isTheSameForAllSizesOfAnImage) {
  const DepthField field = test::roomField();
  cv::Mat large(480, 640, CV_32FC1, cv::Scalar(3.0)), small(240, 320, CV_32FC1, cv::Scalar(3.0));
  cv::Mat of_large, of_small, shrunk;
  DepthCorrection(field, large.size()).apply(large, 0, of_large);
  DepthCorrection(field, small.size()).apply(small, 0, of_small);
  cv::resize(of_large, shrunk, small.size(), 0, 0, cv::INTER_AREA);
  EXPECT_LT(cv::norm(shrunk, of_small, cv::NORM_INF), 2e-4);
}

TEST(DepthCorrector, leavesItsInputAloneAndGivesMetresUnrounded) {
  const cv::Mat depth(48, 64, CV_16UC1, cv::Scalar(4000));
  const cv::Mat before = depth.clone();
  DepthCorrector corrector(test::roomField());
  const cv::Mat same = corrector.likeInput(depth, 1e-3), metres = corrector.inMetres(depth, 1e-3);
  EXPECT_EQ(cv::norm(before, depth, cv::NORM_INF), 0);
  EXPECT_GT(cv::norm(before, same, cv::NORM_INF), 10);
  cv::Mat rounded;
  same.convertTo(rounded, CV_32F, 1e-3);
  EXPECT_LT(cv::norm(rounded, metres, cv::NORM_INF), 0.00051);
  EXPECT_NEAR(metres.at<float>(5, 10), test::roomField().corrected(4.0, 10.5 / 64, 5.5 / 48), 1e-5);
  EXPECT_TRUE(corrector.inMetres(cv::Mat(), 1e-3).empty());
}

}  // namespace
}  // namespace pf
