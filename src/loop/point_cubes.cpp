// SPDX-License-Identifier: BSD-3-Clause
#include "point_cubes.hpp"

#include <algorithm>
#include <cmath>

#include "point_arrays.hpp"

namespace pf {
namespace {

constexpr float kCube_m = 1.5F;

/// The cubes within reach of the origin, numbered.
struct CubeGrid {
  int half;  ///< cubes from the origin to the edge

  explicit CubeGrid(double reach_m) : half(static_cast<int>(std::ceil(reach_m / kCube_m))) {}
  int side() const { return 2 * half; }
  std::size_t count() const { return static_cast<std::size_t>(side() * side() * side()); }
  /// Of a point within reach.
  std::uint32_t numberOf(const Eigen::Vector3f& p) const {
    const auto index = [&](float value) {
      return std::clamp(static_cast<int>(std::floor(value / kCube_m)) + half, 0, side() - 1);
    };
    return static_cast<std::uint32_t>((index(p.z()) * side() + index(p.y())) * side() +
                                      index(p.x()));
  }
  Eigen::Vector3f centre(std::size_t number) const {
    const int n = static_cast<int>(number);
    const Eigen::Vector3i index(n % side(), n / side() % side(), n / side() / side());
    return kCube_m * ((index.array() - half).cast<float>() + 0.5F).matrix();
  }
};

/// The points within reach, sorted by their cubes; `begin` of each cube, and of one more.
MapPoints sorted(const MapPoints& points, const Eigen::Isometry3f& T, double reach_m,
                 const CubeGrid& grid, std::vector<std::uint32_t>& begin) {
  struct Near {
    std::uint32_t cube, index;
    Eigen::Vector3f p;
  };
  std::vector<Near> near;
  begin.assign(grid.count() + 1, 0);
  const auto reach2 = static_cast<float>(reach_m * reach_m);
  for (std::size_t i = 0; i < points.size(); ++i) {
    const Eigen::Vector3f p = T * Eigen::Vector3f(points.x[i], points.y[i], points.z[i]);
    if (!(p.squaredNorm() <= reach2)) continue;
    near.push_back({grid.numberOf(p), static_cast<std::uint32_t>(i), p});
    ++begin[near.back().cube + 1];
  }
  for (std::size_t k = 1; k < begin.size(); ++k) begin[k] += begin[k - 1];
  MapPoints out;
  out.voxel_m = points.voxel_m;
  for (auto* array : pointArrays(out)) array->resize(near.size());
  std::vector<std::uint32_t> next(begin.begin(), begin.end() - 1);
  for (const Near& point : near) {
    const std::size_t i = point.index, to = next[point.cube]++;
    const Eigen::Vector3f n =
        T.linear() * Eigen::Vector3f(points.nx[i], points.ny[i], points.nz[i]);
    out.x[to] = point.p.x();
    out.y[to] = point.p.y();
    out.z[to] = point.p.z();
    out.nx[to] = n.x();
    out.ny[to] = n.y();
    out.nz[to] = n.z();
    out.intensity[to] = points.intensity[i];
  }
  return out;
}

}  // namespace

float PointCubes::radius_m() { return 0.5F * std::sqrt(3.0F) * kCube_m; }

PointCubes::PointCubes(const PointPyramid& pyramid, const Eigen::Isometry3d& T_grid_map,
                       double reach_m) {
  const CubeGrid grid(reach_m);
  std::vector<std::vector<std::uint32_t>> begins(pyramid.size());
  for (std::size_t k = 0; k < pyramid.size(); ++k) {
    points_.push_back(sorted(pyramid[k], T_grid_map.cast<float>(), reach_m, grid, begins[k]));
  }
  for (std::size_t number = 0; number < grid.count(); ++number) {
    Cube cube;
    bool is_empty = true;
    for (const auto& begin : begins) {
      cube.begin.push_back(begin[number]);
      cube.end.push_back(begin[number + 1]);
      is_empty = is_empty && begin[number] == begin[number + 1];
    }
    if (is_empty) continue;
    cube.centre = grid.centre(number);
    cubes_.push_back(std::move(cube));
  }
}

}  // namespace pf
