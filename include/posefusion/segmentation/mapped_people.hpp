// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <vector>

#include "posefusion/pose/skeleton.hpp"
#include "posefusion/segmentation/energy.hpp"
#include "posefusion/segmentation/tracked_people.hpp"

namespace pf {

/// A detection that counts as a person even where the map contradicts it: a person that was missed
/// for a while may have been mapped.
bool isSure(const Person& person);

/// The detector's mask surely shows a sure person in the cell, and the map has a surface there: the
/// person was mapped while undetected.
bool isMappedPerson(const Evidence& evidence, const std::vector<TrackedPerson>& people, int cell);

}  // namespace pf
