// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <algorithm>
#include <cmath>

#include "posefusion/map/fusion.hpp"
#include "small_camera.hpp"

namespace pf {

inline FrameConfig fullResolution() {
  FrameConfig config;
  config.shrink = 1;
  return config;
}

const cv::Rect kBoard(60, 40, 40, 40);

/// A wall at `wall_m` (0: no depth), and a red board before its middle where `board_m` > 0.
inline WorkingFrame scene(double wall_m, double board_m = 0, double noise_m = 0, int seed = 0) {
  RgbdFrame frame;
  frame.camera = smallCamera();
  frame.color = cv::Mat(120, 160, CV_8UC3, cv::Scalar(90, 90, 90));
  frame.depth = cv::Mat(120, 160, CV_32FC1, cv::Scalar(wall_m));
  if (board_m > 0) {
    frame.depth(kBoard).setTo(board_m);
    frame.color(kBoard).setTo(cv::Scalar(200, 0, 0));
  }
  if (noise_m > 0) {
    cv::Mat noise(frame.depth.size(), CV_32FC1);
    cv::RNG random(static_cast<std::uint64_t>(seed) + 17);
    random.fill(noise, cv::RNG::NORMAL, 0.0, noise_m);
    frame.depth += noise;
  }
  WorkingFrame working;
  working.assign(frame, cv::Mat(), fullResolution());
  return working;
}

const Eigen::Isometry3d kIdentity = Eigen::Isometry3d::Identity();

inline std::size_t countNear(const SurfelMap& map, double z, double tolerance = 0.05) {
  const auto all = map.collect().z;
  return static_cast<std::size_t>(std::count_if(
      all.begin(), all.end(), [&](float value) { return std::abs(value - z) < tolerance; }));
}

inline std::size_t stableNear(const SurfelMap& map, double z) {
  std::size_t count = 0;
  map.forEachSurfel([&](const SurfelArrays& s, std::size_t i) {
    count += map.isStable(s, i) && std::abs(s.z[i] - z) < 0.05 ? 1 : 0;
  });
  return count;
}

/// Fuses `frame` from `pose` so often.
inline void fuseOften(int times, const WorkingFrame& frame, SurfelMap& map,
                      const FusionOptions& options = {},
                      const Eigen::Isometry3d& pose = kIdentity) {
  Fuser fuser;
  for (int i = 0; i < times; ++i) fuser.fuse(frame, pose, map, options);
}

}  // namespace pf
