// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <opencv2/core.hpp>

#include "posefusion/core/trajectory.hpp"
#include "posefusion/evaluation/metrics.hpp"

namespace pf {

/// The whole truth, the aligned estimate and the differences between the pairs, seen along the axis
/// in which the truth spans least; CV_8UC3 R G B. `pairs` must not be empty.
cv::Mat plotTrajectories(const Trajectory& truth, const std::vector<PosePair>& pairs,
                         const Alignment& alignment);

}  // namespace pf
