// SPDX-License-Identifier: BSD-3-Clause
#include "posefusion/evaluation/known_world.hpp"

#include <algorithm>
#include <cmath>

#include "posefusion/core/error.hpp"
#include "posefusion/frame/depth_filter.hpp"

namespace pf {
namespace {

constexpr int kStride = 8;  // pixels: a share needs no more
constexpr double kMaxDepth_m = 5.0, kVoxel_m = 0.1;

/// Packed, 20 bits for each coordinate.
std::uint64_t voxelAt(const Eigen::Vector3d& point) {
  std::uint64_t voxel = 0;
  for (int k = 0; k < 3; ++k) {
    const auto cell = static_cast<std::int64_t>(std::floor(point[k] / kVoxel_m)) + (1 << 19);
    voxel = voxel << 20 | (static_cast<std::uint64_t>(cell) & 0xfffffU);
  }
  return voxel;
}

}  // namespace

KnownWorld::View KnownWorld::look(const RgbdFrame& frame, const cv::Mat& mask,
                                  const Eigen::Isometry3d& T_world_camera) {
  depthInMetres(frame, 0.0, kMaxDepth_m, depth_m_);
  if (!mask.empty() && (mask.type() != CV_8UC1 || mask.size() != depth_m_.size())) {
    throw InputError("the mask of people is not of 8 bits and the size of the depth image");
  }
  seen_.clear();
  std::size_t pixels = 0, known = 0;
  for (int v = 0; v < depth_m_.rows; v += kStride) {
    for (int u = 0; u < depth_m_.cols; u += kStride) {
      ++pixels;
      const float z = depth_m_.at<float>(v, u);
      if (z <= 0 || (!mask.empty() && mask.at<std::uint8_t>(v, u) != 0)) continue;
      seen_.push_back(voxelAt(T_world_camera * frame.camera.unproject(u, v, z)));
      known += known_.count(seen_.back());
    }
  }
  const auto share = [](std::size_t part, std::size_t whole) {
    return static_cast<double>(part) / static_cast<double>(std::max<std::size_t>(1, whole));
  };
  return {share(seen_.size(), pixels), share(known, seen_.size())};
}

void KnownWorld::learn() { known_.insert(seen_.begin(), seen_.end()); }

}  // namespace pf
