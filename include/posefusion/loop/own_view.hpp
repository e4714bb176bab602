// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "posefusion/frame/model_view.hpp"
#include "posefusion/frame/working_frame.hpp"
#include "posefusion/tracking/config.hpp"

namespace pf {

/// What a frame shows, as if a map showed it: in the frame's own camera frame, all of it static.
/// Shares the memory of the level's normals and grey levels.
void ownView(const FrameLevel& level, ModelView& view);

/// Whether a frame shows enough to be placed anywhere: aligned with itself, its pose is known
/// (isKnown). A bare wall that fills the picture does not, and no map can tell more of it.
bool canBePlaced(const WorkingFrame& frame, const TrackingConfig& config);

}  // namespace pf
