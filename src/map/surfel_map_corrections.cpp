// SPDX-License-Identifier: BSD-3-Clause
// The map moves, here or on a copy that other threads correct.
#include <iterator>

#include "posefusion/core/parallel.hpp"
#include "posefusion/map/surfel_map.hpp"

namespace pf {
namespace {

constexpr std::size_t kBlocksAtOnce = 256;  // blocks

}  // namespace

void SurfelMap::move(const Mover& mover, const std::vector<std::uint32_t>& blocks) {
  parallelFor(blocks.size(), 1, [&](std::size_t begin, std::size_t end) {
    for (std::size_t k = begin; k < end; ++k) {
      const SurfelBlock& seen = blocks_[blocks[k]];
      const int fragment =
          mover.fragment_after ? mover.fragment_after(seen.fragment) : seen.fragment;
      const bool moves = mover.moves(seen);
      if (!moves && fragment == seen.fragment) continue;
      SurfelBlock& block = blocks_.change(blocks[k]);
      if (moves) mover.move(block.surfels, block.fragment);
      block.fragment = fragment;
      refit(block);
    }
  });
  if (!mover.fragment_after) return;
  // Where a fragment has gone, new surfels come into new blocks: its cubes are not those.
  for (auto entry = index_.begin(); entry != index_.end();) {
    const int fragment = entry->first.fragment;
    entry = mover.fragment_after(fragment) == fragment ? std::next(entry) : index_.erase(entry);
  }
}

SurfelMap SurfelMap::resting(int since_frame) const {
  SurfelMap copy(config_, block_side_m_, sensor_);
  copy.blocks_ = blocks_;
  for (std::size_t i = 0; i < blocks_.size(); ++i) {
    if (blocks_[i].changed >= since_frame) copy.blocks_.drop(i);
  }
  copy.frame_ = frame_;
  copy.active_frames_ = active_frames_;
  copy.unstable_frames_ = unstable_frames_;
  return copy;
}

std::vector<std::uint32_t> SurfelMap::takeUp(const SurfelMap& before, SurfelMap& corrected) {
  std::vector<std::uint32_t> changed;
  for (std::size_t i = 0; i < blocks_.size(); ++i) {
    if (!blocks_.isShared(i, before.blocks_)) changed.push_back(static_cast<std::uint32_t>(i));
  }
  memory_ += deterministicSum<std::size_t>(
      before.blocks_.size(), kBlocksAtOnce, [&](std::size_t begin, std::size_t end) {
        std::size_t more = 0;  // modulo 2^64: may be less
        for (std::size_t i = begin; i < end; ++i) {
          const bool is_new = !corrected.blocks_.isShared(i, before.blocks_);
          if (!is_new || !blocks_.isShared(i, before.blocks_)) continue;
          blocks_.swap(i, corrected.blocks_);
          blocks_.change(i).changed = frame_;
          more += blocks_[i].memory() - before.blocks_[i].memory();
        }
        return more;
      });
  return changed;
}

}  // namespace pf
