// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <opencv2/core.hpp>

namespace pf {

/// Standard deviation of the noise of a picture, in grey levels, by how far pixels are from what
/// their neighbours say (Immerkaer, "Fast noise variance estimation", CVIU 1996): that of the
/// quarter of its blocks that have least, as texture looks like noise. `intensity`: CV_32FC1 or
/// CV_8UC1.
double pictureNoise(const cv::Mat& intensity);

}  // namespace pf
