// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Geometry>
#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <unordered_map>
#include <utility>
#include <vector>

namespace pf {

/// Points in cells of space; finds those in a box. Threads may share it.
class PointGrid {
 public:
  /// The points, which must outlive this, have coordinates below 10 km; cells are 1 cm or more.
  explicit PointGrid(const std::vector<Eigen::Vector3f>& points, float cell_m = 0.05F)
      : points_(points), cell_m_(cell_m), order_(points.size()) {
    std::vector<std::pair<std::uint64_t, std::uint32_t>> keyed(points.size());
    for (std::size_t i = 0; i < points.size(); ++i) {
      keyed[i] = {keyOf(cellOf(points[i])), static_cast<std::uint32_t>(i)};
    }
    std::sort(keyed.begin(), keyed.end());
    for (std::size_t k = 0; k < keyed.size(); ++k) {
      order_[k] = keyed[k].second;
      auto& range = cells_.try_emplace(keyed[k].first, k, k).first->second;
      range.second = k + 1;
    }
  }

  /// Calls visit(i) for all points in the cells that the box touches, in an order that depends on
  /// the points alone.
  template <typename Visit>
  void visit(const Eigen::AlignedBox3f& box, const Visit& visit) const {
    const Eigen::Vector3i low = cellOf(box.min()), high = cellOf(box.max());
    for (int x = low.x(); x <= high.x(); ++x) {
      for (int y = low.y(); y <= high.y(); ++y) {
        for (int z = low.z(); z <= high.z(); ++z) {
          const auto cell = cells_.find(keyOf({x, y, z}));
          if (cell == cells_.end()) continue;
          for (std::size_t k = cell->second.first; k < cell->second.second; ++k) visit(order_[k]);
        }
      }
    }
  }

  const Eigen::Vector3f& operator[](std::size_t i) const { return points_[i]; }

 private:
  Eigen::Vector3i cellOf(const Eigen::Vector3f& p) const {
    return (p / cell_m_).array().floor().cast<int>();
  }
  static std::uint64_t keyOf(const Eigen::Vector3i& cell) {
    constexpr std::uint64_t kBits = 21, kMask = (1U << kBits) - 1;  // 10 km of 1 cm
    return (static_cast<std::uint64_t>(cell.x()) & kMask) << (2 * kBits) |
           (static_cast<std::uint64_t>(cell.y()) & kMask) << kBits |
           (static_cast<std::uint64_t>(cell.z()) & kMask);
  }

  const std::vector<Eigen::Vector3f>& points_;
  float cell_m_;
  std::vector<std::uint32_t> order_;
  std::unordered_map<std::uint64_t, std::pair<std::size_t, std::size_t>> cells_;
};

}  // namespace pf
