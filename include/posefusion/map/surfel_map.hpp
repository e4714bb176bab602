// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Geometry>
#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <numeric>
#include <unordered_map>
#include <vector>

#include "posefusion/core/depth_sensor.hpp"
#include "posefusion/core/pace.hpp"
#include "posefusion/core/static_odds.hpp"
#include "posefusion/map/config.hpp"
#include "posefusion/map/shared_blocks.hpp"
#include "posefusion/map/surfels.hpp"

namespace pf {

/// The surfels, in blocks, and the frame clock. A frame touches only the blocks in view, so that
/// its cost does not grow with the map. Fragments share the clock and the memory, no block: what
/// works at a place works in one of them. Has one owner (the mapper); changed by Fuser, add(),
/// removeIf() and move(). A copy shares the blocks until either changes them (SharedBlocks), so
/// that it costs next to nothing, and belongs to any thread. The order of blocks and of surfels in
/// them depends neither on threads nor on hashing.
class SurfelMap {
 public:
  /// Side of a block (m): about 5,000 surfels of a surface seen at 2 m with half resolution. Much
  /// smaller ones cost more to visit than they save, larger ones reach too far out of view.
  static constexpr float kBlockSide_m = 0.5F;

  explicit SurfelMap(const MapConfig& config, float block_side_m = kBlockSide_m,
                     const DepthSensor& sensor = {})
      : config_(config),
        sensor_(sensor),
        block_side_m_(block_side_m),
        stable_odds_(static_odds::of(config.stable_probability)) {}

  const MapConfig& config() const { return config_; }

  /// That measures the surfels: how far apart those of one surface may be.
  const DepthSensor& sensor() const { return sensor_; }

  /// Number of the last fused frame, from 0; -1 while the map is empty.
  int frame() const { return frame_; }
  /// `pace`: of the frames.
  void advance(const Pace& pace = {}) {
    ++frame_;
    active_frames_ = pace.framesIn(config_.active_window_s);
    unstable_frames_ = pace.framesIn(config_.max_unstable_age_s);
  }

  /// In the order in which they were made; a block may be empty.
  const SharedBlocks& blocks() const { return blocks_; }
  std::size_t size() const;
  std::size_t stableCount() const;

  bool isActive(const SurfelArrays& s, std::size_t i) const {
    return frame_ - s.seen[i] <= active_frames_;
  }
  bool isStable(const SurfelArrays& s, std::size_t i) const { return s.odds[i] >= stable_odds_; }
  /// Refuted, or unstable and not supported for long: gone for fusion and rendering,
  /// though its memory may be swept up some frames later.
  bool isDead(const SurfelArrays& s, std::size_t i) const {
    if (s.odds[i] <= static_odds::kGone) return true;
    return !isStable(s, i) && frame_ - s.seen[i] > unstable_frames_;
  }

  /// Calls visit(surfels, i) for each surfel, block by block.
  template <typename Visit>
  void forEachSurfel(const Visit& visit) const {
    for (const SurfelBlock& block : blocks_) {
      for (std::size_t i = 0; i < block.surfels.size(); ++i) visit(block.surfels, i);
    }
  }

  /// The same of one fragment.
  template <typename Visit>
  void forEachSurfelOf(int fragment, const Visit& visit) const {
    for (const SurfelBlock& block : blocks_) {
      if (block.fragment != fragment) continue;
      for (std::size_t i = 0; i < block.surfels.size(); ++i) visit(block.surfels, i);
    }
  }

  /// A copy of all surfels, block by block; consecutive blocks of a fragment are one part.
  std::vector<FragmentSurfels> parts() const;

  /// The same without the fragments.
  SurfelArrays collect() const;

  /// Puts surfels of a fragment into their blocks, in their order, as far as memory lasts; the
  /// others are refused. Positions that are not finite are left out. Returns how many were added.
  std::size_t add(const SurfelArrays& surfels, int fragment = kFirstFragment);

  /// Removes the surfels for which doomed(surfels, i) holds, keeping the order of the others. It is
  /// asked once for each, in the order of forEachSurfel().
  template <typename Doomed>
  std::size_t removeIf(const Doomed& doomed) {
    std::size_t removed = 0;
    for (std::size_t i = 0; i < blocks_.size(); ++i) removed += removeFrom(i, doomed);
    countMemory();
    return removed;
  }

  /// Removes what is in the fragments for which doomed(fragment) holds.
  template <typename Doomed>
  void removeFragments(const Doomed& doomed) {
    for (std::size_t i = 0; i < blocks_.size(); ++i) {
      if (doomed(blocks_[i].fragment)) keepOnly({}, blocks_.change(i));
    }
    countMemory();
  }

  /// How blocks are moved: whether anything in a block moves, and what moves it.
  struct Mover {
    std::function<bool(const SurfelBlock&)> moves;
    std::function<void(SurfelArrays&, int fragment)> move;
    std::function<int(int)> fragment_after{};  ///< none: all stay what they are
  };

  /// Moves the surfels of some blocks, block by block in parallel, and takes fragments into others.
  /// All stay in their blocks, wherever those lie then, and in their order. What does not move
  /// keeps all its bits.
  void move(const Mover& mover, const std::vector<std::uint32_t>& blocks);

  /// A copy to be corrected elsewhere, and not added to: blocks that were changed in frame
  /// `since_frame` or later are empty in it. Those would have to be copied with the next frame.
  SurfelMap resting(int since_frame) const;

  /// Takes up such a copy once it is corrected; `before`: as it was first. Blocks that have
  /// changed here meanwhile, or are new, stay as they are: returns their places, ascending. The
  /// blocks given up are then in `corrected`.
  std::vector<std::uint32_t> takeUp(const SurfelMap& before, SurfelMap& corrected);

  /// Memory (bytes) that the blocks hold, used or reserved; never above memory_limit_mb.
  std::size_t memory() const { return memory_; }

  /// Surfels that the memory limit kept out since the last clear().
  std::size_t refused() const { return refused_; }

  void clear();

  /// Takes up a saved map: these surfels, and the number of its last frame.
  void restore(const std::vector<FragmentSurfels>& parts, int frame) {
    clear();
    frame_ = frame;
    for (const FragmentSurfels& part : parts) add(part.surfels, part.fragment);
  }

 private:
  friend class Fuser;

  /// A cube of a fragment, counted along each axis from its origin.
  struct Cell {
    std::int32_t fragment = kFirstFragment, x = 0, y = 0, z = 0;
    bool operator==(const Cell& other) const {
      return fragment == other.fragment && x == other.x && y == other.y && z == other.z;
    }
  };
  struct CellHash {
    std::size_t operator()(const Cell& cell) const;
  };

  /// The cube around a point, and the block of it, made when it is new; none when there is no
  /// memory for it.
  static constexpr std::uint32_t kNoBlock = ~std::uint32_t{0};
  Cell cellAt(int fragment, float x, float y, float z) const;
  std::uint32_t blockAt(const Cell& cell);
  /// Reserves memory in a block; returns for how many of `count` more surfels there is room.
  std::size_t makeRoom(SurfelBlock& block, std::size_t count);
  /// Sums up the memory anew, after surfels were removed.
  void countMemory();

  template <typename Doomed>
  std::size_t removeFrom(std::size_t block, const Doomed& doomed);
  /// Keeps the surfels named (ascending), gives memory back and fits the bounds.
  void keepOnly(const std::vector<std::uint32_t>& kept, SurfelBlock& block) const;
  void refit(SurfelBlock& block) const;

  MapConfig config_;
  DepthSensor sensor_;
  float block_side_m_;
  float stable_odds_;
  SharedBlocks blocks_;
  std::unordered_map<Cell, std::uint32_t, CellHash> index_;
  int frame_ = -1;
  // At the pace of the last frame:
  int active_frames_ = Pace().framesIn(config_.active_window_s);
  int unstable_frames_ = Pace().framesIn(config_.max_unstable_age_s);
  std::size_t memory_ = 0;
  std::size_t refused_ = 0;
};

/// The places of all blocks.
inline std::vector<std::uint32_t> allBlocks(const SurfelMap& map) {
  std::vector<std::uint32_t> all(map.blocks().size());
  std::iota(all.begin(), all.end(), 0U);
  return all;
}

template <typename Doomed>
std::size_t SurfelMap::removeFrom(std::size_t block, const Doomed& doomed) {
  std::vector<std::uint32_t> kept;
  const SurfelArrays& surfels = blocks_[block].surfels;
  const std::size_t size = surfels.size();
  kept.reserve(size);
  for (std::size_t i = 0; i < size; ++i) {
    if (!doomed(surfels, i)) kept.push_back(static_cast<std::uint32_t>(i));
  }
  if (kept.size() < size) keepOnly(kept, blocks_.change(block));
  return size - kept.size();
}

}  // namespace pf
