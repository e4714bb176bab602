// SPDX-License-Identifier: BSD-3-Clause
#include "simulator/depth_distortion.hpp"

#include <cmath>

#include "simulator/random.hpp"

namespace pf::simulator {
namespace {

constexpr float kUsual = 0.010F;
/// Millimetres at 2 m as what is added to z, divided by z^2 (1/m).
constexpr float kPerMm = 0.001F / 4.0F;

}  // namespace

Distortion::Distortion(const DepthConfig& config, const PinholeCamera& camera, double time_s)
    : linear_bowl_(config.bowl_power == 1),
      has_others_(config.stripe_mm != 0.0 || config.bowl_mm != 0.0 || config.drift_mm != 0.0) {
  const auto specimen = static_cast<std::uint32_t>(config.specimen);
  const auto phase = [&](std::uint32_t i) { return 6.2832F * uniform(hash(specimen, i)); };
  const auto cold = static_cast<float>(std::exp(-std::max(0.0, time_s) / config.drift_s));
  const float height = kUsual * static_cast<float>(config.distortion) *
                       (1.0F + 0.01F * static_cast<float>(config.drift_percent) * cold);
  cold_ = kPerMm * static_cast<float>(config.drift_mm) * cold;
  const auto bowl = kPerMm * static_cast<float>(config.bowl_mm);
  const auto half_width = 0.5F * static_cast<float>(camera.width - 1);
  const auto half_height = 0.5F * static_cast<float>(camera.height - 1);
  const float corner = half_width * half_width + half_height * half_height;
  for (int col = 0; col < camera.width; ++col) {
    const float u = 6.2832F * static_cast<float>(col) / static_cast<float>(camera.width);
    wide_.push_back(height * std::sin(0.7F * u + phase(1U)));
    narrow_.push_back(0.6F * height * std::sin(1.9F * u + phase(2U)));
    const float aside = static_cast<float>(col) - half_width;
    aside_.push_back(bowl * aside * aside / corner);
    const auto band = static_cast<std::uint32_t>(col / config.stripe_px);
    stripes_.push_back(kPerMm * static_cast<float>(config.stripe_mm) *
                       (2.0F * uniform(hash(specimen, 5U, band)) - 1.0F));
  }
  for (int row = 0; row < camera.height; ++row) {
    const float v = 4.7F * static_cast<float>(row) / static_cast<float>(camera.height);
    tall_.push_back(std::cos(0.8F * v + phase(3U)));
    low_.push_back(std::cos(2.1F * v + phase(4U)));
    const float above = static_cast<float>(row) - half_height;
    above_.push_back(bowl * above * above / corner);
  }
}

DepthField trueField(const DepthConfig& config, const PinholeCamera& camera, double time_s) {
  constexpr int kColumns = 49, kRows = 37;
  constexpr double kAt_m = 2.5;
  if (!config.noise) return {kColumns, kRows};
  const Distortion distortion(config, camera, time_s);
  return fittedField(kColumns, kRows, [&](double x, double y) {
    const auto col = static_cast<int>(std::lround(x * (camera.width - 1)));
    const auto row = static_cast<int>(std::lround(y * (camera.height - 1)));
    const auto half = static_cast<double>(distortion.smooth(col, row, static_cast<float>(kAt_m)));
    return half / (1.0 + kAt_m * half);
  });
}

}  // namespace pf::simulator
