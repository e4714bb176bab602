// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <opencv2/core.hpp>

#include "posefusion/core/camera.hpp"

namespace pf {

/// A small grey image for rotation pre-alignment.
struct SmallImage {
  cv::Mat intensity;  ///< CV_32FC1, 0..255
  cv::Mat still;      ///< CV_8UC1, 255 where the pixel is no person's
};

/// The rotation that best turns the previous image into the current one, as if the camera had only
/// turned: Gauss-Newton on the photometric error through the homography K R K^-1 (Lovegrove and
/// Davison, "Real-time spherical mosaicing", ECCV 2010), mean brightness removed. Identity when the
/// images share too little texture or turning does not lower the error.
Eigen::Matrix3d alignRotation(const SmallImage& previous, const SmallImage& current,
                              const PinholeCamera& camera);

}  // namespace pf
