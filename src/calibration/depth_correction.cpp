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
void correctRow(const std::uint16_t* in, const float* table, float unit_m, float* out, int count) {
  for (int i = 0; i < count; ++i) {
    const float z = static_cast<float>(in[i]) * unit_m;
    const float inverse = 1.0F + z * table[i];
    out[i] = inverse > 0.0F ? z / inverse : 0.0F;
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

void DepthCorrection::require(const cv::Mat& depth) const {
  if (depth.size() != size_) throw std::invalid_argument("a depth image of another size");
  if (depth.type() != CV_16UC1 && depth.type() != CV_32FC1) {
    throw std::invalid_argument("a depth image that is neither CV_16UC1 nor CV_32FC1");
  }
}

void DepthCorrection::apply(const cv::Mat& depth, double unit_m, cv::Mat& out) const {
  if (depth.type() == CV_32FC1) return applyInMetres(depth, unit_m, out);
  require(depth);
  out.create(depth.size(), depth.type());
  for (int v = 0; v < depth.rows; ++v) {
    correctRow(depth.ptr<std::uint16_t>(v), row(v), static_cast<float>(unit_m),
               out.ptr<std::uint16_t>(v), depth.cols);
  }
}

void DepthCorrection::applyInMetres(const cv::Mat& depth, double unit_m, cv::Mat& out) const {
  require(depth);
  out.create(depth.size(), CV_32FC1);
  for (int v = 0; v < depth.rows; ++v) {
    auto* to = out.ptr<float>(v);
    if (depth.type() == CV_16UC1) {
      correctRow(depth.ptr<std::uint16_t>(v), row(v), static_cast<float>(unit_m), to, depth.cols);
    } else {
      correctRow(depth.ptr<float>(v), row(v), to, depth.cols);
    }
  }
}

const DepthCorrection* DepthCorrector::tableFor(const cv::Mat& depth) {
  if (depth.empty() || (depth.type() != CV_16UC1 && depth.type() != CV_32FC1)) return nullptr;
  if (table_.size() != depth.size()) table_ = DepthCorrection(field_, depth.size());
  return &table_;
}

cv::Mat DepthCorrector::inMetres(const cv::Mat& depth, double unit_m) {
  const DepthCorrection* table = tableFor(depth);
  if (table == nullptr) return depth;
  cv::Mat corrected;
  table->applyInMetres(depth, unit_m, corrected);
  return corrected;
}

cv::Mat DepthCorrector::likeInput(const cv::Mat& depth, double unit_m) {
  const DepthCorrection* table = tableFor(depth);
  if (table == nullptr) return depth;
  cv::Mat corrected;
  table->apply(depth, unit_m, corrected);
  return corrected;
}

}  // namespace pf
