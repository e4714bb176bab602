// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Geometry>
#include <cstdint>
#include <vector>

#include "posefusion/core/depth_sensor.hpp"
#include "posefusion/frame/model_view.hpp"
#include "posefusion/segmentation/grid.hpp"

namespace pf {

/// How a cell agrees with the map.
enum class Background : std::uint8_t {
  unknown,  ///< the map has nothing there, or the cell has no depth
  agrees,   ///< the cell is a surface of the map
  recent,   ///< the cell is a surface that the map has seen for a few frames only: perhaps a person
            ///< that was missed
  nearer,   ///< the cell lies clearly in front of everything that the map has there
  farther   ///< the cell is seen through a surface of the map
};

/// Compares the grid with the map as rendered from another pose. `T_view_camera` takes points of
/// the grid's camera to the view's, `sensor` says which depths may be of one surface. A cell agrees
/// if any surface within a cell's reach in the view is at its depth, so that an error of a pixel or
/// two in the pose does no harm; it is nearer only if all of them are behind.
void compareWithModel(const SceneGrid& grid, const ModelView& view,
                      const Eigen::Isometry3d& T_view_camera, const DepthSensor& sensor,
                      std::vector<Background>& result);

/// The same for some cells of the grid; all others are unknown.
void compareWithModel(const SceneGrid& grid, const std::vector<int>& cells, const ModelView& view,
                      const Eigen::Isometry3d& T_view_camera, const DepthSensor& sensor,
                      std::vector<Background>& result);

}  // namespace pf
