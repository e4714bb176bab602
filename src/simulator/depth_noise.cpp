// SPDX-License-Identifier: BSD-3-Clause
#include "simulator/depth_noise.hpp"

#include <algorithm>
#include <cmath>
#include <vector>

namespace pf::simulator {
namespace {

constexpr double kSteepest_rad = 1.53;

float tiltOf(double theta_rad) {
  const double theta = std::min(theta_rad, kSteepest_rad);
  return static_cast<float>(0.0001 * theta * theta / ((M_PI_2 - theta) * (M_PI_2 - theta)));
}

}  // namespace

double axialSigmaM(double z_m, double theta_rad) {
  return headOnSigma(static_cast<float>(z_m)) + tiltOf(theta_rad) / std::sqrt(std::max(z_m, 0.1));
}

double lateralSigmaPx(double theta_rad) { return 0.8 + 0.035 * theta_rad / (M_PI_2 - theta_rad); }

double quantumM(double z_m, const DepthConfig& config, double focal_px) {
  return z_m * z_m / (focal_px * config.baseline_m * config.disparity_steps);
}

const Slant& slantOf(float cosine) {
  constexpr int kSteps = 4096;
  static const std::vector<Slant> table = [] {
    std::vector<Slant> slants;
    for (int i = 0; i <= kSteps; ++i) {
      const double theta = std::acos(static_cast<double>(i) / kSteps);
      slants.push_back({static_cast<float>(theta),
                        static_cast<float>(lateralSigmaPx(std::min(theta, kSteepest_rad))),
                        tiltOf(theta)});
    }
    return slants;
  }();
  return table[static_cast<std::size_t>(std::clamp(cosine, 0.0F, 1.0F) * kSteps + 0.5F)];
}

}  // namespace pf::simulator
