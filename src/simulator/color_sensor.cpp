// SPDX-License-Identifier: BSD-3-Clause
#include "simulator/color_sensor.hpp"

#include <algorithm>
#include <cmath>
#include <opencv2/imgcodecs.hpp>
#include <opencv2/imgproc.hpp>

#include "posefusion/core/parallel.hpp"
#include "simulator/random.hpp"
#include "simulator/texture.hpp"

namespace pf::simulator {
namespace {

constexpr int kToneSteps = 4096;
/// Signal (1 = white) of radiance 1 in 1 ms at gain 1.
constexpr double kSensitivity = 0.11;
constexpr float kPhotonNoise = 1.1e-4F;  // variance of signal 1 at gain 1
constexpr float kReadNoise = 1.8e-3F;
constexpr int kWaitFrames = 4;

/// Photographic curve: sRGB with a shoulder that keeps highlights from clipping hard.
std::vector<std::uint8_t> makeToneTable() {
  std::vector<std::uint8_t> table(kToneSteps);
  for (int i = 0; i < kToneSteps; ++i) {
    const double x = 1.6 * i / (kToneSteps - 1);
    const double y = x < 0.6 ? x : 0.6 + 0.4 * (1.0 - std::exp(-(x - 0.6) / 0.4));
    table[static_cast<std::size_t>(i)] = srgbOf(static_cast<float>(1.02 * y - 0.004));
  }
  return table;
}

void throughJpeg(int quality, cv::Mat& picture) {
  std::vector<std::uint8_t> bytes;
  cv::Mat bgr;
  cv::cvtColor(picture, bgr, cv::COLOR_RGB2BGR);
  cv::imencode(".jpg", bgr, bytes, {cv::IMWRITE_JPEG_QUALITY, quality});
  cv::cvtColor(cv::imdecode(bytes, cv::IMREAD_COLOR), picture, cv::COLOR_BGR2RGB);
}

}  // namespace

Exposure AutoExposure::current() const {
  if (!config_.auto_exposure) return {config_.exposure_ms, config_.gain};
  const double product = product_ms_ > 0.0 ? product_ms_ : config_.exposure_ms * config_.gain;
  const double time = std::clamp(product, 1.0, config_.max_exposure_ms);
  return {time, std::clamp(product / time, 1.0, 12.0)};
}

void AutoExposure::look(const cv::Mat& radiance) {
  if (!config_.auto_exposure) return;
  // Highlights count as white, no more.
  const double white = product_ms_ > 0.0 ? 1.2 / (kSensitivity * product_ms_) : 3.0;
  double sum = 0.0;
  int count = 0;
  for (int row = 0; row < radiance.rows; row += 4) {
    const auto* line = radiance.ptr<cv::Vec3f>(row);
    for (int col = 0; col < radiance.cols; col += 4, ++count) {
      sum += std::min<double>(0.3 * line[col][0] + 0.6 * line[col][1] + 0.1 * line[col][2], white);
    }
  }
  const double mean = std::max(sum / count, 1e-4);
  const double wanted = std::clamp(config_.brightness / (kSensitivity * mean), 1.0, 300.0);
  if (product_ms_ <= 0.0) {
    product_ms_ = wanted;
    return;
  }
  if (wait_ > 0) {
    --wait_;
    return;
  }
  const double error = std::log2(wanted / product_ms_);
  if (std::abs(error) < 0.22) return;
  product_ms_ *= std::exp2(std::clamp(error, -0.25, 0.25));
  wait_ = kWaitFrames;
}

ColorSensor::ColorSensor(const ColorConfig& config) : config_(config), tone_(makeToneTable()) {}

void ColorSensor::expose(const cv::Mat& radiance, const Exposure& exposure, std::uint32_t key,
                         cv::Mat& picture) {
  if (config_.blur_px > 0.0) {
    cv::GaussianBlur(radiance, soft_, {3, 3}, config_.blur_px);
  } else {
    radiance.copyTo(soft_);
  }
  picture.create(radiance.size(), CV_8UC3);
  const auto gain = static_cast<float>(exposure.gain), noise = static_cast<float>(config_.noise);
  const auto scale = static_cast<float>(kSensitivity * exposure.time_ms * exposure.gain);
  const float cx = 0.5F * static_cast<float>(radiance.cols),
              cy = 0.5F * static_cast<float>(radiance.rows);
  const float corner = cx * cx + cy * cy;
  const float photons = kPhotonNoise * gain * noise * noise;
  const float read = std::pow(kReadNoise * gain * noise, 2.0F);
  const float balance[3] = {0.98F, 1.0F, 1.06F};
  parallelFor(static_cast<std::size_t>(radiance.rows), 8, [&](std::size_t begin, std::size_t end) {
    for (std::size_t r = begin; r < end; ++r) {
      const int row = static_cast<int>(r);
      const auto* in = soft_.ptr<float>(row);
      auto* out = picture.ptr<std::uint8_t>(row);
      const float dy = static_cast<float>(row) - cy;
      for (int col = 0; col < radiance.cols; ++col) {
        const float dx = static_cast<float>(col) - cx;
        const float r2 = (dx * dx + dy * dy) / corner;
        const float lens =
            scale * (1.0F - static_cast<float>(config_.vignette) * r2 * (1.3F - 0.3F * r2));
        const std::uint32_t pixel =
            hash(key, static_cast<std::uint32_t>(row * radiance.cols + col));
        for (int c = 0; c < 3; ++c) {
          const float signal = in[3 * col + c] * lens * balance[c];
          const float grain = gaussian(pixel * (2U * static_cast<std::uint32_t>(c) + 0x9E3779B1U));
          const float value = signal + grain * std::sqrt(photons * std::max(signal, 0.0F) + read);
          const int step = static_cast<int>(value * (kToneSteps - 1) / 1.6F);
          out[3 * col + c] = tone_[static_cast<std::size_t>(std::clamp(step, 0, kToneSteps - 1))];
        }
      }
    }
  });
  if (config_.jpeg_quality > 0) throughJpeg(config_.jpeg_quality, picture);
}

}  // namespace pf::simulator
