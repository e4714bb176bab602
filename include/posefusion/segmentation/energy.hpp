// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <vector>

#include "posefusion/segmentation/background.hpp"
#include "posefusion/segmentation/body.hpp"
#include "posefusion/segmentation/config.hpp"
#include "posefusion/segmentation/grid.hpp"
#include "posefusion/segmentation/tracks.hpp"

namespace pf {

/// What is known of the cells before the cut.
struct Evidence {
  std::vector<Background> background;  ///< all unknown without a map
  std::vector<std::uint8_t> on_plane;  ///< 1 = part of a large plane
  std::vector<std::int16_t> prior;     ///< track whose carried mask holds the cell, -1: none
  BodyDistance distance;
};

/// Cost that a cell pays for being called background (> 0) or person (< 0).
using Unary = std::vector<float>;

/// A unary this large decides.
constexpr float kCertain = 1000.0F;

/// Distance beyond which a cell's distance to the bodies no longer matters, in capsule radii.
constexpr float kDistanceLimit = 4.0F;

/// Sum of the improved terms: distance to the skeletons in space, colour, agreement with the map,
/// planes, the carried mask. Updates the colours of the tracks.
void improvedUnary(const SceneGrid& grid, const Evidence& evidence, const std::vector<Body>& bodies,
                   const SegmentationConfig& config, std::vector<PersonTrack>& tracks,
                   Unary& unary);

/// The paper's background penalty P = horizontal distance to the nearest seed / radius, against the
/// constant foreground weight of PCL's MinCutSegmentation. `up`: unit vector, the distance is
/// measured perpendicular to it.
float paperUnary(const Eigen::Vector3f& point, const std::vector<Eigen::Vector3f>& seeds,
                 const Eigen::Vector3f& up, float radius_m);

/// The paper's smoothness cost C = exp(-(length / sigma)^2).
float smoothnessCost(float length_m, float sigma_m);

}  // namespace pf
