// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <opencv2/core.hpp>
#include <string>

namespace pf {

/// A compressed colour image (PNG, JPEG, ...) as CV_8UC3 R G B; empty when it is not whole.
cv::Mat decodeColor(const void* data, std::size_t size);

/// A compressed depth image with the type that it was stored with; empty when it is not whole.
cv::Mat decodeDepth(const void* data, std::size_t size);

/// An image as PNG (three channels are R G B), written to a temporary name and renamed. Throws
/// InputError naming the file.
void savePng(const std::string& path, const cv::Mat& image);

}  // namespace pf
