// SPDX-License-Identifier: BSD-3-Clause
#include "panorama.hpp"

#include <algorithm>
#include <cmath>

namespace pf {
namespace {

constexpr float kPi = 3.14159265F;
// Nearer points would fill the picture; the camera sees nothing there either.
constexpr float kMinRange_m = 0.2F;
constexpr std::size_t kChunk = 1024;

/// Within 0.0003 rad: Abramowitz and Stegun 4.4.49 (shortened), on the octant of the smaller ratio.
inline float arcTangent(float y, float x) {
  const float ax = std::abs(x), ay = std::abs(y);
  const float ratio = std::min(ax, ay) / (std::max(ax, ay) + 1e-20F);
  const float s = ratio * ratio;
  float angle = ((-0.0464964749F * s + 0.15931422F) * s - 0.327622764F) * s * ratio + ratio;
  angle = ay > ax ? 0.5F * kPi - angle : angle;
  angle = x < 0 ? kPi - angle : angle;
  return y < 0 ? -angle : angle;
}

}  // namespace

float PanoramaShape::bin_rad() const { return 2.0F * kPi / static_cast<float>(columns()); }

void Panorama::draw(const MapPoints& points, const float position[3], const PanoramaShape& shape) {
  shape_ = shape;
  const std::size_t cells = 2 * static_cast<std::size_t>(shape.rows * shape.columns());
  range_.assign(cells, kUnknownRange);
  intensity_.assign(cells, 0.0F);
  float azimuth[kChunk], elevation[kChunk], range[kChunk];
  const float half_m = 0.6F * points.voxel_m;
  for (std::size_t begin = 0; begin < points.size(); begin += kChunk) {
    const std::size_t count = std::min(kChunk, points.size() - begin);
    for (std::size_t k = 0; k < count; ++k) {
      const std::size_t i = begin + k;
      const float x = points.x[i] - position[0], y = points.y[i] - position[1];
      const float z = points.z[i] - position[2];
      const float flat = std::sqrt(x * x + y * y);
      const float distance = std::sqrt(x * x + y * y + z * z);
      const bool faces = x * points.nx[i] + y * points.ny[i] + z * points.nz[i] < 0;
      azimuth[k] = arcTangent(y, x);
      elevation[k] = arcTangent(z, flat);
      range[k] = faces ? distance : kUnknownRange;
    }
    for (std::size_t k = 0; k < count; ++k) {
      if (range[k] < kMinRange_m || range[k] > shape.max_range_m) continue;
      splat(azimuth[k], elevation[k], range[k], points.intensity[begin + k], half_m / range[k]);
    }
  }
}

/// Fills the bins that a point's voxel covers.
void Panorama::splat(float azimuth, float elevation, float range, float intensity, float half_rad) {
  const float inverse = 1.0F / shape_.bin_rad();
  const float row = (elevation - shape_.lowest_rad) * inverse;
  const float half = half_rad * inverse;
  const int first_row = std::max(0, static_cast<int>(std::floor(row - half)));
  const int last_row = std::min(shape_.rows - 1, static_cast<int>(std::floor(row + half)));
  if (first_row > last_row) return;
  // Columns are narrower away from the horizon.
  const float wide = half / std::max(0.2F, std::cos(elevation));
  const float column = (azimuth + kPi) * inverse;
  const int first = static_cast<int>(std::floor(column - wide));
  const int last =
      std::min(static_cast<int>(std::floor(column + wide)), first + shape_.columns() - 1);
  for (int r = first_row; r <= last_row; ++r) {
    for (int c = first; c <= last; ++c) {
      put(r, (c + shape_.columns()) % shape_.columns(), range, intensity);
    }
  }
}

void Panorama::put(int row, int column, float range, float intensity) {
  const std::size_t i = offset(row, column);
  if (range >= range_[i]) return;
  const auto headings = static_cast<std::size_t>(shape_.headings);
  range_[i] = range_[i + headings] = range;
  intensity_[i] = intensity_[i + headings] = intensity;
}

}  // namespace pf
