// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <opencv2/dnn.hpp>

namespace pf {

/// A convolution that mixes the channels of each pixel by itself (1x1, stride 1), on all threads,
/// with the scale, shift and activation behind it in the same pass. What does not fit after all, a
/// tiny image or channels in groups, goes to OpenCV's own. None for any other convolution.
cv::Ptr<cv::dnn::Layer> makePointwise(cv::dnn::LayerParams& params);

}  // namespace pf
