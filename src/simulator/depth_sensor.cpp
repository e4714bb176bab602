// SPDX-License-Identifier: BSD-3-Clause
#include "simulator/depth_sensor.hpp"

#include <algorithm>
#include <cmath>
#include <vector>

#include "posefusion/core/parallel.hpp"
#include "simulator/depth_distortion.hpp"
#include "simulator/random.hpp"

namespace pf::simulator {
namespace {

constexpr double kSteepest_rad = 1.53;

/// Standard deviation (m) of a Kinect 1 at z (m), seen straight on: Nguyen, Izadi and Lovell 2012,
/// equation (3) without its angular term. What is simulated; what the chain believes is its own.
constexpr float depthSigma(float z_m) { return 0.0012F + 0.0019F * (z_m - 0.4F) * (z_m - 0.4F); }
/// The pattern is matched in windows: errors of neighbours hang together over so many pixels.
constexpr int kWindow_px = 4;

/// Random numbers that neighbours share, drawn once for a row.
class RowLuck {
 public:
  RowLuck(int row, int width, std::uint32_t key) : key_(key), row_(row) {
    const auto draw = [](int count, std::vector<float>& out, auto&& seed) {
      for (int i = 0; i < count; ++i) {
        out.push_back(gaussian(seed(static_cast<std::uint32_t>(i))));
      }
    };
    const auto window = static_cast<std::uint32_t>(row / kWindow_px);
    const auto block = static_cast<std::uint32_t>(row) / 2U;
    draw(width / kWindow_px + 2, above_, [&](auto i) { return hash(key, i, window); });
    draw(width / kWindow_px + 2, below_, [&](auto i) { return hash(key, i, window + 1U); });
    draw(width / 2 + 1, across_, [&](auto i) { return hash(key, i, block); });
    draw(width / 2 + 1, along_, [&](auto i) { return hash(hash(key, i, block), 1U); });
  }

  /// Smooth noise of unit variance over windows, plus the pixel's own.
  float correlated(int col) const {
    const float x = static_cast<float>(col) / kWindow_px, y = static_cast<float>(row_) / kWindow_px;
    const auto ix = static_cast<std::size_t>(x);
    const float tx = x - std::floor(x), ty = y - std::floor(y);
    const float w[4] = {(1 - tx) * (1 - ty), tx * (1 - ty), (1 - tx) * ty, tx * ty};
    const float sum =
        w[0] * above_[ix] + w[1] * above_[ix + 1] + w[2] * below_[ix] + w[3] * below_[ix + 1];
    const float norm = std::sqrt(w[0] * w[0] + w[1] * w[1] + w[2] * w[2] + w[3] * w[3]);
    const float own = gaussian(
        hash(key_, 0x51U, static_cast<std::uint32_t>(row_), static_cast<std::uint32_t>(col)));
    return 0.8F * sum / norm + 0.6F * own;
  }

  /// Standard normal, for blocks of 2x2 pixels.
  float across(int col) const { return across_[static_cast<std::size_t>(col) / 2]; }
  float along(int col) const { return along_[static_cast<std::size_t>(col) / 2]; }

 private:
  std::uint32_t key_;
  int row_;
  std::vector<float> above_, below_, across_, along_;
};

/// What the noise needs to know of an angle between view and surface.
struct Slant {
  float theta_rad, lateral_px, tilt;
};

float tiltOf(double theta_rad) {
  const double theta = std::min(theta_rad, kSteepest_rad);
  return static_cast<float>(0.0001 * theta * theta / ((M_PI_2 - theta) * (M_PI_2 - theta)));
}

/// The slant of a surface by the cosine of its angle, from a table: there is one for each pixel.
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

int rounded(float x) { return static_cast<int>(x < 0.0F ? x - 0.5F : x + 0.5F); }

/// Chance that the pattern is not found: too dark, seen too flat, or mirrored away.
float dropoutChance(float z, float cosine, float theta, float infrared, float gloss) {
  const float signal = infrared * std::sqrt(cosine) / (0.25F + 0.11F * z * z);
  const float margin = (signal - 0.055F) / 0.011F;
  float lost = margin < 15.0F ? 1.0F / (1.0F + std::exp(margin)) : 0.0F;
  lost = std::max(lost, std::clamp((theta - 1.36F) / 0.12F, 0.0F, 1.0F));
  if (gloss > 0.2F) {
    // Seen head on the reflection blinds, seen flat nothing comes back.
    const float blinding = std::exp(-theta * theta / 0.006F);
    lost = std::max(lost, gloss * std::max(blinding, std::clamp(theta - 0.7F, 0.0F, 1.0F)));
  }
  return lost;
}

/// Marks what the projector, the baseline to the right, does not see. In its picture near things
/// lie further left: going left, whatever lies right of what was already met is covered by it.
void markShadow(const DepthView& view, const PinholeCamera& camera, const DepthConfig& config,
                int row, std::vector<char>& shadow) {
  const float* depth = view.depth_m.ptr<float>(row);
  const auto fb = static_cast<float>(camera.fx * config.baseline_m);
  float covered = 1e9F;
  for (int col = camera.width - 1; col >= 0; --col) {
    if (depth[col] <= 0.0F) continue;
    const float place = static_cast<float>(col) - fb / depth[col];
    shadow[static_cast<std::size_t>(col)] = place > covered + 0.8F ? 1 : 0;
    covered = std::min(covered, place);
  }
}

struct Source {
  int col, row;
};

/// Where the pixel's depth comes from: lateral noise takes it from a neighbour.
Source displaced(const DepthView& view, const DepthConfig& config, int col, int row,
                 const RowLuck& luck) {
  const float sigma = 0.7F * static_cast<float>(config.lateral) *
                      slantOf(view.cosine.at<float>(row, col)).lateral_px;
  return {std::clamp(col + rounded(sigma * luck.across(col)), 0, view.depth_m.cols - 1),
          std::clamp(row + rounded(sigma * luck.along(col)), 0, view.depth_m.rows - 1)};
}

}  // namespace

double axialSigmaM(double z_m, double theta_rad) {
  return depthSigma(static_cast<float>(z_m)) + tiltOf(theta_rad) / std::sqrt(std::max(z_m, 0.1));
}

double lateralSigmaPx(double theta_rad) { return 0.8 + 0.035 * theta_rad / (M_PI_2 - theta_rad); }

double quantumM(double z_m, const DepthConfig& config, double focal_px) {
  return z_m * z_m / (focal_px * config.baseline_m * config.disparity_steps);
}

namespace {

/// One frame's constants for the pixels.
struct Sensing {
  const DepthView& view;
  const DepthConfig& config;
  std::uint32_t key;
  float fb_steps;  ///< focal length x baseline, in steps of disparity
  Distortion distortion;
};

/// The depth (m) reported at (col, row) for what is at `s`; 0: none.
float reported(const Sensing& f, const Source& s, int col, int row, const RowLuck& noise) {
  const float z = f.view.depth_m.at<float>(s.row, s.col);
  if (z <= 0.0F || !f.config.noise) return z;
  const float cosine = f.view.cosine.at<float>(s.row, s.col);
  const Slant& slant = slantOf(cosine);
  // Dropouts come as specks of a few pixels rather than single ones.
  const std::uint32_t speck = hash(f.key, 0x77U, static_cast<std::uint32_t>(row) / 3U,
                                   static_cast<std::uint32_t>(col) / 3U);
  const std::uint32_t own = hash(speck, static_cast<std::uint32_t>(col % 3 * 3 + row % 3));
  const float luck = 0.6F * uniform(speck) + 0.4F * uniform(own);
  const float lost =
      dropoutChance(z, cosine, slant.theta_rad, f.view.infrared.at<float>(s.row, s.col),
                    f.view.gloss.at<float>(s.row, s.col));
  if (luck < static_cast<float>(f.config.dropouts) * lost) return 0.0F;
  const float sigma = static_cast<float>(f.config.axial) *
                      (depthSigma(z) + slant.tilt / std::sqrt(std::max(z, 0.1F)));
  const float bent = z * (1.0F + 0.5F * z * f.distortion.at(col, row));
  const float seen = std::max(bent + sigma * noise.correlated(col), 0.05F);
  return f.fb_steps / static_cast<float>(std::max(1, rounded(f.fb_steps / seen)));
}

}  // namespace

void senseDepth(const DepthView& view, const PinholeCamera& camera, const DepthConfig& config,
                std::uint32_t key, cv::Mat& depth_mm, cv::Mat& mask) {
  depth_mm.create(view.depth_m.size(), CV_16UC1);
  mask.create(view.depth_m.size(), CV_8UC1);
  const Sensing frame{view, config, key,
                      static_cast<float>(camera.fx * config.baseline_m * config.disparity_steps),
                      Distortion(config, camera)};
  const int shift = static_cast<int>(std::lround(config.misregistration_px));
  parallelFor(static_cast<std::size_t>(camera.height), 4, [&](std::size_t begin, std::size_t end) {
    std::vector<char> shadow;
    for (int row = static_cast<int>(begin); row < static_cast<int>(end); ++row) {
      shadow.assign(static_cast<std::size_t>(camera.width), 0);
      if (config.noise && config.shadow) markShadow(view, camera, config, row, shadow);
      const RowLuck luck(row, camera.width, key);
      for (int col = 0; col < camera.width; ++col) {
        const int from = std::clamp(col - shift, 0, camera.width - 1);
        const Source s =
            config.noise ? displaced(view, config, from, row, luck) : Source{from, row};
        const float z =
            shadow[static_cast<std::size_t>(from)] != 0 ? 0.0F : reported(frame, s, col, row, luck);
        const bool seen = z > 0.0F && z >= config.min_m && z <= config.max_m;
        mask.at<std::uint8_t>(row, col) = view.person.at<std::uint8_t>(s.row, s.col);
        depth_mm.at<std::uint16_t>(row, col) =
            seen ? static_cast<std::uint16_t>(rounded(1000.0F * z)) : 0;
      }
    }
  });
}

}  // namespace pf::simulator
