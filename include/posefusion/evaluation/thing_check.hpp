// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string>
#include <vector>

#include "posefusion/evaluation/surface_check.hpp"
#include "posefusion/io/things_file.hpp"

namespace pf {

/// What lies within this (m) of a surface belongs to it.
constexpr float kOnThing_m = 0.05F;

/// A thing's surface in its own frame; discs that cover points 1.5 cm apart.
SurfaceSamples surfaceOf(const RecordedThing& thing);

/// Surfels of one thing that are not of the world as it is in the end.
struct ThingRemains {
  std::string name;
  std::size_t at_old_places = 0;  ///< where it stood once
  std::size_t on_the_way = 0;     ///< where it was between two places
};

/// What a map has of things that are gone.
struct RemainsScore {
  std::size_t surfels = 0;
  std::vector<ThingRemains> things;

  std::size_t remains() const;
  /// remains() / surfels, 0 of none.
  double share() const;
};

/// Which of a map's surfels (centres, in the frame of the truth) are remains of things: farther
/// than 5 cm from the scene as it is in the end, and within 5 cm of a thing as it stood once or as
/// it went. Each counts once: for the first thing, and there for its old places.
RemainsScore checkRemains(const std::vector<Eigen::Vector3f>& surfels, const SurfaceSamples& scene,
                          const std::vector<RecordedThing>& things);

}  // namespace pf
