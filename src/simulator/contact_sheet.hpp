// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <opencv2/core.hpp>

#include "simulator/simulation.hpp"

namespace pf::simulator {

/// Colour, depth, mask and joints of one frame side by side, `width` pixels each, CV_8UC3 R G B.
cv::Mat drawFrame(const SimulatedFrame& frame, const Simulation& simulation, int width);

/// The joints and limbs of the people, drawn over a picture: what is hidden is thin.
void drawJoints(const std::vector<PersonTruth>& people, cv::Mat& picture);

/// Depth in colours from near (red) to 5 m (blue); black where there is none.
cv::Mat depthColors(const cv::Mat& depth_mm);

}  // namespace pf::simulator
