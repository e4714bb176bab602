// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <opencv2/core.hpp>

namespace pf {

/// How sharp a colour image is.
struct Sharpness {
  double laplacian_variance = 0.0;  ///< see scoreBlur()
  double fine_detail = 0.0;  ///< energy of fine detail for each unit of coarse detail; 0 where dull
  bool dull = false;         ///< no coarse detail above the noise: blur cannot be measured
};

/// Variance of the response of the 3x3 Laplacian on the grey image, grey levels squared (PFH paper,
/// section III). `color` is CV_8UC3 R G B.
double scoreBlur(const cv::Mat& color);

/// The score, and a measure that contrast does not change: blur takes fine detail only, less
/// contrast or a dull scene takes coarse detail too. Fine detail is the mean square of the second
/// difference at about 320 pixels across (half the size of small images), coarse detail that of the
/// central difference at a quarter of that, both without the part of the sensor noise, which is
/// estimated from the image (median version of J. Immerkaer, "Fast noise variance estimation",
/// 1996). The smaller ratio of the two image axes counts, for a moving camera blurs along one.
/// `color` is CV_8UC3 R G B.
Sharpness measureSharpness(const cv::Mat& color);

}  // namespace pf
