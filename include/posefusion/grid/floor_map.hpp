// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Geometry>
#include <functional>
#include <optional>
#include <vector>

#include "posefusion/grid/occupancy_grid.hpp"

namespace pf {

/// A map that stands level on its floor, and what its keyframes see of it.
struct FloorMap {
  SurfelArrays surfels;  ///< stable ones, in the frame of the floor
  Eigen::Isometry3d T_floor_world = Eigen::Isometry3d::Identity();  ///< from that of results
  std::vector<SeenPoints> seen;                                     ///< in the frame of the floor

  double leaning_rad() const;  ///< of the frame of results
};

/// What a grid is made of, all in the map frame.
struct MapParts {
  const SurfelMap& map;
  const PinholeCamera& camera;  ///< of the keyframes
  const std::vector<Keyframe>& keyframes;
  Eigen::Isometry3d T_world_map = Eigen::Isometry3d::Identity();  ///< to that of results, z up
};

/// Throws InputError where no floor is in it.
FloorMap floorMapOf(const MapParts& parts);

OccupancyGrid gridOf(const FloorMap& map, const GridConfig& config);

/// The grid of a map that grows, by the keyframes that are in use. What one sees is drawn once, and
/// again while it is one of the newest, where not all is stable yet, or when a correction has moved
/// it. The cells stay where they are as long as the floor does, to a centimetre. Not thread safe.
class GrowingGrid {
 public:
  /// Throws InputError naming the first value that cannot be.
  explicit GrowingGrid(const GridConfig& config);
  const GridConfig& config() const { return config_; }

  struct Placed {
    OccupancyGrid grid;
    Eigen::Isometry3d T_world_floor;
  };
  /// Nothing where `stops` says so before it is done. Throws InputError where no floor is in the
  /// map.
  std::optional<Placed> update(const MapParts& parts, const std::function<bool()>& stops = {});

 private:
  struct Seen {
    Eigen::Isometry3d T_map_camera = Eigen::Isometry3d::Identity();
    cv::Mat depth_mm;  // CV_16UC1, 0: nothing
  };
  void draw(const MapParts& parts, KeyframeRays& rays, std::size_t i);

  GridConfig config_;
  std::optional<Eigen::Isometry3d> T_floor_world_;
  std::vector<Seen> seen_;  // of each keyframe; empty where it is not drawn
};

}  // namespace pf
