// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <vector>

#include "posefusion/segmentation/grid.hpp"

namespace pf {

/// Brings labels of cells (1 = person) to full resolution. A pixel in a block that is surrounded by
/// one label takes it; else it takes the label of those neighbouring cells that are at its own
/// depth (at its own colour where it has none), so that the mask ends on depth edges. Returns
/// CV_8UC1, 255 = person.
cv::Mat upsampleMask(const RgbdFrame& frame, const cv::Mat& depth_m, const SceneGrid& grid,
                     const std::vector<std::uint8_t>& labels);

/// The depth without the masked pixels and a rim of `margin_px` around them (0 there, of either
/// depth type): sensors mix the depths of a person and of the background along the edge.
cv::Mat removeMasked(const cv::Mat& depth, const cv::Mat& mask, int margin_px);

}  // namespace pf
