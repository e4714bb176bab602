// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <opencv2/core.hpp>
#include <string>
#include <vector>

namespace pf::simulator {

/// A square picture of a surface's reflectance with its smaller versions, repeated in both
/// directions. Coordinates count pictures, not metres.
class Texture {
 public:
  /// `picture` is CV_8UC3, R G B, sRGB, square, its side a power of two.
  explicit Texture(const cv::Mat& picture);

  /// Linear reflectance at (u, v), averaged over about `footprint` of the picture's side.
  Eigen::Vector3f sample(float u, float v, float footprint) const;

  /// Mean linear reflectance.
  const Eigen::Vector3f& mean() const { return mean_; }

  /// Standard deviation of the grey about the mean of its neighbourhood (9x9 texels), by the mean
  /// grey: what a stereo camera can match.
  float contrast() const { return contrast_; }

 private:
  struct Level {
    int side = 0;
    std::vector<std::uint8_t> rgbx;
  };
  std::vector<Level> levels_;
  Eigen::Vector3f mean_;
  float contrast_ = 0.0F;
};

/// sRGB byte to linear [0, 1], and back (clamped).
float linearOf(std::uint8_t srgb);
std::uint8_t srgbOf(float linear);

/// Paints the surface called `kind` (see textureKinds()) with variations by seed. Throws InputError
/// for another kind.
cv::Mat paintTexture(const std::string& kind, std::uint32_t seed);

/// Painters by concept; each returns an empty picture when `kind` is not one of its own.
cv::Mat paintSurface(const std::string& kind, std::uint32_t seed);
cv::Mat paintPrint(const std::string& kind, std::uint32_t seed);

/// All kinds, for messages and documentation.
std::vector<std::string> textureKinds();

/// Metres that one picture of the kind covers; 0 when it is stretched over the whole face.
double pictureSizeM(const std::string& kind);

}  // namespace pf::simulator
