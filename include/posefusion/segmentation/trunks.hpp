// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <vector>

#include "posefusion/segmentation/background.hpp"
#include "posefusion/segmentation/planes.hpp"
#include "posefusion/segmentation/tracked_people.hpp"

namespace pf {

/// A map surface between the shoulders and hips of a person surely detected in this frame, at the
/// depth of those four joints, is that person, mapped while hidden or missed: agreement with it
/// becomes `recent`. None of the joints may lie on a plane, as hips behind the back of a chair and
/// a picture on a wall do.
void doubtTrunks(const std::vector<TrackedPerson>& people, const SceneGrid& grid,
                 const std::vector<Flatness>& flatness, std::vector<Background>& background);

}  // namespace pf
