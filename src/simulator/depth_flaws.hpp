// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <opencv2/core.hpp>

#include "simulator/depth_config.hpp"
#include "simulator/random.hpp"

namespace pf::simulator {

/// A random camera of the kind in the Xtion, Kinect and its successors for pictures `shrink` times
/// smaller than its own: what noise and steps remain in the medians of blocks that large.
DepthConfig drawDepthConfig(int shrink, Dice& dice);

/// What else real depth lacks, drawn by dice: rims of things, patches, the picture's borders.
/// `depth_mm`: CV_16UC1, 0 = none.
void addFlaws(Dice& dice, cv::Mat& depth_mm);

}  // namespace pf::simulator
