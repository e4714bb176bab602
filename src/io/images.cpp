// SPDX-License-Identifier: BSD-3-Clause
#include "posefusion/io/images.hpp"

#include <limits>
#include <opencv2/imgcodecs.hpp>
#include <opencv2/imgproc.hpp>
#include <vector>

#include "posefusion/core/error.hpp"
#include "posefusion/io/files.hpp"

namespace pf {
namespace {

/// JPEG decoders fill what is missing at the end with grey. The end-of-image marker has to follow
/// the last start of scan; neither can occur inside the coded data.
bool isCutJpeg(const unsigned char* bytes, std::size_t size) {
  if (size < 4 || bytes[0] != 0xFF || bytes[1] != 0xD8) return false;
  for (std::size_t i = size - 1; i > 1; --i) {
    if (bytes[i - 1] != 0xFF) continue;
    if (bytes[i] == 0xD9) return false;
    if (bytes[i] == 0xDA) return true;
  }
  return true;
}

cv::Mat decode(const void* data, std::size_t size, int flags) {
  if (size == 0 || size > static_cast<std::size_t>(std::numeric_limits<int>::max())) return {};
  if (isCutJpeg(static_cast<const unsigned char*>(data), size)) return {};
  const cv::Mat bytes(1, static_cast<int>(size), CV_8UC1, const_cast<void*>(data));
  try {
    return cv::imdecode(bytes, flags);
  } catch (const cv::Exception&) {
    return {};  // absurd sizes in a damaged header
  }
}

}  // namespace

cv::Mat decodeColor(const void* data, std::size_t size) {
  cv::Mat image = decode(data, size, cv::IMREAD_COLOR | cv::IMREAD_IGNORE_ORIENTATION);
  if (!image.empty()) cv::cvtColor(image, image, cv::COLOR_BGR2RGB);
  return image;
}

cv::Mat decodeDepth(const void* data, std::size_t size) {
  return decode(data, size, cv::IMREAD_UNCHANGED);
}

void savePng(const std::string& path, const cv::Mat& image) {
  cv::Mat stored = image;
  if (image.channels() == 3) cv::cvtColor(image, stored, cv::COLOR_RGB2BGR);
  std::vector<unsigned char> bytes;
  try {
    // Without a level OpenCV does not search for the best filter of each row either: half the time,
    // and the noise of images defeats the search anyway.
    cv::imencode(".png", stored, bytes);
  } catch (const cv::Exception& error) {
    throw InputError(path + ": cannot be stored as PNG: " + error.err);
  }
  AtomicFile file(path);
  file.stream().write(reinterpret_cast<const char*>(bytes.data()),
                      static_cast<std::streamsize>(bytes.size()));
  file.commit(AtomicFile::Until::system);
}

}  // namespace pf
