// SPDX-License-Identifier: BSD-3-Clause
#include "posefusion/calibration/depth_correction.hpp"

#include <cstdint>
#include <limits>
#include <stdexcept>

#include "posefusion/core/parallel.hpp"

namespace pf {
namespace {

constexpr float kLargest = 65535.0F;
constexpr float kInfinite = std::numeric_limits<float>::infinity();

/// 1 / (1/z + d) = z / (1 + z d); with depth in units, d is per unit.
POSEFUSION_SIMD_CLONES
void correctRow(const std::uint16_t* in, const float* table, float unit_m, std::uint16_t* out,
                int count) {
  for (int i = 0; i < count; ++i) {
    const auto z = static_cast<float>(in[i]);
    const float inverse = 1.0F + z * (table[i] * unit_m);
    const float whole = z / inverse + 0.5F;
    const bool good = inverse > 0.0F && whole < kLargest + 1.0F;
    out[i] = static_cast<std::uint16_t>(static_cast<std::int32_t>(good ? whole : 0.0F));
  }
}

POSEFUSION_SIMD_CLONES
void correctRow(const float* in, const float* table, float* out, int count) {
  for (int i = 0; i < count; ++i) {
    const float z = in[i];
    const float inverse = 1.0F + z * table[i];
    out[i] = z > 0.0F && z < kInfinite && inverse > 0.0F ? z / inverse : 0.0F;
  }
}

}  // namespace

DepthCorrection::DepthCorrection(const DepthField& field, const cv::Size& size) : size_(size) {
  table_.reserve(static_cast<std::size_t>(size.area()));
  for (int v = 0; v < size.height; ++v) {
    for (int u = 0; u < size.width; ++u) {
      table_.push_back(
          static_cast<float>(field.at((u + 0.5) / size.width, (v + 0.5) / size.height)));
    }
  }
}

void DepthCorrection::apply(const cv::Mat& depth, double unit_m, cv::Mat& out) const {
  if (depth.size() != size_) throw std::invalid_argument("a depth image of another size");
  if (depth.type() != CV_16UC1 && depth.type() != CV_32FC1) {
    throw std::invalid_argument("a depth image that is neither CV_16UC1 nor CV_32FC1");
  }
  out.create(depth.size(), depth.type());
  for (int v = 0; v < depth.rows; ++v) {
    const float* table = table_.data() + static_cast<std::size_t>(v) * depth.cols;
    if (depth.type() == CV_16UC1) {
      correctRow(depth.ptr<std::uint16_t>(v), table, static_cast<float>(unit_m),
                 out.ptr<std::uint16_t>(v), depth.cols);
    } else {
      correctRow(depth.ptr<float>(v), table, out.ptr<float>(v), depth.cols);
    }
  }
}

RgbdFrame FrameCorrector::correct(const RgbdFrame& frame) {
  if (frame.depth.empty()) return frame;
  if (frame.depth.type() != CV_16UC1 && frame.depth.type() != CV_32FC1) return frame;
  if (table_.size() != frame.depth.size()) table_ = DepthCorrection(field_, frame.depth.size());
  RgbdFrame corrected = frame;
  corrected.depth = cv::Mat();
  table_.apply(frame.depth, frame.depth_unit_m, corrected.depth);
  return corrected;
}

}  // namespace pf
