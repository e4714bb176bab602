// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <opencv2/core.hpp>
#include <vector>

#include "posefusion/core/camera.hpp"

namespace pf {

/// The space around the people of a frame, as a coarse grid over the picture.
class NearPeople {
 public:
  /// How far a person walking in gets in a third of a second.
  static constexpr float kReach_m = 0.3F;

  /// `people_m`: depth of people, 0 = none, size of the working camera's picture. Reuses memory.
  void assign(const cv::Mat& people_m, const PinholeCamera& camera);
  void clear() { near_.clear(); }

  /// Whether a point seen at the pixel (u, v) of the picture at depth z (m) lies within reach.
  bool has(int u, int v, float z) const {
    if (near_.empty()) return false;
    const Range& range = near_[(v / kCell_px) * cols_ + u / kCell_px];
    return z > range.nearest_m && z < range.farthest_m;
  }

 private:
  static constexpr int kCell_px = 8;
  struct Range {
    float nearest_m = 1e9F, farthest_m = 0.0F;
    void extend(const Range& other);
  };

  int cols_ = 0, rows_ = 0;
  std::vector<Range> people_, near_;
};

}  // namespace pf
