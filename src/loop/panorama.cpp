// SPDX-License-Identifier: BSD-3-Clause
#include "panorama.hpp"

#include <algorithm>
#include <cmath>
#include <cstring>

#include "posefusion/core/parallel.hpp"

namespace pf {
namespace {

constexpr float kPi = 3.14159265F;
// Nearer points would fill the picture; the camera sees nothing there either.
constexpr float kNearest_m = 0.2F;
constexpr std::size_t kChunk = 256;
// Columns are narrower away from the horizon, but not drawn wider than this.
constexpr float kWidest = 5.0F;

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

/// Rounded down, of what is above -4096: in one instruction on every processor.
inline int floorOf(float value) { return static_cast<int>(value + 4096.0F) - 4096; }

/// The bins that points cover, and their ranges; no rows where a point is not to be drawn.
struct Bins {
  int first_row[kChunk], last_row[kChunk], first_column[kChunk], last_column[kChunk];
  float range[kChunk];
};

/// Of a run of points, and how they are seen.
struct Run {
  const float *x, *y, *z, *nx, *ny, *nz;
  float position[3];
  float half_m;  ///< of a voxel
  float bins_per_rad, lowest_rad, max_range_m;
  int rows;
};

POSEFUSION_SIMD_CLONES
void findBins(const Run& run, std::size_t count, Bins& __restrict bins) {
  for (std::size_t i = 0; i < count; ++i) {
    const float x = run.x[i] - run.position[0], y = run.y[i] - run.position[1];
    const float z = run.z[i] - run.position[2];
    const float flat = std::sqrt(x * x + y * y);
    const float range = std::sqrt(x * x + y * y + z * z);
    const float row = (arcTangent(z, flat) - run.lowest_rad) * run.bins_per_rad;
    const float column = (arcTangent(y, x) + kPi) * run.bins_per_rad;
    const float half = run.half_m * run.bins_per_rad / std::max(range, kNearest_m);
    const float wide = half * std::min(kWidest, range / (flat + 1e-6F));
    // Negative where the point faces the position.
    const float away = x * run.nx[i] + y * run.ny[i] + z * run.nz[i];
    bins.first_row[i] = std::max(0, floorOf(row - half));
    const int last_row = std::min(run.rows - 1, floorOf(row + half));
    bins.last_row[i] =
        (away < 0) & (range >= kNearest_m) & (range <= run.max_range_m) ? last_row : -1;
    bins.first_column[i] = floorOf(column - wide);
    bins.last_column[i] = floorOf(column + wide);
    bins.range[i] = range;
  }
}

/// Of floats that are not negative the bits are in the same order; the smaller range wins.
std::uint64_t packed(float range, float intensity) {
  std::uint32_t bits[2];
  std::memcpy(&bits[0], &range, sizeof(range));
  std::memcpy(&bits[1], &intensity, sizeof(intensity));
  return static_cast<std::uint64_t>(bits[0]) << 32 | bits[1];
}

float lowerHalf(std::uint64_t packed) {
  const auto bits = static_cast<std::uint32_t>(packed);
  float value;
  std::memcpy(&value, &bits, sizeof(value));
  return value;
}

/// The sparsest points whose voxels are no larger than a bin at this distance.
std::size_t densityAt(float distance_m, float bin_rad, const PointPyramid& points) {
  std::size_t density = 0;
  while (density + 1 < points.size() && points[density + 1].voxel_m <= bin_rad * distance_m) {
    ++density;
  }
  return density;
}

/// Whether a sphere may be seen in some row.
bool isInRows(const Eigen::Vector3f& centre, float distance_m, const PanoramaShape& shape) {
  const float radius_m = PointCubes::radius_m();
  if (distance_m <= radius_m) return true;
  const float elevation = std::asin(centre.z() / distance_m);
  const float around = std::asin(radius_m / distance_m) + shape.bin_rad();
  const float highest_rad = shape.lowest_rad + static_cast<float>(shape.rows) * shape.bin_rad();
  return elevation + around > shape.lowest_rad && elevation - around < highest_rad;
}

}  // namespace

float PanoramaShape::bin_rad() const { return 2.0F * kPi / static_cast<float>(columns()); }

void Panorama::draw(const PointCubes& cubes, const Eigen::Vector3f& position,
                    const PanoramaShape& shape) {
  shape_ = shape;
  nearest_.assign(static_cast<std::size_t>(shape.rows * shape.columns()),
                  packed(kUnknownRange, 0.0F));
  const float bin_rad = shape.bin_rad();
  for (const PointCubes::Cube& cube : cubes.cubes()) {
    const Eigen::Vector3f centre = cube.centre - position;
    const float distance_m = centre.norm();
    if (distance_m - PointCubes::radius_m() > shape.max_range_m) continue;
    if (!isInRows(centre, distance_m, shape)) continue;
    const std::size_t density = densityAt(distance_m, bin_rad, cubes.points());
    drawPoints(cubes.points()[density], cube.begin[density], cube.end[density], position);
  }
  arrangeByHeading();
}

void Panorama::drawPoints(const MapPoints& points, std::size_t begin, std::size_t end,
                          const Eigen::Vector3f& position) {
  Bins bins;
  for (; begin < end; begin += kChunk) {
    const std::size_t count = std::min(kChunk, end - begin);
    const Run run{&points.x[begin],
                  &points.y[begin],
                  &points.z[begin],
                  &points.nx[begin],
                  &points.ny[begin],
                  &points.nz[begin],
                  {position.x(), position.y(), position.z()},
                  0.6F * points.voxel_m,
                  1.0F / shape_.bin_rad(),
                  shape_.lowest_rad,
                  shape_.max_range_m,
                  shape_.rows};
    findBins(run, count, bins);
    for (std::size_t i = 0; i < count; ++i) {
      if (bins.first_row[i] > bins.last_row[i]) continue;
      const int first = bins.first_column[i];
      const int last = std::min(bins.last_column[i], first + shape_.columns() - 1);
      const std::uint64_t point = packed(bins.range[i], points.intensity[begin + i]);
      for (int row = bins.first_row[i]; row <= bins.last_row[i]; ++row) {
        offer(point, row, first, last);
      }
    }
  }
}

/// To bins of a row, which goes all around.
void Panorama::offer(std::uint64_t point, int row, int first_column, int last_column) {
  const int columns = shape_.columns();
  std::uint64_t* bins = &nearest_[static_cast<std::size_t>(row * columns)];
  for (int c = first_column; c <= last_column; ++c) {
    std::uint64_t& there = bins[c < 0 ? c + columns : c < columns ? c : c - columns];
    there = std::min(there, point);
  }
}

void Panorama::arrangeByHeading() {
  range_.resize(2 * nearest_.size());
  intensity_.resize(2 * nearest_.size());
  const auto headings = static_cast<std::size_t>(shape_.headings);
  std::size_t from = 0;
  for (int row = 0; row < shape_.rows; ++row) {
    for (int column = 0; column < shape_.columns(); ++column, ++from) {
      const std::size_t to = offset(row, column);
      range_[to] = range_[to + headings] = lowerHalf(nearest_[from] >> 32);
      intensity_[to] = intensity_[to + headings] = lowerHalf(nearest_[from]);
    }
  }
}

}  // namespace pf
