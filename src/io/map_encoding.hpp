// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <string>
#include <string_view>

#include "posefusion/core/se3.hpp"
#include "posefusion/io/map_database.hpp"

namespace pf {

/// The bytes of a map file's values, little-endian. Decoding throws InputError saying what is
/// wrong, without the file.
std::string encode(const Eigen::Isometry3d& T);
std::string encode(const Matrix6d& covariance);
std::string encode(const SurfelArrays& surfels);
std::string encodePng(const cv::Mat& image);
std::string encodeIntrinsics(const PinholeCamera& camera);

Eigen::Isometry3d decodeTransform(std::string_view bytes);
Matrix6d decodeCovariance(std::string_view bytes);
/// Surfels of a file of this version, of frames up to `last_frame`, with values that surfels can
/// have.
SurfelArrays decodeSurfels(std::string_view bytes, std::int64_t version, int last_frame);
/// An image of one channel, with its type; empty where it is not whole, or larger than `largest`.
cv::Mat decodePng(std::string_view bytes, const cv::Size& largest);
void decodeIntrinsics(std::string_view bytes, PinholeCamera& camera);

/// Name of the blob that holds what the images of a keyframe do not.
constexpr char kKeyframeBlobs[] = "keyframe/";
inline std::string keyframeBlob(std::int64_t keyframe) {
  return kKeyframeBlobs + std::to_string(keyframe);
}

/// Detects changed bytes with 64 bits (FNV-1a over words).
std::int64_t checksumOf(std::string_view bytes);

}  // namespace pf
