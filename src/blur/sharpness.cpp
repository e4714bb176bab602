// SPDX-License-Identifier: BSD-3-Clause
#include "posefusion/blur/sharpness.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdlib>
#include <opencv2/imgproc.hpp>

namespace pf {
namespace {

// Grey levels are whole numbers: rounding alone has this variance.
constexpr double kRoundingVariance = 1.0 / 12.0;
// Mean square of the central difference, in units of the noise variance of the image that has the
// fine detail, from which an image has structure along an axis. Noise alone gives 1/8.
constexpr double kMinCoarseDetail = 40.0;
// Width of the image whose detail is fine: half a Kinect's. The same blur, an angle, then looks the
// same in larger pictures; in smaller ones single pixels have more noise than detail.
constexpr double kFineWidth = 320.0;
constexpr int kLeastShrink = 2;

double varianceOfLaplacian(const cv::Mat& grey) {
  cv::Mat response;
  cv::Laplacian(grey, response, CV_16S, 1);
  cv::Scalar mean, deviation;
  cv::meanStdDev(response, mean, deviation);
  return deviation[0] * deviation[0];
}

/// Variance of the noise from the median absolute response to a kernel that ignores edges and
/// slopes.
double noiseVariance(const cv::Mat& grey) {
  const cv::Mat kernel = (cv::Mat_<float>(3, 3) << 1, -2, 1, -2, 4, -2, 1, -2, 1);
  constexpr int kMaxResponse = 8 * 255;
  constexpr double kNormOfKernel = 6.0;
  constexpr double kMedianOfNormal = 0.6745;  // of |x| for x of variance 1
  cv::Mat response;
  cv::filter2D(grey, response, CV_16S, kernel);
  std::array<std::size_t, kMaxResponse + 1> count{};
  for (int row = 0; row < response.rows; ++row) {
    const auto* line = response.ptr<std::int16_t>(row);
    for (int col = 0; col < response.cols; ++col) ++count[std::abs(line[col])];
  }
  const std::size_t half = response.total() / 2;
  std::size_t below = 0;
  int bin = 0;
  while (below + count[bin] <= half) below += count[bin++];
  // Responses are whole numbers: the median lies somewhere within its bin.
  const double inside = static_cast<double>(half - below) / static_cast<double>(count[bin]);
  const double median = std::max(0.0, bin - 0.5 + inside);
  const double deviation = median / (kMedianOfNormal * kNormOfKernel);
  return std::max(kRoundingVariance, deviation * deviation);
}

cv::Mat shrunk(const cv::Mat& image, int factor) {
  cv::Mat small;
  const cv::Size size(std::max(1, image.cols / factor), std::max(1, image.rows / factor));
  cv::resize(image, small, size, 0, 0, cv::INTER_AREA);
  return small;
}

double meanSquareResponse(const cv::Mat& image, const cv::Mat& kernel) {
  cv::Mat response;
  cv::filter2D(image, response, CV_16S, kernel);
  return cv::norm(response, cv::NORM_L2SQR) / static_cast<double>(response.total());
}

}  // namespace

double scoreBlur(const cv::Mat& color) {
  cv::Mat grey;
  cv::cvtColor(color, grey, cv::COLOR_RGB2GRAY);
  return varianceOfLaplacian(grey);
}

Sharpness measureSharpness(const cv::Mat& color) {
  cv::Mat grey;
  cv::cvtColor(color, grey, cv::COLOR_RGB2GRAY);
  Sharpness result;
  result.laplacian_variance = varianceOfLaplacian(grey);
  result.dull = true;
  const int shrink = std::max(kLeastShrink, static_cast<int>(std::lround(grey.cols / kFineWidth)));
  // The mean of a block has the noise of a pixel over their number, the second difference six times
  // that.
  const double noise = noiseVariance(grey) / (shrink * shrink);
  const double fine_noise = 6.0 * noise;
  const cv::Mat small = shrunk(grey, shrink), smallest = shrunk(shrunk(small, 2), 2);
  const cv::Mat second = (cv::Mat_<float>(1, 3) << 1, -2, 1);
  const cv::Mat central = (cv::Mat_<float>(1, 3) << -1, 0, 1);
  for (const bool along_rows : {true, false}) {
    const double coarse = meanSquareResponse(smallest, along_rows ? central : cv::Mat(central.t()));
    if (coarse < kMinCoarseDetail * noise) continue;
    const double fine = meanSquareResponse(small, along_rows ? second : cv::Mat(second.t()));
    const double ratio = std::max(0.0, fine - fine_noise) / coarse;
    result.fine_detail = result.dull ? ratio : std::min(result.fine_detail, ratio);
    result.dull = false;
  }
  return result;
}

}  // namespace pf
