// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <vector>

#include "posefusion/segmentation/background.hpp"
#include "posefusion/segmentation/planes.hpp"
#include "posefusion/segmentation/tracked_people.hpp"

namespace pf {

/// What the map has between the shoulders and hips of somebody detected for sure in this frame, at
/// the depth of those four joints, is that person, who was mapped while hidden or missed: agreement
/// with it becomes `recent`. None of the joints may lie on a plane: hips do that the back of a
/// chair hides, and a picture on a wall.
void doubtTrunks(const std::vector<TrackedPerson>& people, const SceneGrid& grid,
                 const std::vector<Flatness>& flatness, std::vector<Background>& background);

}  // namespace pf
