// SPDX-License-Identifier: BSD-3-Clause
#include "simulator/depth_distortion.hpp"

#include <cmath>

#include "simulator/random.hpp"

namespace pf::simulator {
namespace {

constexpr float kUsual = 0.010F;

}  // namespace

Distortion::Distortion(const DepthConfig& config, const PinholeCamera& camera) {
  const auto phase = [&](std::uint32_t i) {
    return 6.2832F * uniform(hash(static_cast<std::uint32_t>(config.specimen), i));
  };
  const float height = kUsual * static_cast<float>(config.distortion);
  for (int col = 0; col < camera.width; ++col) {
    const float u = 6.2832F * static_cast<float>(col) / static_cast<float>(camera.width);
    wide_.push_back(height * std::sin(0.7F * u + phase(1U)));
    narrow_.push_back(0.6F * height * std::sin(1.9F * u + phase(2U)));
  }
  for (int row = 0; row < camera.height; ++row) {
    const float v = 4.7F * static_cast<float>(row) / static_cast<float>(camera.height);
    tall_.push_back(std::cos(0.8F * v + phase(3U)));
    low_.push_back(std::cos(2.1F * v + phase(4U)));
  }
}

DepthField trueField(const DepthConfig& config, const PinholeCamera& camera) {
  constexpr int kColumns = 49, kRows = 37;
  constexpr double kAt_m = 2.5;
  if (!config.noise) return {kColumns, kRows};
  const Distortion distortion(config, camera);
  return fittedField(kColumns, kRows, [&](double x, double y) {
    const auto col = static_cast<int>(std::lround(x * (camera.width - 1)));
    const auto row = static_cast<int>(std::lround(y * (camera.height - 1)));
    const double half = 0.5 * static_cast<double>(distortion.at(col, row));
    return half / (1.0 + kAt_m * half);
  });
}

}  // namespace pf::simulator
