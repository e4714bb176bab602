// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Geometry>
#include <vector>

#include "posefusion/loop/place_search.hpp"

namespace pf {

/// Positions at one height, with one tilt.
struct GridLayer {
  std::size_t tilt = 0;  ///< 0: that of before
  double height_m = 0;
};

/// Poses around a place, in a frame whose z axis is up and whose origin is that of the pose that is
/// searched around.
struct PlaceGrid {
  int fragment = kFirstFragment;
  Eigen::Isometry3d T_map_grid;
  std::vector<Eigen::Matrix3d> tilts;  ///< R_grid_camera at heading 0
  std::vector<GridLayer> layers;
  int headings = 0;  ///< of a full turn
  int side = 0;      ///< positions along x and y
  double step_m = 0;

  std::size_t positions() const { return layers.size() * static_cast<std::size_t>(side * side); }
  std::size_t poses() const { return positions() * static_cast<std::size_t>(headings); }
  const GridLayer& layer(std::size_t position) const {
    return layers[position / static_cast<std::size_t>(side * side)];
  }
  Eigen::Vector3d position(std::size_t i) const;
  /// In the map. Poses are numbered by position and heading.
  Eigen::Isometry3d pose(std::size_t number) const;
};

/// Without layers: these need the points.
PlaceGrid placeGrid(const PlaceQuery& query, const MapPose& around, const Eigen::Vector3d& up,
                    const PlaceSearchConfig& config);

/// The heights of the configuration with the tilt of the query's own floor (else that of before),
/// tilt and height as they were, and the heights at which a floor that the query sees is that of
/// the map (points in the frame of the grid).
void addLayers(const PlaceQuery& query, const MapPoints& near, const PlaceSearchConfig& config,
               PlaceGrid& grid);

}  // namespace pf
