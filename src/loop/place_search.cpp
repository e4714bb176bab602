// SPDX-License-Identifier: BSD-3-Clause
#include "posefusion/loop/place_search.hpp"

#include <algorithm>
#include <cmath>

#include "heading_scores.hpp"
#include "panorama.hpp"
#include "posefusion/core/parallel.hpp"
#include "posefusion/core/se3.hpp"
#include "posefusion/core/trajectory.hpp"

namespace pf {
namespace {

constexpr double kBin_rad = 0.033;  // of the panorama, about: a pixel of the query and a bit
// The corner of a picture is farther away than its depth, which is along the axis.
constexpr double kCornerRange = 1.2;
constexpr double kSameTilt_rad = 0.03;
constexpr double kSameHeight_m = 0.05;
constexpr double kApart_m = 0.2, kApart_rad = 0.17;

/// The points around `around`, in the frame of the grid.
MapPoints cut(const MapPoints& points, const Eigen::Isometry3d& T_grid_map, double reach_m) {
  MapPoints near;
  near.voxel_m = points.voxel_m;
  const Eigen::Isometry3f T = T_grid_map.cast<float>();
  const auto reach2 = static_cast<float>(reach_m * reach_m);
  for (std::size_t i = 0; i < points.size(); ++i) {
    const Eigen::Vector3f p = T * Eigen::Vector3f(points.x[i], points.y[i], points.z[i]);
    if (p.squaredNorm() > reach2) continue;
    const Eigen::Vector3f n =
        T.linear() * Eigen::Vector3f(points.nx[i], points.ny[i], points.nz[i]);
    near.x.push_back(p.x());
    near.y.push_back(p.y());
    near.z.push_back(p.z());
    near.nx.push_back(n.x());
    near.ny.push_back(n.y());
    near.nz.push_back(n.z());
    near.intensity.push_back(points.intensity[i]);
  }
  return near;
}

struct Tilt {
  Eigen::Matrix3d R_grid_camera;  ///< at heading 0
  QueryRays rays;
};

/// Positions at one height, with one tilt.
struct Layer {
  std::size_t tilt = 0;  ///< 0: that of before
  double height_m = 0;
};

/// The grid and everything that is looked up in it.
struct Grid {
  int fragment = kFirstFragment;
  Eigen::Isometry3d T_map_grid;
  PanoramaShape shape;
  std::vector<Tilt> tilts;
  std::vector<Layer> layers;
  int side = 0;  ///< positions along x and y
  double step_m = 0;

  std::size_t positions() const { return layers.size() * static_cast<std::size_t>(side * side); }
  std::size_t poses() const { return positions() * static_cast<std::size_t>(shape.headings); }
  const Layer& layer(std::size_t position) const {
    return layers[position / static_cast<std::size_t>(side * side)];
  }
  Eigen::Vector3d position(std::size_t i) const {
    const auto n = static_cast<std::size_t>(side);
    const auto steps = [&](std::size_t k) { return static_cast<int>(k) - side / 2; };
    return {step_m * steps(i % n), step_m * steps(i / n % n), layer(i).height_m};
  }
  /// Poses are numbered by position and heading.
  Eigen::Isometry3d pose(std::size_t number) const {
    const auto headings = static_cast<std::size_t>(shape.headings);
    const double heading = 2.0 * M_PI * static_cast<double>(number % headings) / shape.headings;
    const std::size_t i = number / headings;
    Eigen::Isometry3d T = Eigen::Isometry3d::Identity();
    T.linear() = Eigen::AngleAxisd(heading, Eigen::Vector3d::UnitZ()).toRotationMatrix() *
                 tilts[layer(i).tilt].R_grid_camera;
    T.translation() = position(i);
    return orthonormalised(T_map_grid * T);
  }
};

/// The query's directions for each tilt, rows counted from the lowest.
void addTilts(const PlaceQuery& query, const std::vector<Eigen::Vector3d>& ups, Grid& grid) {
  int lowest = 1 << 20, highest = -lowest;
  for (const Eigen::Vector3d& up : ups) {
    const Eigen::Matrix3d R = levelFromOptical(up).linear();
    grid.tilts.push_back({R, raysOf(query, R, grid.shape, grid.step_m)});
    for (const int row : grid.tilts.back().rays.row) {
      lowest = std::min(lowest, row);
      highest = std::max(highest, row);
    }
  }
  for (Tilt& tilt : grid.tilts) {
    for (int& row : tilt.rays.row) row -= lowest;
  }
  grid.shape.rows = std::max(0, highest - lowest + 1);
  grid.shape.lowest_rad = static_cast<float>(lowest) * grid.shape.bin_rad();
}

/// The heights of the configuration with the tilt of the query's own floor (else that of before),
/// tilt and height as they were, and the heights at which a floor that the query sees is that of
/// the map (points in the frame of the grid).
void addLayers(const PlaceQuery& query, const MapPoints& near, const PlaceSearchConfig& config,
               Grid& grid) {
  const std::size_t beside = grid.tilts.size() - query.beside.size();
  const std::size_t own = beside - 1;
  for (const double height_m : config.heights_m) grid.layers.push_back({own, height_m});
  if (own != 0) grid.layers.push_back({0, 0.0});
  const auto levels = findLevels(orientedPoints(near), Eigen::Vector3d::UnitZ(), 2 * kSameTilt_rad);
  if (!levels) return;
  const auto add = [&](std::size_t tilt, const SeenFloor& floor) {
    const double height_m = levels->lowest_m + floor.below_m;
    const auto is_same = [&](const Layer& layer) {
      return layer.tilt == tilt && std::abs(layer.height_m - height_m) < kSameHeight_m;
    };
    if (std::any_of(grid.layers.begin(), grid.layers.end(), is_same)) return;
    grid.layers.push_back({tilt, height_m});
  };
  if (query.floor) add(own, *query.floor);
  for (std::size_t i = 0; i < query.beside.size(); ++i) add(beside + i, query.beside[i]);
}

Grid makeGrid(const PlaceQuery& query, const MapPose& around, const Eigen::Vector3d& up,
              const PlaceSearchConfig& config) {
  Grid grid;
  const Eigen::Isometry3d& T_map_around = around.T_map_camera;
  const Eigen::Vector3d up_before = T_map_around.linear().transpose() * up.normalized();
  std::vector<Eigen::Vector3d> ups = {up_before};
  if (query.floor && std::acos(std::min(1.0, query.floor->up.dot(up_before))) > kSameTilt_rad) {
    ups.push_back(query.floor->up);
  }
  for (const SeenFloor& floor : query.beside) ups.push_back(floor.up);
  grid.fragment = around.fragment;
  grid.T_map_grid = T_map_around;
  grid.T_map_grid.linear() =
      T_map_around.linear() * levelFromOptical(up_before).linear().transpose();
  grid.shape.headings = config.headings;
  grid.shape.phases =
      std::max(1, static_cast<int>(std::lround(2.0 * M_PI / (config.headings * kBin_rad))));
  const double max_range_m =
      config.max_range_m > 0 ? config.max_range_m : kCornerRange * query.sensor.max_depth_m;
  grid.shape.max_range_m = static_cast<float>(max_range_m);
  grid.step_m = config.step_m;
  grid.side = 2 * static_cast<int>(std::lround(config.reach_m / config.step_m)) + 1;
  addTilts(query, ups, grid);
  return grid;
}

bool isNear(const Eigen::Isometry3d& a, const Eigen::Isometry3d& b) {
  const Eigen::Isometry3d step = a.inverse() * b;
  return step.translation().norm() < kApart_m &&
         Eigen::AngleAxisd(step.linear()).angle() < kApart_rad;
}

/// The best poses that are not near a better one.
std::vector<PlaceCandidate> pickBest(const Grid& grid, const std::vector<PlaceCandidate>& all,
                                     int most) {
  std::vector<std::uint32_t> order(all.size());
  for (std::size_t i = 0; i < order.size(); ++i) order[i] = static_cast<std::uint32_t>(i);
  const std::size_t considered = std::min(order.size(), 40 * static_cast<std::size_t>(most));
  std::partial_sort(order.begin(), order.begin() + static_cast<std::ptrdiff_t>(considered),
                    order.end(), [&](std::uint32_t a, std::uint32_t b) {
                      return all[a].score != all[b].score ? all[a].score > all[b].score : a < b;
                    });
  std::vector<PlaceCandidate> best;
  for (std::size_t k = 0; k < considered && static_cast<int>(best.size()) < most; ++k) {
    PlaceCandidate candidate = all[order[k]];
    if (candidate.score <= 0) break;
    candidate.pose = {grid.fragment, grid.pose(order[k])};
    const bool taken = std::any_of(best.begin(), best.end(), [&](const PlaceCandidate& b) {
      return isNear(b.pose.T_map_camera, candidate.pose.T_map_camera);
    });
    if (!taken) best.push_back(candidate);
  }
  return best;
}

}  // namespace

std::vector<PlaceCandidate> searchPlaces(const MapPoints& points, const PlaceQuery& query,
                                         const MapPose& around, const Eigen::Vector3d& up,
                                         const PlaceSearchConfig& config) {
  Grid grid = makeGrid(query, around, up, config);
  if (grid.shape.rows == 0) return {};
  const MapPoints near = cut(points, grid.T_map_grid.inverse(),
                             grid.shape.max_range_m + std::sqrt(2.0) * config.reach_m);
  addLayers(query, near, config, grid);
  std::vector<PlaceCandidate> all(grid.poses());
  parallelFor(grid.positions(), 8, [&](std::size_t begin, std::size_t end) {
    Panorama panorama;
    HeadingScores scores;
    const auto headings = static_cast<std::size_t>(grid.shape.headings);
    for (std::size_t i = begin; i < end; ++i) {
      const Eigen::Vector3f p = grid.position(i).cast<float>();
      panorama.draw(near, p.data(), grid.shape);
      const QueryRays& rays = grid.tilts[grid.layer(i).tilt].rays;
      scores.compute(panorama, rays, grid.shape.headings);
      const float share = 1.0F / static_cast<float>(std::max<std::size_t>(1, rays.size()));
      for (std::size_t h = 0; h < headings; ++h) {
        PlaceCandidate& c = all[i * headings + h];
        c.score = scores.score[h];
        c.explained = scores.known[h] * share;
        c.agreeing = scores.agreeing[h] / std::max(1.0F, scores.known[h]);
        c.correlation = scores.correlation[h];
      }
    }
  });
  return pickBest(grid, all, config.most);
}

}  // namespace pf
