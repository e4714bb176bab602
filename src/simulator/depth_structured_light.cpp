// SPDX-License-Identifier: BSD-3-Clause
#include <algorithm>
#include <cmath>
#include <vector>

#include "simulator/depth_distortion.hpp"
#include "simulator/depth_kind.hpp"
#include "simulator/depth_luck.hpp"
#include "simulator/depth_noise.hpp"

namespace pf::simulator {
namespace {

int rounded(float x) { return static_cast<int>(x < 0.0F ? x - 0.5F : x + 0.5F); }

/// Chance that the pattern is not found: too dark, seen too flat, or mirrored away.
float dropoutChance(float z, float cosine, float theta, float infrared, float gloss) {
  const float signal = infrared * std::sqrt(cosine) / (0.25F + 0.11F * z * z);
  const float margin = (signal - 0.055F) / 0.011F;
  float lost = margin < 15.0F ? 1.0F / (1.0F + std::exp(margin)) : 0.0F;
  lost = std::max(lost, std::clamp((theta - 1.36F) / 0.12F, 0.0F, 1.0F));
  return std::max(lost, glareChance(theta, gloss));
}

struct Source {
  int col, row;
};

class StructuredLight : public DepthKind {
 public:
  explicit StructuredLight(const DepthShot& shot)
      : shot_(shot),
        fb_steps_(static_cast<float>(shot.camera.fx * shot.config.baseline_m *
                                     shot.config.disparity_steps)),
        distortion_(shot.config, shot.camera, shot.time_s) {}

  void sense(int row, float* depth_m, std::uint8_t* label) const override {
    const DepthConfig& config = shot_.config;
    std::vector<char> shadow(static_cast<std::size_t>(shot_.camera.width), 0);
    if (config.noise && config.shadow) markShadow(shot_, row, shadow);
    const RowLuck luck(row, shot_.camera.width, shot_.key);
    for (int col = 0; col < shot_.camera.width; ++col) {
      const int from = registeredFrom(shot_, col);
      const Source s = config.noise ? displaced(from, row, luck) : Source{from, row};
      depth_m[col] =
          shadow[static_cast<std::size_t>(from)] != 0 ? 0.0F : reported(s, col, row, luck);
      label[col] = shot_.view.label.at<std::uint8_t>(s.row, s.col);
    }
  }

 private:
  /// Where the pixel's depth comes from: lateral noise takes it from a neighbour.
  Source displaced(int col, int row, const RowLuck& luck) const {
    const DepthView& view = shot_.view;
    const float sigma = 0.7F * static_cast<float>(shot_.config.lateral) *
                        slantOf(view.cosine.at<float>(row, col)).lateral_px;
    return {std::clamp(col + rounded(sigma * luck.across(col)), 0, view.depth_m.cols - 1),
            std::clamp(row + rounded(sigma * luck.along(col)), 0, view.depth_m.rows - 1)};
  }

  /// The depth (m) reported at (col, row) for what is at `s`; 0: none.
  float reported(const Source& s, int col, int row, const RowLuck& noise) const {
    const DepthConfig& config = shot_.config;
    const float z = shot_.view.depth_m.at<float>(s.row, s.col);
    if (z <= 0.0F || !config.noise) return z;
    const float cosine = shot_.view.cosine.at<float>(s.row, s.col);
    const Slant& slant = slantOf(cosine);
    const float lost =
        dropoutChance(z, cosine, slant.theta_rad, shot_.view.infrared.at<float>(s.row, s.col),
                      shot_.view.gloss.at<float>(s.row, s.col));
    if (speckLuck(shot_.key, row, col) < static_cast<float>(config.dropouts) * lost) return 0.0F;
    const float sigma = static_cast<float>(config.axial) *
                        (headOnSigma(z) + slant.tilt / std::sqrt(std::max(z, 0.1F)));
    const float bent = distortion_.bent(col, row, z);
    const float seen = std::max(bent + sigma * noise.correlated(col), 0.05F);
    return fb_steps_ / static_cast<float>(std::max(1, rounded(fb_steps_ / seen)));
  }

  DepthShot shot_;
  float fb_steps_;  ///< focal length x baseline, in steps of disparity
  Distortion distortion_;
};

}  // namespace

std::unique_ptr<DepthKind> makeStructuredLight(const DepthShot& shot) {
  return std::make_unique<StructuredLight>(shot);
}

}  // namespace pf::simulator
