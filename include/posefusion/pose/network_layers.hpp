// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <functional>
#include <opencv2/dnn.hpp>

namespace pf {

/// Reads a network with `read` so that those of OpenCV's layers that are slow on a CPU are replaced
/// by ones that compute the same, each with the scale, shift and activation behind it in the same
/// pass: convolutions of single pixels (1x1, a third of the time of OpenCV 4.6's); the
/// normalisation of a channel by its own mean and variance (MVN; one thread in OpenCV 4.6, here
/// all); a convolution of one weight for each channel, which is a scale. Only networks that the
/// calling thread reads in `read` are touched. Throws what `read` throws.
cv::dnn::Net readWithFastLayers(const std::function<cv::dnn::Net()>& read);

}  // namespace pf
