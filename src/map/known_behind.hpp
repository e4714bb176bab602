// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <opencv2/core.hpp>
#include <vector>

namespace pf {

/// Where what a frame sees stands well before a surface that the map knows: something that came, or
/// that was hidden until now. Kept for cells of some pixels, for surfels may be sparser than
/// pixels.
class KnownBehind {
 public:
  /// Nothing is known yet of an image of this size.
  void assign(const cv::Size& size) {
    cols_ = (size.width + kCell_px - 1) / kCell_px;
    cells_.assign(static_cast<std::size_t>(cols_) *
                      static_cast<std::size_t>((size.height + kCell_px - 1) / kCell_px),
                  0);
  }

  /// Threads may call it at once.
  void mark(int u, int v) { __atomic_store_n(&cells_[at(u, v)], kMarked, __ATOMIC_RELAXED); }

  bool has(int u, int v) const { return cells_[at(u, v)] != 0; }

 private:
  static constexpr int kCell_px = 4;
  static constexpr std::uint8_t kMarked = 1;

  std::size_t at(int u, int v) const {
    return static_cast<std::size_t>((v / kCell_px) * cols_ + u / kCell_px);
  }

  std::vector<std::uint8_t> cells_;
  int cols_ = 0;
};

}  // namespace pf
