// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <unordered_map>
#include <vector>

namespace pf {

/// Corners of a cubic lattice, in blocks of kSide^3 of them, as far as there is something to say of
/// them. A corner has the place x + kSide (y + kSide z) in its block, and the cell above it the
/// same. Blocks are in the order of their keys, whatever order they were named in.
class BlockLattice {
 public:
  static constexpr int kSide = 8;
  static constexpr std::size_t kCorners = kSide * kSide * kSide;
  static constexpr std::size_t kNone = ~std::size_t{0};
  /// Blocks are counted along each axis from the origin, to less than this either way.
  static constexpr int kFarthestBlock = 1 << 20;

  /// `low`: the corner (0, 0, 0) of block (0, 0, 0), m. `keys`: of the blocks, may repeat.
  BlockLattice(const Eigen::Vector3f& low, float cell_m, std::vector<std::uint64_t> keys);

  static std::uint64_t keyOf(const Eigen::Vector3i& block);
  static Eigen::Vector3i blockOf(std::uint64_t key);

  std::size_t size() const { return keys_.size(); }
  float cell_m() const { return cell_m_; }
  const Eigen::Vector3f& low() const { return low_; }
  Eigen::Vector3i block(std::size_t i) const { return blockOf(keys_[i]); }

  /// The place of a block in this order, or kNone.
  std::size_t find(const Eigen::Vector3i& block) const;

  /// A corner (m) by its number along each axis from `low`.
  Eigen::Vector3f point(const Eigen::Vector3i& corner) const {
    return low_ + cell_m_ * corner.cast<float>();
  }
  /// The number of the first corner of block i along each axis.
  Eigen::Vector3i firstCorner(std::size_t i) const { return kSide * block(i); }

  static std::size_t placeOf(int x, int y, int z) {
    return static_cast<std::size_t>(x + kSide * (y + kSide * z));
  }

 private:
  Eigen::Vector3f low_;
  float cell_m_;
  std::vector<std::uint64_t> keys_;  ///< ascending
  std::unordered_map<std::uint64_t, std::size_t> places_;
};

}  // namespace pf
