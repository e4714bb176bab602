// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <random>

#include "posefusion/core/se3.hpp"

namespace pf {

inline constexpr std::int64_t kMs = 1'000'000;  ///< ns

/// Each part of the twist (m, rad) at most `size`.
inline Eigen::Isometry3d randomPose(std::mt19937& random, double size = 1.0) {
  std::uniform_real_distribution<double> unit(-size, size);
  Vector6d twist;
  for (int i = 0; i < 6; ++i) twist[i] = unit(random);
  return expSe3(twist);
}

}  // namespace pf
