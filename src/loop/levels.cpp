// SPDX-License-Identifier: BSD-3-Clause
#include <algorithm>
#include <cmath>

#include "posefusion/core/symmetric.hpp"

#include "posefusion/loop/map_points.hpp"

namespace pf {
namespace {

constexpr double kBundle_rad = 0.105;
constexpr double kLeast = 0.05;      // part of the points
constexpr float kThick_m = 0.06F;    // of a level
constexpr double kManyOfThem = 0.1;  // part of what faces up that makes a level large

Eigen::Vector3d point(const OrientedPoints& p, std::size_t i) { return {p.x[i], p.y[i], p.z[i]}; }
Eigen::Vector3d normal(const OrientedPoints& p, std::size_t i) {
  return {p.nx[i], p.ny[i], p.nz[i]};
}

/// The points whose normals lie near a direction; only each `stride`-th is looked at.
std::vector<std::size_t> facing(const OrientedPoints& p, const Eigen::Vector3d& direction,
                                std::size_t stride) {
  const double least = std::cos(kBundle_rad);
  std::vector<std::size_t> found;
  for (std::size_t i = 0; i < p.count; i += stride) {
    if (normal(p, i).dot(direction) >= least) found.push_back(i);
  }
  return found;
}

/// The normal that most others lie near.
Eigen::Vector3d mostCommon(const OrientedPoints& p, const Eigen::Vector3d& guess,
                           double min_cosine) {
  constexpr std::size_t kTries = 200, kVoters = 2000;
  Eigen::Vector3d best = guess;
  std::size_t most = 0;
  for (std::size_t i = 0; i < p.count; i += std::max<std::size_t>(1, p.count / kTries)) {
    if (normal(p, i).dot(guess) < min_cosine) continue;
    const auto votes = facing(p, normal(p, i), std::max<std::size_t>(1, p.count / kVoters)).size();
    if (votes <= most) continue;
    most = votes;
    best = normal(p, i);
  }
  return best;
}

/// Runs of `members`, which become sorted by height, that lie within one thickness.
template <typename Visit>
void forLevels(const OrientedPoints& p, const Eigen::Vector3d& up,
               std::vector<std::size_t>& members, const Visit& visit) {
  std::vector<std::pair<double, std::size_t>> heights;
  for (const std::size_t i : members) heights.emplace_back(up.dot(point(p, i)), i);
  std::sort(heights.begin(), heights.end());
  for (std::size_t k = 0; k < heights.size(); ++k) members[k] = heights[k].second;
  std::size_t end = 0;
  for (std::size_t begin = 0; begin < heights.size(); ++begin) {
    while (end < heights.size() && heights[end].first < heights[begin].first + kThick_m) ++end;
    visit(begin, end, heights[(begin + end) / 2].first);
  }
}

/// Normal of the plane through the largest level.
Eigen::Vector3d fitLargest(const OrientedPoints& p, const Eigen::Vector3d& up,
                           std::vector<std::size_t>& members) {
  std::size_t first = 0, last = 0;
  forLevels(p, up, members, [&](std::size_t begin, std::size_t end, double) {
    if (end - begin > last - first) first = begin, last = end;
  });
  Eigen::Vector3d mean = Eigen::Vector3d::Zero();
  for (std::size_t k = first; k < last; ++k) mean += point(p, members[k]);
  mean /= static_cast<double>(std::max<std::size_t>(1, last - first));
  Eigen::Matrix3d scatter = Eigen::Matrix3d::Zero();
  for (std::size_t k = first; k < last; ++k) {
    const Eigen::Vector3d d = point(p, members[k]) - mean;
    scatter += d * d.transpose();
  }
  const Eigen::Vector3d fitted = eigenOf(scatter).vectors.col(0);
  return fitted.dot(up) < 0 ? Eigen::Vector3d(-fitted) : fitted;
}

}  // namespace

OrientedPoints orientedPoints(const MapPoints& p) {
  return {p.x.data(), p.y.data(), p.z.data(), p.nx.data(), p.ny.data(), p.nz.data(), p.size()};
}

std::optional<Levels> findLevels(const OrientedPoints& points, const Eigen::Vector3d& guess,
                                 double max_angle_rad) {
  constexpr int kFits = 4;
  const double min_cosine = std::cos(max_angle_rad);
  const Eigen::Vector3d about = guess.normalized();
  Levels levels{mostCommon(points, about, min_cosine), 0};
  for (int i = 0; i < kFits; ++i) {
    std::vector<std::size_t> members = facing(points, levels.up, 1);
    if (members.size() < 10 ||
        static_cast<double>(members.size()) < kLeast * static_cast<double>(points.count)) {
      return {};
    }
    const Eigen::Vector3d fitted = fitLargest(points, levels.up, members);
    // A narrow level (the rim of a table) may fit any plane through it.
    if (fitted.dot(levels.up) > std::cos(kBundle_rad)) levels.up = fitted;
  }
  if (levels.up.dot(about) < min_cosine) return {};
  std::vector<std::size_t> members = facing(points, levels.up, 1);
  const double many = kManyOfThem * static_cast<double>(members.size());
  bool found = false;
  forLevels(points, levels.up, members, [&](std::size_t begin, std::size_t end, double height) {
    if (found || static_cast<double>(end - begin) < many) return;
    found = true;
    levels.lowest_m = height;
  });
  return levels;
}

}  // namespace pf
