// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <vector>

#include "posefusion/calibration/view_surface.hpp"
#include "posefusion/core/depth_sensor.hpp"
#include "posefusion/graph/constraint.hpp"
#include "posefusion/loop/keyframe_pair.hpp"

namespace pf {

/// A keyframe as the calibration of depth takes it.
CalibrationView calibrationView(const KeyframeView& view, const DepthSensor& sensor);

/// Measures constraints anew from where they are, by aligning the pictures of their keyframes both
/// ways: those that still agree, in their order. `views`: by rising number, some may be missing.
/// The same for any number of threads.
std::vector<PoseConstraint> measurePairs(const std::vector<const KeyframeView*>& views,
                                         const std::vector<PoseConstraint>& pairs,
                                         const TrackingConfig& tracking, const DepthSensor& sensor);

/// All pairs of keyframes that see the same surface by their poses, but for those of `known`, as
/// far as a refinement needs them: some for each keyframe, spread over the others. Loops whose
/// covariance is not known yet.
std::vector<PoseConstraint> densePairs(const std::vector<KeyframeView>& views,
                                       const std::vector<PoseConstraint>& known,
                                       const DepthSensor& sensor);

}  // namespace pf
