// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <opencv2/core.hpp>

#include "simulator/depth_kind.hpp"

namespace pf::simulator {

/// From what is there to what the depth camera reports: CV_16UC1, millimetres, 0 = no depth.
/// Truth that changes with the noise is changed along (lateral noise moves mask and depth
/// together): `label` receives, for every pixel, that of DepthView which its depth came from.
void senseDepth(const DepthShot& shot, cv::Mat& depth_mm, cv::Mat& label);

}  // namespace pf::simulator
