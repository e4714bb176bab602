// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <vector>

#include "posefusion/segmentation/energy.hpp"

namespace pf {

constexpr std::size_t kMinMaskCells = 12;  ///< a smaller mask is no person
constexpr float kMaxMaskSpread_m = 0.4F;   ///< in depth, of a carried mask around its person

/// Numbers of cells where the map is known, where it agrees, and that lie in front of it.
struct MapVote {
  float known = 0, agrees = 0, nearer = 0;

  MapVote& operator+=(const MapVote& other) {
    known += other.known;
    agrees += other.agrees;
    nearer += other.nearer;
    return *this;
  }
};

MapVote voteOf(const std::vector<int>& cells, const std::vector<Background>& background);

/// The map confirms a carried mask: most of its cells are known, and most of those lie in front.
bool standsBeforeMap(const std::vector<int>& cells, const std::vector<Background>& background);

/// Which detections are accepted as new people: all without a mask (found by a network of joints),
/// and those that a detector is sure of. Others, such as part of a body at the image border, are
/// accepted if they lie in front of the map where nothing was before.
std::vector<bool> mayBeNew(const People& detected, const ShownPeople& shown,
                           const std::vector<Background>& background);

/// Finds a person's place in the scene from the joints, the detector's mask, the carried mask and
/// the map. False: there is none, or it is an object of the map, or the person was last detected
/// too long ago (`carry_s`). A detection on the map's surface is discarded if the carried person
/// lies in front of it.
bool locatePerson(const Evidence& evidence, double carry_s, TrackedPerson& tracked);

}  // namespace pf
