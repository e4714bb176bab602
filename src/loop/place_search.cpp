// SPDX-License-Identifier: BSD-3-Clause
#include "posefusion/loop/place_search.hpp"

#include <algorithm>
#include <cmath>
#include <numeric>

#include "heading_scores.hpp"
#include "panorama.hpp"
#include "place_grid.hpp"
#include "posefusion/core/parallel.hpp"
#include "posefusion/core/se3.hpp"

namespace pf {
namespace {

constexpr double kBin_rad = 0.033;  // of the panorama, about: a pixel of the query and a bit
// The corner of a picture is farther away than its depth, which is along the axis.
constexpr double kCornerRange = 1.2;
constexpr double kApart_m = 0.2, kApart_rad = 0.17;
// A quarter of the pixels tells which eighth of the positions deserves all of them: what stood out
// there was in it, after falls as in a floor of rooms.
constexpr int kCoarse = 2;
constexpr std::size_t kRefinedOf = 8;

/// How finely the query is compared with the map: the panorama's bins, and the query's directions
/// of each tilt.
struct Comparison {
  PanoramaShape shape;
  std::vector<QueryRays> rays;
};

/// Of every so many pixels along a row and a column, with bins as large.
Comparison comparisonOf(const PlaceQuery& query, const PlaceGrid& grid, double max_range_m,
                        int every) {
  Comparison comparison;
  PanoramaShape& shape = comparison.shape;
  shape.headings = grid.headings;
  shape.phases =
      std::max(1, static_cast<int>(std::lround(2.0 * M_PI / (grid.headings * kBin_rad * every))));
  shape.max_range_m = static_cast<float>(max_range_m);
  int lowest = 1 << 20, highest = -lowest;
  for (const Eigen::Matrix3d& R : grid.tilts) {
    comparison.rays.push_back(raysOf(query, R, shape, grid.step_m, every));
    for (const int row : comparison.rays.back().row) {
      lowest = std::min(lowest, row);
      highest = std::max(highest, row);
    }
  }
  for (QueryRays& rays : comparison.rays) {
    for (int& row : rays.row) row -= lowest;
  }
  shape.rows = std::max(0, highest - lowest + 1);
  shape.lowest_rad = static_cast<float>(lowest) * shape.bin_rad();
  return comparison;
}

/// Scores all headings of some positions.
void score(const PointCubes& near, const PlaceGrid& grid, const Comparison& comparison,
           const std::vector<std::size_t>& positions, std::vector<PlaceCandidate>& all) {
  const auto headings = static_cast<std::size_t>(grid.headings);
  parallelFor(positions.size(), 8, [&](std::size_t begin, std::size_t end) {
    Panorama panorama;
    HeadingScores scores;
    for (std::size_t k = begin; k < end; ++k) {
      const std::size_t i = positions[k];
      panorama.draw(near, grid.position(i).cast<float>(), comparison.shape);
      const QueryRays& rays = comparison.rays[grid.layer(i).tilt];
      scores.compute(panorama, rays, grid.headings);
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
}

/// Those of the positions with the best headings.
std::vector<std::size_t> bestOf(std::vector<std::size_t> positions, const PlaceGrid& grid,
                                const std::vector<PlaceCandidate>& all) {
  const auto headings = static_cast<std::ptrdiff_t>(grid.headings);
  std::vector<double> best(grid.positions());
  for (std::size_t i = 0; i < best.size(); ++i) {
    const auto first = all.begin() + static_cast<std::ptrdiff_t>(i) * headings;
    best[i] = std::max_element(first, first + headings, [](const auto& a, const auto& b) {
                return a.score < b.score;
              })->score;
  }
  std::stable_sort(positions.begin(), positions.end(),
                   [&](std::size_t a, std::size_t b) { return best[a] > best[b]; });
  positions.resize((positions.size() + kRefinedOf - 1) / kRefinedOf);
  return positions;
}

bool isNear(const Eigen::Isometry3d& a, const Eigen::Isometry3d& b) {
  const Eigen::Isometry3d step = a.inverse() * b;
  return step.translation().norm() < kApart_m &&
         Eigen::AngleAxisd(step.linear()).angle() < kApart_rad;
}

/// The best poses that are not near a better one.
std::vector<PlaceCandidate> pickBest(const PlaceGrid& grid, const std::vector<PlaceCandidate>& all,
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

std::vector<PlaceCandidate> searchPlaces(const PointPyramid& points, const PlaceQuery& query,
                                         const MapPose& around, const Eigen::Vector3d& up,
                                         const PlaceSearchConfig& config) {
  PlaceGrid grid = placeGrid(query, around, up, config);
  const double max_range_m =
      config.max_range_m > 0 ? config.max_range_m : kCornerRange * query.sensor.max_depth_m;
  const Comparison coarse = comparisonOf(query, grid, max_range_m, kCoarse);
  const Comparison fine = comparisonOf(query, grid, max_range_m, 1);
  if (fine.shape.rows == 0) return {};
  const PointCubes near(points, grid.T_map_grid.inverse(),
                        max_range_m + std::sqrt(2.0) * config.reach_m);
  addLayers(query, near.points().front(), config, grid);
  std::vector<PlaceCandidate> all(grid.poses());
  std::vector<std::size_t> positions(grid.positions());
  std::iota(positions.begin(), positions.end(), 0);
  score(near, grid, coarse, positions, all);
  positions = bestOf(std::move(positions), grid, all);
  all.assign(grid.poses(), {});
  score(near, grid, fine, positions, all);
  return pickBest(grid, all, config.most);
}

}  // namespace pf
