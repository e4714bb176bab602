// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <vector>

#include "posefusion/segmentation/energy.hpp"

namespace pf {

constexpr std::size_t kMinMaskCells = 12;  ///< a smaller mask is nobody
constexpr float kMaxMaskSpread_m = 0.4F;   ///< in depth, of a carried mask around its person

/// Number of cells on which the map has a say, with which it agrees, and which stand before it.
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

/// The map confirms a carried mask: it knows most of the cells, and most of those stand before it.
bool standsBeforeMap(const std::vector<int>& cells, const std::vector<Background>& background);

/// Which detections are believed to be somebody new: all whom no mask shows (a network of joints
/// found them), and those a detector is sure of; of the others, part of a body at the border of the
/// picture say, those that stand before the map where nothing stood.
std::vector<bool> mayBeNew(const People& detected, const ShownPeople& shown,
                           const std::vector<Background>& background);

/// Finds a person's place in the scene from the joints, the detector's mask, the carried mask and
/// the map. False: there is none, or it is a thing that the map holds, or the person was last
/// detected too long ago (`carry_s`). A detection that lies on the map does not end a carried
/// person who stands before it: it is forgotten.
bool locatePerson(const Evidence& evidence, double carry_s, TrackedPerson& tracked);

}  // namespace pf
