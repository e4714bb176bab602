// SPDX-License-Identifier: BSD-3-Clause
#include <algorithm>
#include <cmath>

#include "simulator/depth_distortion.hpp"
#include "simulator/depth_kind.hpp"
#include "simulator/depth_luck.hpp"
#include "simulator/depth_noise.hpp"

namespace pf::simulator {
namespace {

/// A matt white wall, which a signal of 1 comes back from at 1 m.
constexpr float kWhite = 0.7F;
/// Of a white wall at 1 m: about 1 mm for the Kinect for Xbox One, 4 mm at 4 m (Sarbolandi, Lefloch
/// and Kolb, "Kinect range sensing: Structured-light versus Time-of-Flight Kinect", 2015).
constexpr float kSigma_m = 0.001F;
/// Photons of the surroundings, as a signal: noise that what comes back has to stand out of.
constexpr float kAmbient = 0.05F;
/// A signal that gives half of the error by brightness, and one that is too weak for any depth: a
/// floor that is seen flat ends at 4 to 5 m, black cloth at about 2 m.
constexpr float kDark = 0.05F, kTooWeak = 0.005F, kTooWeakBand = 0.0008F;
/// The modulation is no pure sine: its third and fifth harmonic look like an error with four
/// periods in half a wavelength (80 MHz: 1.87 m).
constexpr float kWiggle_m = 0.468F;
/// Neighbours that differ by more of their depth are not one surface.
constexpr float kJump = 0.03F;

class TimeOfFlight : public DepthKind {
 public:
  explicit TimeOfFlight(const DepthShot& shot)
      : shot_(shot), distortion_(shot.config, shot.camera, shot.time_s) {}

  void sense(int row, float* depth_m, std::uint8_t* label) const override {
    for (int col = 0; col < shot_.camera.width; ++col) {
      const int from = registeredFrom(shot_, col);
      depth_m[col] = reported(row, from, col);
      label[col] = shot_.view.label.at<std::uint8_t>(row, from);
    }
  }

 private:
  /// Light that comes back of what is sent out.
  float signalAt(int row, int col) const {
    const float z = shot_.view.depth_m.at<float>(row, col);
    if (z <= 0.0F) return 0.0F;
    return shot_.view.infrared.at<float>(row, col) / kWhite *
           shot_.view.cosine.at<float>(row, col) / (z * z);
  }

  /// At a rim a pixel sees two surfaces, and its phase is one in between: by their parts of the
  /// pixel, and by how bright they are.
  float mixed(int row, int col, std::uint32_t key) const {
    const cv::Mat& depth = shot_.view.depth_m;
    const float z = depth.at<float>(row, col);
    int other_row = row, other_col = col;
    for (const auto& [dr, dc] : {std::pair(-1, 0), {1, 0}, {0, -1}, {0, 1}}) {
      const int r = row + dr, c = col + dc;
      if (r < 0 || c < 0 || r >= depth.rows || c >= depth.cols) continue;
      const float there = depth.at<float>(r, c);
      if (there > 0.0F && std::abs(there - z) > std::abs(depth.at<float>(other_row, other_col) - z))
        other_row = r, other_col = c;
    }
    const float other = depth.at<float>(other_row, other_col);
    if (std::abs(other - z) < kJump * z) return z;
    const float luck = uniform(key), part = luck * luck;
    const float own = (1.0F - part) * signalAt(row, col);
    const float its = part * signalAt(other_row, other_col);
    return own + its > 0.0F ? (own * z + its * other) / (own + its) : z;
  }

  float reported(int row, int from, int col) const {
    const DepthConfig& config = shot_.config;
    const float signal = signalAt(row, from);
    if (signal <= 0.0F) return 0.0F;
    const float theta = slantOf(shot_.view.cosine.at<float>(row, from)).theta_rad;
    const float weak = 1.0F / (1.0F + std::exp((signal - kTooWeak) / kTooWeakBand));
    const float lost = std::max(weak, glareChance(theta, shot_.view.gloss.at<float>(row, from)));
    if (speckLuck(shot_.key, row, col) < static_cast<float>(config.dropouts) * lost) return 0.0F;
    const auto r = static_cast<std::uint32_t>(row), c = static_cast<std::uint32_t>(col);
    const float z = mixed(row, from, hash(shot_.key, 0x62U, r, c));
    const float sigma = static_cast<float>(config.axial) * kSigma_m * std::sqrt(signal + kAmbient) /
                        (signal * std::sqrt(1.0F + kAmbient));
    const float by_brightness =
        0.001F * static_cast<float>(config.tof_brightness_mm) * kDark / (kDark + signal);
    const float wiggle =
        0.001F * static_cast<float>(config.tof_wiggling_mm) * std::sin(6.2832F * z / kWiggle_m);
    return distortion_.bent(col, row, z) + by_brightness + wiggle +
           sigma * gaussian(hash(shot_.key, 0x61U, r, c));
  }

  DepthShot shot_;
  Distortion distortion_;
};

}  // namespace

std::unique_ptr<DepthKind> makeTimeOfFlight(const DepthShot& shot) {
  return std::make_unique<TimeOfFlight>(shot);
}

}  // namespace pf::simulator
