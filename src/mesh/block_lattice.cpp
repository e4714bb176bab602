// SPDX-License-Identifier: BSD-3-Clause
#include "posefusion/mesh/block_lattice.hpp"

#include <algorithm>
#include <utility>

namespace pf {
namespace {

constexpr unsigned kBits = 21;
constexpr std::uint64_t kMask = (std::uint64_t{1} << kBits) - 1;

}  // namespace

BlockLattice::BlockLattice(const Eigen::Vector3f& low, float cell_m,
                           std::vector<std::uint64_t> keys)
    : low_(low), cell_m_(cell_m), keys_(std::move(keys)) {
  std::sort(keys_.begin(), keys_.end());
  keys_.erase(std::unique(keys_.begin(), keys_.end()), keys_.end());
  places_.reserve(keys_.size());
  for (std::size_t i = 0; i < keys_.size(); ++i) places_[keys_[i]] = i;
}

std::uint64_t BlockLattice::keyOf(const Eigen::Vector3i& block) {
  std::uint64_t key = 0;
  for (const int axis : {2, 1, 0}) {
    key = key << kBits | (static_cast<std::uint64_t>(block[axis] + kFarthestBlock) & kMask);
  }
  return key;
}

Eigen::Vector3i BlockLattice::blockOf(std::uint64_t key) {
  Eigen::Vector3i block;
  for (int axis = 0; axis < 3; ++axis, key >>= kBits) {
    block[axis] = static_cast<int>(key & kMask) - kFarthestBlock;
  }
  return block;
}

std::size_t BlockLattice::find(const Eigen::Vector3i& block) const {
  const auto found = places_.find(keyOf(block));
  return found == places_.end() ? kNone : found->second;
}

}  // namespace pf
