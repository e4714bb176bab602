// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <opencv2/core.hpp>
#include <optional>

#include "posefusion/calibration/depth_field.hpp"

namespace pf {

/// Fields over the image as colours, one beside the other with a common colour bar; CV_8UC3 R G B.
/// Numbers are how far off depth is at 2 m, in mm (blue: too near, red: too far).
cv::Mat drawFields(const DepthField& field, const std::optional<DepthField>& truth);

}  // namespace pf
