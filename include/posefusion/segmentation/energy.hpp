// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <vector>

#include "posefusion/segmentation/background.hpp"
#include "posefusion/segmentation/body_distance.hpp"
#include "posefusion/segmentation/config.hpp"
#include "posefusion/segmentation/grid.hpp"
#include "posefusion/segmentation/planes.hpp"
#include "posefusion/segmentation/shown_people.hpp"
#include "posefusion/segmentation/tracked_people.hpp"

namespace pf {

/// What is known of the cells of a frame before the cut.
struct Evidence {
  SceneGrid grid;
  std::vector<Background> background;  ///< all unknown without a map
  std::vector<Flatness> flatness;
  std::vector<std::int16_t> carried;  ///< person whose carried mask holds the cell, -1: none
  std::vector<std::int16_t> object;   ///< moving object that the cell should be of, -1: none
  std::vector<std::uint8_t> stood;    ///< 1 = what the cell shows has stood there for a second
  BodyDistance distance;
  ShownPeople shown;                       ///< by the detector's mask
  std::vector<std::int16_t> shown_person;  ///< person that it shows in the cell, -1: none
};

/// Cost that a cell pays for being called background (> 0) or person (< 0).
using Unary = std::vector<float>;

/// A unary this large decides.
constexpr float kCertain = 1000.0F;

/// Distance beyond which a cell's distance to the bodies no longer matters, in capsule radii.
constexpr float kDistanceLimit = 4.0F;

/// The person that a cell could belong to, -1: none.
int candidateOf(const Evidence& evidence, int cell);

/// Whether the cell is on a small plane, or on a large one and not known to be in front of the map.
bool isFlat(const Evidence& evidence, int cell);

/// Sum of the improved terms: distance to the skeletons in space, colour, agreement with the map,
/// planes, the carried mask. Updates the colours of the people.
void improvedUnary(const Evidence& evidence, const SegmentationConfig& config,
                   std::vector<TrackedPerson>& people, Unary& unary);

}  // namespace pf
