// SPDX-License-Identifier: BSD-3-Clause
#include "place_grid.hpp"

#include <algorithm>
#include <cmath>

#include "posefusion/core/se3.hpp"
#include "posefusion/core/trajectory.hpp"

namespace pf {
namespace {

constexpr double kSameTilt_rad = 0.03;
constexpr double kSameHeight_m = 0.05;

}  // namespace

Eigen::Vector3d PlaceGrid::position(std::size_t i) const {
  const auto n = static_cast<std::size_t>(side);
  const auto steps = [&](std::size_t k) { return static_cast<int>(k) - side / 2; };
  return {step_m * steps(i % n), step_m * steps(i / n % n), layer(i).height_m};
}

Eigen::Isometry3d PlaceGrid::pose(std::size_t number) const {
  const auto turns = static_cast<std::size_t>(headings);
  const double heading = 2.0 * M_PI * static_cast<double>(number % turns) / headings;
  const std::size_t i = number / turns;
  Eigen::Isometry3d T = Eigen::Isometry3d::Identity();
  T.linear() = Eigen::AngleAxisd(heading, Eigen::Vector3d::UnitZ()).toRotationMatrix() *
               tilts[layer(i).tilt];
  T.translation() = position(i);
  return orthonormalised(T_map_grid * T);
}

PlaceGrid placeGrid(const PlaceQuery& query, const MapPose& around, const Eigen::Vector3d& up,
                    const PlaceSearchConfig& config) {
  PlaceGrid grid;
  const Eigen::Isometry3d& T_map_around = around.T_map_camera;
  const Eigen::Vector3d up_before = T_map_around.linear().transpose() * up.normalized();
  std::vector<Eigen::Vector3d> ups = {up_before};
  if (query.floor && std::acos(std::min(1.0, query.floor->up.dot(up_before))) > kSameTilt_rad) {
    ups.push_back(query.floor->up);
  }
  for (const SeenFloor& floor : query.beside) ups.push_back(floor.up);
  for (const Eigen::Vector3d& camera_up : ups) {
    grid.tilts.push_back(levelFromOptical(camera_up).linear());
  }
  grid.fragment = around.fragment;
  grid.T_map_grid = T_map_around;
  grid.T_map_grid.linear() = T_map_around.linear() * grid.tilts.front().transpose();
  grid.headings = config.headings;
  grid.step_m = config.step_m;
  grid.side = 2 * static_cast<int>(std::lround(config.reach_m / config.step_m)) + 1;
  return grid;
}

void addLayers(const PlaceQuery& query, const MapPoints& near, const PlaceSearchConfig& config,
               PlaceGrid& grid) {
  const std::size_t beside = grid.tilts.size() - query.beside.size();
  const std::size_t own = beside - 1;
  for (const double height_m : config.heights_m) grid.layers.push_back({own, height_m});
  if (own != 0) grid.layers.push_back({0, 0.0});
  const auto levels = findLevels(orientedPoints(near), Eigen::Vector3d::UnitZ(), 2 * kSameTilt_rad);
  if (!levels) return;
  const auto add = [&](std::size_t tilt, const SeenFloor& floor) {
    const double height_m = levels->lowest_m + floor.below_m;
    const auto is_same = [&](const GridLayer& layer) {
      return layer.tilt == tilt && std::abs(layer.height_m - height_m) < kSameHeight_m;
    };
    if (std::any_of(grid.layers.begin(), grid.layers.end(), is_same)) return;
    grid.layers.push_back({tilt, height_m});
  };
  if (query.floor) add(own, *query.floor);
  for (std::size_t i = 0; i < query.beside.size(); ++i) add(beside + i, query.beside[i]);
}

}  // namespace pf
