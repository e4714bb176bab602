// SPDX-License-Identifier: BSD-3-Clause
#include "sensor.hpp"

#include <algorithm>
#include <cmath>

#include "posefusion/core/parallel.hpp"
#include "random.hpp"

namespace pf::synthetic {
namespace {

// Khoshelham and Elberink, "Accuracy and resolution of Kinect depth data", 2012: sigma_z = 1.425e-3
// z^2 and steps of 2.85e-3 z^2 (metres), that is, half a step of normalised disparity.
constexpr float kStep = 2.85e-3F;      // 1/metres, of inverse depth
constexpr float kSigmaSteps = 0.5F;    // noise of the disparity, in steps
constexpr float kNearest = 0.4F;       // metres
constexpr float kFarthest = 6.0F;      // metres
constexpr float kBaseline = 0.075F;    // metres, projector to camera
constexpr float kGrazingSlope = 6.0F;  // metres of depth to a metre across; beyond, half is lost

std::uint64_t pixelBits(std::uint64_t seed, int row, int col) {
  return randomBits(randomBits(seed) + (static_cast<std::uint64_t>(row) << 32U) +
                    static_cast<std::uint64_t>(col));
}

/// Clears `lit` where something nearer on the projector's side keeps the pattern away. The
/// projector sees pixel u at column u + f b / z; a column passed before means that its light was
/// stopped there.
void castShadow(const float* depth, const PinholeCamera& camera, std::vector<std::uint8_t>& lit) {
  const float scale = static_cast<float>(camera.fx) * kBaseline;
  float farthest_column = -1e9F;
  for (int u = 0; u < camera.width; ++u) {
    const float column = static_cast<float>(u) + scale / std::max(depth[u], 0.01F);
    lit[static_cast<std::size_t>(u)] = column >= farthest_column - 1.0F;
    farthest_column = std::max(farthest_column, column);
  }
}

std::uint16_t measure(float z, std::uint64_t bits) {
  if (z < kNearest || z > kFarthest) return 0;
  const float steps = std::round(1 / (z * kStep) + kSigmaSteps * normal(bits, 0));
  return static_cast<std::uint16_t>(std::lround(1000.0F / (steps * kStep)));
}

/// Depth change to the pixels around, metres to a metre across the view.
float slope(const cv::Mat& depth, int row, int col, float focal) {
  const auto at = [&](int r, int c) {
    return depth.at<float>(std::clamp(r, 0, depth.rows - 1), std::clamp(c, 0, depth.cols - 1));
  };
  const float z = std::max(at(row, col), 0.01F);
  const float across = std::abs(at(row, col + 1) - at(row, col - 1));
  const float down = std::abs(at(row + 1, col) - at(row - 1, col));
  return std::max(across, down) * focal / (2 * z);
}

}  // namespace

cv::Mat measureDepth(const cv::Mat& true_depth, const PinholeCamera& camera, std::uint64_t seed) {
  cv::Mat measured(true_depth.size(), CV_16UC1);
  const float focal = static_cast<float>(camera.fx);
  parallelFor(
      static_cast<std::size_t>(true_depth.rows), 16, [&](std::size_t begin, std::size_t end) {
        std::vector<std::uint8_t> lit(static_cast<std::size_t>(camera.width));
        for (int row = static_cast<int>(begin); row < static_cast<int>(end); ++row) {
          castShadow(true_depth.ptr<float>(row), camera, lit);
          auto* out = measured.ptr<std::uint16_t>(row);
          for (int col = 0; col < true_depth.cols; ++col) {
            const std::uint64_t bits = pixelBits(seed, row, col);
            // Wavering edges: now and then a pixel gets its neighbour's depth.
            const int across = static_cast<int>(bits >> 60U) - 1,
                      down = static_cast<int>(bits >> 56U & 15U) - 1;
            const int from_col =
                std::clamp(col + (across < 2 ? across : 0), 0, true_depth.cols - 1);
            const int from_row = std::clamp(row + (down < 2 ? down : 0), 0, true_depth.rows - 1);
            const bool dull =
                slope(true_depth, row, col, focal) > kGrazingSlope && uniform(bits, 30) < 0.5F;
            const bool lost =
                !lit[static_cast<std::size_t>(col)] || dull || uniform(bits, 40) < 0.002F;
            out[col] = lost ? 0 : measure(true_depth.at<float>(from_row, from_col), bits);
          }
        }
      });
  return measured;
}

cv::Mat exactDepth(const cv::Mat& true_depth) {
  cv::Mat millimetres;
  true_depth.convertTo(millimetres, CV_16UC1, 1000.0);
  return millimetres;
}

void addColorNoise(cv::Mat& color, std::uint64_t seed) {
  parallelFor(static_cast<std::size_t>(color.rows), 16, [&](std::size_t begin, std::size_t end) {
    for (int row = static_cast<int>(begin); row < static_cast<int>(end); ++row) {
      auto* pixel = color.ptr<cv::Vec3b>(row);
      for (int col = 0; col < color.cols; ++col) {
        const std::uint64_t bits = pixelBits(seed, row, col);
        for (int c = 0; c < 3; ++c) {
          const float noise = (uniform(bits, 20 * c) + uniform(bits, 20 * c + 10) - 1) * 5.0F;
          pixel[col][c] =
              cv::saturate_cast<std::uint8_t>(static_cast<float>(pixel[col][c]) + noise);
        }
      }
    }
  });
}

}  // namespace pf::synthetic
