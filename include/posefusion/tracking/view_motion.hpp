// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "posefusion/frame/model_view.hpp"
#include "posefusion/frame/working_frame.hpp"
#include "posefusion/tracking/sparse_motion.hpp"

namespace pf {

/// Motion from where the map was drawn (`before`) to where the frame was taken (`after`), by
/// corners of the drawn picture found again in the frame's. Alignment that slid along a wall into a
/// minimum of its own shows here: corners reach farther than alignment does. Not found where the
/// pictures have little in common. The images of both have the frame's camera. Any thread.
SparseMotion motionFromView(const WorkingFrame& frame, const ModelView& view);

}  // namespace pf
