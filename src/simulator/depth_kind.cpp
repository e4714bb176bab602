// SPDX-License-Identifier: BSD-3-Clause
#include "simulator/depth_kind.hpp"

#include <algorithm>
#include <cmath>

namespace pf::simulator {

void markShadow(const DepthShot& shot, int row, std::vector<char>& shadow) {
  const float* depth = shot.view.depth_m.ptr<float>(row);
  const auto fb = static_cast<float>(shot.camera.fx * shot.config.baseline_m);
  float covered = 1e9F;
  for (int col = shot.camera.width - 1; col >= 0; --col) {
    if (depth[col] <= 0.0F) continue;
    const float place = static_cast<float>(col) - fb / depth[col];
    shadow[static_cast<std::size_t>(col)] = place > covered + 0.8F ? 1 : 0;
    covered = std::min(covered, place);
  }
}

float glareChance(float theta_rad, float gloss) {
  if (gloss <= 0.2F) return 0.0F;
  const float blinding = std::exp(-theta_rad * theta_rad / 0.006F);
  return gloss * std::max(blinding, std::clamp(theta_rad - 0.7F, 0.0F, 1.0F));
}

int registeredFrom(const DepthShot& shot, int col) {
  const int shift = static_cast<int>(std::lround(shot.config.misregistration_px));
  return std::clamp(col - shift, 0, shot.camera.width - 1);
}

}  // namespace pf::simulator
