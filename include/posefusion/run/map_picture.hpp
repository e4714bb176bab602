// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <opencv2/core.hpp>

#include "posefusion/core/camera.hpp"
#include "posefusion/core/trajectory.hpp"
#include "posefusion/map/surfel_map.hpp"

namespace pf {

/// The stable map from above, from outside and from the last pose, side by side, CV_8UC3 R G B.
/// Seen from outside, what turns its back on the viewer (the ceiling, the near wall) is left out
/// and the camera's path is drawn in. "Above" is against the y axis of the first camera. `camera`
/// is that of the frames. Empty when there is no stable surfel.
cv::Mat drawMap(const SurfelMap& map, const Trajectory& trajectory, const PinholeCamera& camera);

}  // namespace pf
