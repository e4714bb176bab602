// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <opencv2/core.hpp>
#include <random>
#include <set>
#include <tuple>

#include "posefusion/map/surfel_map.hpp"
#include "small_camera.hpp"

namespace pf {

/// So large that a map is hardly divided.
constexpr float kOneBlock = 1e4F;

/// Stable discs all over a cube of `side_m`, with random normals.
inline SurfelArrays cloud(std::size_t count, float side_m, int seed = 3) {
  std::mt19937 random(static_cast<unsigned>(seed));
  std::uniform_real_distribution<float> place(-0.5F * side_m, 0.5F * side_m);
  std::normal_distribution<float> axis;
  SurfelArrays s;
  s.resize(count);
  for (std::size_t i = 0; i < count; ++i) {
    s.x[i] = place(random);
    s.y[i] = place(random);
    s.z[i] = place(random);
    const Eigen::Vector3f n =
        Eigen::Vector3f(axis(random), axis(random), axis(random)).normalized();
    s.nx[i] = n.x();
    s.ny[i] = n.y();
    s.nz[i] = n.z();
    s.r[i] = s.g[i] = s.b[i] = static_cast<float>(i % 256);
    s.radius[i] = 0.01F + 0.02F * static_cast<float>(i % 7);
    s.weight[i] = 50;
    s.odds[i] = static_odds::kMost;
  }
  return s;
}

inline SurfelMap mapOf(const SurfelArrays& surfels, float block_side_m = SurfelMap::kBlockSide_m) {
  SurfelMap map(MapConfig{}, block_side_m);
  map.advance();
  map.add(surfels);
  return map;
}

/// A wall with a board before it that comes and goes, noisy, from a camera that moves.
inline WorkingFrame noisyFrame(int i) {
  RgbdFrame frame;
  frame.camera = smallCamera();
  frame.color = cv::Mat(120, 160, CV_8UC3, cv::Scalar(90 + i, 90, 90));
  frame.depth = cv::Mat(120, 160, CV_32FC1, cv::Scalar(2.0));
  if (i % 9 < 6) frame.depth(cv::Rect(60, 40, 40, 40)).setTo(1.3);
  cv::Mat noise(frame.depth.size(), CV_32FC1);
  cv::RNG generator(static_cast<std::uint64_t>(i) + 5);
  generator.fill(noise, cv::RNG::NORMAL, 0.0, 0.004);
  frame.depth += noise;
  WorkingFrame working;
  FrameConfig config;
  config.shrink = 1;
  working.assign(frame, cv::Mat(), config);
  return working;
}

using Row = std::tuple<float, float, float, float, float, float, float, int>;

/// The surfels without their order.
inline std::multiset<Row> rowsOf(const SurfelArrays& s) {
  std::multiset<Row> rows;
  for (std::size_t i = 0; i < s.size(); ++i) {
    rows.emplace(s.x[i], s.y[i], s.z[i], s.nx[i], s.r[i], s.weight[i], s.odds[i], s.seen[i]);
  }
  return rows;
}

}  // namespace pf
