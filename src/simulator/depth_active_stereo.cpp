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

/// Error of a match: sigma(z) = z^2 kSubpixel_px / (f B). A well-tuned D400 has about 0.05 to 0.1
/// pixels on a textured wall (Grunnet-Jepsen, Sweetser and Woodfill, "Best-Known-Methods for Tuning
/// Intel RealSense D400 Depth Cameras for Best Performance", 2018).
constexpr float kSubpixel_px = 0.08F;
/// Disparities come in steps of 1/32 pixel.
constexpr float kSteps = 32.0F;
/// What is matched is a window, of so many pixels to each side: it blurs rims.
constexpr int kReach_px = 2;
/// Disparities (pixels) in one window that differ by more are two surfaces.
constexpr float kRim_px = 1.5F;
constexpr float kRimLost = 0.35F;
/// Contrast (of the mean grey) that a match needs; the pattern has 1 on white at 1 m.
constexpr float kContrast = 0.03F, kContrastBand = 0.006F;

/// What a window of disparities has.
struct Window {
  float mean_px = 0.0F, range_px = 0.0F;
};

class ActiveStereo : public DepthKind {
 public:
  explicit ActiveStereo(const DepthShot& shot)
      : shot_(shot),
        fb_(static_cast<float>(shot.camera.fx * shot.config.baseline_m)),
        distortion_(shot.config, shot.camera, shot.time_s) {}

  void sense(int row, float* depth_m, std::uint8_t* label) const override {
    std::vector<char> hidden(static_cast<std::size_t>(shot_.camera.width), 0);
    if (shot_.config.shadow) markShadow(shot_, row, hidden);
    const RowLuck luck(row, shot_.camera.width, shot_.key);
    for (int col = 0; col < shot_.camera.width; ++col) {
      const int from = registeredFrom(shot_, col);
      depth_m[col] =
          hidden[static_cast<std::size_t>(from)] != 0 ? 0.0F : reported(row, from, col, luck);
      label[col] = shot_.view.label.at<std::uint8_t>(row, from);
    }
  }

 private:
  Window windowAt(int row, int col) const {
    const cv::Mat& depth = shot_.view.depth_m;
    float sum = 0.0F, least = 1e9F, most = 0.0F;
    int count = 0;
    for (int r = std::max(0, row - kReach_px); r <= std::min(depth.rows - 1, row + kReach_px);
         ++r) {
      const float* line = depth.ptr<float>(r);
      const int last = std::min(depth.cols - 1, col + kReach_px);
      for (int c = std::max(0, col - kReach_px); c <= last; ++c) {
        if (line[c] <= 0.0F) continue;
        const float disparity = fb_ / line[c];
        sum += disparity;
        least = std::min(least, disparity);
        most = std::max(most, disparity);
        ++count;
      }
    }
    return {sum / static_cast<float>(std::max(1, count)), count > 0 ? most - least : 0.0F};
  }

  /// Contrast of the surface's own texture and of the pattern on it.
  float contrastAt(int row, int col, float z, float cosine) const {
    const float pattern = static_cast<float>(shot_.config.stereo_projector) *
                          shot_.view.infrared.at<float>(row, col) * cosine / (z * z);
    return pattern + (shot_.view.contrast.empty() ? 0.0F : shot_.view.contrast.at<float>(row, col));
  }

  float lostChance(int row, int col, float z, const Window& window) const {
    const float cosine = shot_.view.cosine.at<float>(row, col);
    const float margin = (contrastAt(row, col, z, cosine) - kContrast) / kContrastBand;
    const float flat = margin < 15.0F ? 1.0F / (1.0F + std::exp(margin)) : 0.0F;
    const float glare =
        glareChance(slantOf(cosine).theta_rad, shot_.view.gloss.at<float>(row, col));
    return std::max({flat, glare, window.range_px > kRim_px ? kRimLost : 0.0F});
  }

  float reported(int row, int from, int col, const RowLuck& luck) const {
    const float z = shot_.view.depth_m.at<float>(row, from);
    // The left border of the left picture is outside of the right one.
    if (z <= 0.0F || static_cast<float>(from) < fb_ / z) return 0.0F;
    const Window window = windowAt(row, from);
    const float lost = lostChance(row, from, z, window);
    if (speckLuck(shot_.key, row, col) < static_cast<float>(shot_.config.dropouts) * lost)
      return 0.0F;
    const float bent = fb_ / distortion_.bent(col, row, fb_ / window.mean_px);
    const float noise =
        static_cast<float>(shot_.config.axial) * kSubpixel_px * luck.correlated(col);
    const float steps = std::max(1.0F, std::round(kSteps * (bent + noise)));
    return fb_ * kSteps / steps;
  }

  DepthShot shot_;
  float fb_;  ///< focal length x baseline (pixel metres)
  Distortion distortion_;
};

}  // namespace

std::unique_ptr<DepthKind> makeActiveStereo(const DepthShot& shot) {
  return std::make_unique<ActiveStereo>(shot);
}

}  // namespace pf::simulator
