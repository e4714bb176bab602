// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <array>
#include <cmath>
#include <cstddef>
#include <opencv2/core.hpp>

#include "posefusion/frame/working_frame.hpp"

namespace pf {

/// What a frame measures, as densely as depth can tell its pixels apart: a near surface in the
/// finest picture, farther ones in pictures halved once or more, to that of tracking. Surfels are
/// made of its pixels and compared with them, so that each is as large as its surface is known
/// well.
class MeasuredSurface {
 public:
  static constexpr int kMostLevels = 4;

  /// One picture. Its pixel (u, v) is of the rays around ((u - cx) / fx, (v - cy) / fy, 1).
  struct Level {
    cv::Mat depth_m;                       ///< CV_32FC1, 0 = none
    cv::Mat color;                         ///< CV_8UC3 R G B
    float fx = 1, fy = 1, cx = 0, cy = 0;  ///< pixels
    float scale = 1;                       ///< its pixels for one of the working frame's, across
    std::size_t first = 0;  ///< of its pixels, where those of all levels stand in a row

    std::size_t at(int u, int v) const {
      return first + static_cast<std::size_t>(v) * static_cast<std::size_t>(depth_m.cols) +
             static_cast<std::size_t>(u);
    }
    float rayX(int u) const { return (static_cast<float>(u) - cx) / fx; }
    float rayY(int v) const { return (static_cast<float>(v) - cy) / fy; }
  };

  /// The finest level is the frame's picture shrunk by `shrink`, no other is coarser than the
  /// working frame. Shares the frame's images and reuses its own.
  void assign(const WorkingFrame& frame, int shrink);

  int levels() const { return levels_; }
  const Level& operator[](int level) const { return level_[static_cast<std::size_t>(level)]; }

  /// The level that shows a surface at z (m): the finest on which pixels lie so far apart that
  /// their depths tell more than noise.
  int levelOf(float z) const {
    const float needed = kSpacing_sigmas * sensor_.sigma(z);
    float spacing = z * spacing_rad_;
    int level = 0;
    for (; level < levels_ - 1 && spacing < needed; ++level) spacing *= 2.0F;
    return level;
  }

  /// Of all levels.
  std::size_t pixels() const { return pixels_; }

  /// Normal of the surface at `depth` (m) in pixel (u, v) of the working frame; 0 where there is
  /// none, or another surface's.
  Eigen::Vector3f normal(int u, int v, float depth) const {
    const float* seen = frame_->depth_m.ptr<float>(v);
    if (std::abs(seen[u] - depth) > agreement(depth)) return Eigen::Vector3f::Zero();
    const FrameLevel& level = frame_->levels[0];
    return {level.normal_x.ptr<float>(v)[u], level.normal_y.ptr<float>(v)[u],
            level.normal_z.ptr<float>(v)[u]};
  }

  /// Depths closer than this (m) measure the same surface.
  float agreement(float z) const { return sensor_.tolerance(z, 5.0F); }

 private:
  // Pixels closer together than half a standard deviation of depth draw noise, no shape.
  static constexpr float kSpacing_sigmas = 0.5F;

  void setLevel(int level, int shrink, int tracked);

  const WorkingFrame* frame_ = nullptr;
  DepthSensor sensor_;
  float spacing_rad_ = 1;  // of the finest level's pixels
  int levels_ = 0;
  std::size_t pixels_ = 0;
  std::array<Level, kMostLevels> level_;
  std::array<cv::Mat, kMostLevels> own_depth_m_, own_color_;
};

}  // namespace pf
