// SPDX-License-Identifier: BSD-3-Clause
#include "map_encoding.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstring>
#include <opencv2/imgcodecs.hpp>

#include "map_schema.hpp"
#include "posefusion/core/error.hpp"
#include "posefusion/core/static_odds.hpp"
#include "posefusion/io/images.hpp"

namespace pf {
namespace {

constexpr std::size_t kIntrinsics = 9;
using RowMajor34d = Eigen::Matrix<double, 3, 4, Eigen::RowMajor>;

template <typename Matrix>
std::string bytesOf(const Matrix& m) {
  return std::string(reinterpret_cast<const char*>(m.data()),
                     sizeof(double) * static_cast<std::size_t>(m.size()));
}

template <typename Matrix>
Matrix matrixOf(std::string_view bytes, const char* name) {
  Matrix m;
  if (bytes.size() != sizeof(double) * static_cast<std::size_t>(m.size())) {
    throw InputError(std::string(name) + " has " + std::to_string(bytes.size()) +
                     " bytes, expected " + std::to_string(sizeof(double) * m.size()));
  }
  std::memcpy(m.data(), bytes.data(), bytes.size());
  if (!m.allFinite()) throw InputError(std::string(name) + " is not finite");
  return m;
}

bool allFinite(const std::vector<float>& values) {
  float sum = 0;  // of zeros, unless one is infinite or NaN
  for (const float value : values) sum += value * 0.0F;
  return sum == 0.0F;
}
bool allFinite(const std::vector<std::int32_t>&) { return true; }

// What no camera makes: ten thousand kilometres away, a pixel of ten metres.
constexpr float kFarthest_m = 1e7F, kLargestRadius_m = 10.0F;
// Of a unit vector that was turned again and again in single precision.
constexpr float kUnitTolerance = 0.01F;

bool isWithin(float value, float low, float high) { return value >= low && value <= high; }

/// The first value of a surfel that cannot be, and would make rendering endless or overflow.
void checkValues(const SurfelArrays& s) {
  for (std::size_t i = 0; i < s.size(); ++i) {
    for (const float place : {s.x[i], s.y[i], s.z[i]}) {
      require(isWithin(place, -kFarthest_m, kFarthest_m), "the place of a surfel", place,
              "less than 1e7 m");
    }
    const float normal2 = s.nx[i] * s.nx[i] + s.ny[i] * s.ny[i] + s.nz[i] * s.nz[i];
    require(isWithin(normal2, 1 - 2 * kUnitTolerance, 1 + 2 * kUnitTolerance),
            "the normal's length of a surfel", std::sqrt(normal2), "1");
    require(s.radius[i] > 0 && s.radius[i] <= kLargestRadius_m, "the radius of a surfel",
            s.radius[i], "more than 0 and at most 10 m");
    require(isWithin(s.odds[i], static_odds::kGone, static_odds::kMost), "the odds of a surfel",
            s.odds[i], "-100 to 3.52");
  }
}

void checkFrames(const SurfelArrays& s, int last_frame) {
  for (std::size_t i = 0; i < s.size(); ++i) {
    if (s.created[i] < -1 || s.created[i] > last_frame || s.seen[i] < -1 ||
        s.seen[i] > last_frame) {
      throw InputError("a surfel is of frame " + std::to_string(s.created[i]) + ", seen in " +
                       std::to_string(s.seen[i]) + ", expected at most " +
                       std::to_string(last_frame));
    }
  }
}

/// Takes the next array of `bytes`.
template <typename Array>
void take(std::string_view& bytes, Array& array) {
  const std::size_t size = array.size() * sizeof(array[0]);
  if (size > 0) std::memcpy(array.data(), bytes.data(), size);
  bytes.remove_prefix(size);
}

/// Before kOddsVersion surfels had the frames that supported them in place of the odds, and at the
/// end those that contradicted them.
void upgradeOdds(std::string_view violations, SurfelArrays& s) {
  std::vector<std::int32_t> against(s.size());
  take(violations, against);
  for (std::size_t i = 0; i < s.size(); ++i) {
    s.odds[i] = static_odds::supported(0.0F, s.odds[i]);
    require(against[i] >= 0, "the violations of a surfel", against[i], "0 or more");
    if (against[i] == 0) continue;
    s.odds[i] = static_odds::contradicted(s.odds[i], static_cast<float>(against[i]));
  }
}

}  // namespace

std::string encode(const Eigen::Isometry3d& T) {
  const RowMajor34d m = T.matrix().topRows<3>();
  return bytesOf(m);
}

std::string encode(const Matrix6d& covariance) { return bytesOf(covariance); }

std::string encode(const SurfelArrays& surfels) {
  std::string bytes;
  bytes.reserve(surfels.size() * SurfelArrays::bytesPerSurfel());
  SurfelArrays nothing;
  nothing.forEachArray(surfels, [&](const auto&, const auto& array) {
    bytes.append(reinterpret_cast<const char*>(array.data()), array.size() * sizeof(array[0]));
  });
  return bytes;
}

std::string encodePng(const cv::Mat& image) {
  std::vector<unsigned char> bytes;
  if (!cv::imencode(".png", image, bytes)) throw InputError("an image cannot be encoded");
  return std::string(bytes.begin(), bytes.end());
}

// A map's camera is that of rectified frames: places of a distortion that is all zero.
std::string encodeIntrinsics(const PinholeCamera& c) {
  Eigen::Matrix<double, kIntrinsics, 1> values;
  values << c.fx, c.fy, c.cx, c.cy, c.distortion[0], c.distortion[1], c.distortion[2],
      c.distortion[3], c.distortion[4];
  return bytesOf(values);
}

Eigen::Isometry3d decodeTransform(std::string_view bytes) {
  Eigen::Isometry3d T = Eigen::Isometry3d::Identity();
  T.matrix().topRows<3>() = matrixOf<RowMajor34d>(bytes, "a transform");
  return T;
}

Matrix6d decodeCovariance(std::string_view bytes) {
  return matrixOf<Matrix6d>(bytes, "a covariance");
}

SurfelArrays decodeSurfels(std::string_view bytes, std::int64_t version, int last_frame) {
  const std::size_t each =
      SurfelArrays::bytesPerSurfel() + (version < kOddsVersion ? sizeof(std::int32_t) : 0);
  if (bytes.size() % each != 0) {
    throw InputError("a block of surfels has " + std::to_string(bytes.size()) +
                     " bytes, expected a multiple of " + std::to_string(each));
  }
  SurfelArrays surfels;
  surfels.resize(bytes.size() / each);
  bool finite = true;
  surfels.forEachArray([&](auto& array) {
    take(bytes, array);
    finite &= allFinite(array);
  });
  if (!finite) throw InputError("a surfel has a value that is not finite");
  if (version < kOddsVersion) upgradeOdds(bytes, surfels);
  checkFrames(surfels, last_frame);
  checkValues(surfels);
  return surfels;
}

cv::Mat decodePng(std::string_view bytes, const cv::Size& largest) {
  // Sizes stand before all else (PNG, 11.2.2), so that nothing has to be unpacked to know them.
  constexpr std::size_t kWidthAt = 16, kHeader = 24;
  const auto number = [&](std::size_t at) {
    std::uint32_t value = 0;
    for (std::size_t i = at; i < at + 4; ++i)
      value = value << 8 | static_cast<unsigned char>(bytes[i]);
    return value;
  };
  const bool fits = bytes.size() > kHeader && bytes.substr(1, 3) == "PNG" &&
                    number(kWidthAt) <= static_cast<std::uint32_t>(largest.width) &&
                    number(kWidthAt + 4) <= static_cast<std::uint32_t>(largest.height);
  return fits ? decodeDepth(bytes.data(), bytes.size()) : cv::Mat();
}

void decodeIntrinsics(std::string_view bytes, PinholeCamera& c) {
  const auto v = matrixOf<Eigen::Matrix<double, kIntrinsics, 1>>(bytes, "the camera");
  c.fx = v[0], c.fy = v[1], c.cx = v[2], c.cy = v[3];
  for (std::size_t i = 0; i < kIntrinsics - 4; ++i) {
    c.distortion[i] = v[static_cast<Eigen::Index>(4 + i)];
  }
}

std::int64_t checksumOf(std::string_view bytes) {
  std::uint64_t hash = 0xcbf29ce484222325ULL;
  for (std::size_t at = 0; at < bytes.size(); at += sizeof(std::uint64_t)) {
    std::uint64_t word = 0;
    std::memcpy(&word, bytes.data() + at, std::min(sizeof(word), bytes.size() - at));
    hash = (hash ^ word) * 0x100000001b3ULL;
    hash ^= hash >> 32;  // else high bits would never reach low ones
  }
  return static_cast<std::int64_t>(hash);
}

}  // namespace pf
