// SPDX-License-Identifier: BSD-3-Clause
#include "near_people.hpp"

#include <algorithm>
#include <cmath>

namespace pf {

void NearPeople::Range::extend(const Range& other) {
  nearest_m = std::min(nearest_m, other.nearest_m);
  farthest_m = std::max(farthest_m, other.farthest_m);
}

void NearPeople::assign(const cv::Mat& people_m, const PinholeCamera& camera) {
  cols_ = (people_m.cols + kCell_px - 1) / kCell_px;
  rows_ = (people_m.rows + kCell_px - 1) / kCell_px;
  people_.assign(static_cast<std::size_t>(cols_ * rows_), Range());
  near_.assign(people_.size(), Range());
  for (int v = 0; v < people_m.rows; ++v) {
    const auto* row = people_m.ptr<float>(v);
    Range* cells = &people_[static_cast<std::size_t>((v / kCell_px) * cols_)];
    for (int u = 0; u < people_m.cols; ++u) {
      if (row[u] > 0) cells[u / kCell_px].extend({row[u], row[u]});
    }
  }
  for (int y = 0; y < rows_; ++y) {
    for (int x = 0; x < cols_; ++x) {
      const Range& person = people_[static_cast<std::size_t>(y * cols_ + x)];
      if (person.farthest_m <= 0) continue;
      const Range reached{person.nearest_m - kReach_m, person.farthest_m + kReach_m};
      const double pixels = camera.fx * kReach_m / person.nearest_m;
      const int reach = static_cast<int>(std::ceil(pixels / kCell_px));
      for (int v = std::max(0, y - reach); v <= std::min(rows_ - 1, y + reach); ++v) {
        for (int u = std::max(0, x - reach); u <= std::min(cols_ - 1, x + reach); ++u) {
          near_[static_cast<std::size_t>(v * cols_ + u)].extend(reached);
        }
      }
    }
  }
}

}  // namespace pf
