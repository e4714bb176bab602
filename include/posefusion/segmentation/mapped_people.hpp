// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <vector>

#include "posefusion/pose/skeleton.hpp"
#include "posefusion/segmentation/energy.hpp"
#include "posefusion/segmentation/tracked_people.hpp"

namespace pf {

/// A detection that is a person even where the map says otherwise: somebody who was missed for a
/// while may have been mapped.
bool isSure(const Person& person);

/// Where the detector's mask shows somebody sure for certain, and the map has a surface: that is
/// the person, mapped while nobody saw.
bool isMappedPerson(const Evidence& evidence, const std::vector<TrackedPerson>& people, int cell);

/// Cells of the cut (`labels`, 1 = person) that are surfaces of the map and belong to a person who
/// was surely detected: close to the skeleton, not on a large plane. 1 = such a cell.
std::vector<std::uint8_t> findMappedPeople(const Evidence& evidence,
                                           const std::vector<TrackedPerson>& people,
                                           const std::vector<std::uint8_t>& labels);

}  // namespace pf
