// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <opencv2/core.hpp>

#include "posefusion/core/camera.hpp"

namespace pf::synthetic {

/// Depth in millimetres (CV_16UC1) as a structured-light camera would measure `true_depth`
/// (CV_32FC1, metres): disparity with noise of its own and rounded to its steps, so that errors
/// grow with the square of the distance (Khoshelham and Elberink 2012); edges that waver by a
/// pixel; holes in the projector's shadow, on grazing surfaces and out of range. The random numbers
/// follow from `seed`.
cv::Mat measureDepth(const cv::Mat& true_depth, const PinholeCamera& camera, std::uint64_t seed);

/// Without noise: rounded to millimetres.
cv::Mat exactDepth(const cv::Mat& true_depth);

/// Adds noise of two grey levels or so.
void addColorNoise(cv::Mat& color, std::uint64_t seed);

}  // namespace pf::synthetic
