// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <opencv2/dnn.hpp>

namespace pf {

/// A convolution that computes what OpenCV's does, on all threads, with the activation behind it in
/// the same pass, where it is of one of two kinds: of single pixels (1x1, stride 1), or one weight
/// for each channel, which is a scale. What does not fit after all, a tiny image or channels in
/// groups, goes to OpenCV's own, and so does every other kind.
cv::Ptr<cv::dnn::Layer> makeFastConvolution(cv::dnn::LayerParams& params);

}  // namespace pf
