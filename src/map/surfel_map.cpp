// SPDX-License-Identifier: BSD-3-Clause
#include "posefusion/map/surfel_map.hpp"

#include <algorithm>
#include <cmath>

#include "posefusion/core/parallel.hpp"

namespace pf {
namespace {

// Blocks grow by this many surfels (8 kB), or by an eighth where that is more: little is reserved
// in vain, and no single step moves much.
constexpr std::size_t kChunk = 128;
constexpr std::size_t kGrowthShare = 8;
// What an integer can count; at any sensible side farther than floats resolve blocks.
constexpr float kCellLimit = 1e9F;

std::int32_t cellOf(float x, float side) {
  const float cell = std::floor(x / side);
  return static_cast<std::int32_t>(std::min(kCellLimit, std::max(-kCellLimit, cell)));
}

std::size_t roundedUp(std::size_t count) { return (count + kChunk - 1) / kChunk * kChunk; }

/// Least and largest of some numbers, of which there is at least one.
POSEFUSION_SIMD_CLONES
void findLimits(const float* numbers, std::size_t count, float& least, float& largest) {
  constexpr std::size_t kLanes = 16;
  float low[kLanes], high[kLanes];
  for (std::size_t k = 0; k < kLanes; ++k) low[k] = high[k] = numbers[0];
  std::size_t i = 0;
  for (; i + kLanes <= count; i += kLanes) {
    for (std::size_t k = 0; k < kLanes; ++k) {
      const float number = numbers[i + k];
      low[k] = number < low[k] ? number : low[k];
      high[k] = number > high[k] ? number : high[k];
    }
  }
  for (; i < count; ++i) {
    low[0] = std::min(low[0], numbers[i]);
    high[0] = std::max(high[0], numbers[i]);
  }
  least = *std::min_element(low, low + kLanes);
  largest = *std::max_element(high, high + kLanes);
}

void fit(const SurfelArrays& s, std::size_t first, SurfelBlock& block) {
  const std::size_t count = s.size() - first;
  if (count == 0) return;
  Eigen::Vector3f low, high;
  findLimits(&s.x[first], count, low.x(), high.x());
  findLimits(&s.y[first], count, low.y(), high.y());
  findLimits(&s.z[first], count, low.z(), high.z());
  block.bounds.extend(Eigen::AlignedBox3f(low, high));
  float least = 0, largest = 0;
  findLimits(&s.radius[first], count, least, largest);
  block.largest_radius = std::max(block.largest_radius, largest);
}

}  // namespace

std::size_t SurfelMap::size() const {
  std::size_t count = 0;
  for (const SurfelBlock& block : blocks_) count += block.surfels.size();
  return count;
}

std::size_t SurfelMap::stableCount() const {
  std::size_t count = 0;
  forEachSurfel([&](const SurfelArrays& s, std::size_t i) { count += isStable(s, i) ? 1 : 0; });
  return count;
}

std::vector<FragmentSurfels> SurfelMap::parts() const {
  std::vector<FragmentSurfels> parts;
  for (const SurfelBlock& block : blocks_) {
    if (parts.empty() || parts.back().fragment != block.fragment) {
      parts.push_back({block.fragment, {}});
    }
    parts.back().surfels.append(block.surfels);
  }
  return parts;
}

SurfelArrays SurfelMap::collect() const {
  SurfelArrays all;
  for (const SurfelBlock& block : blocks_) all.append(block.surfels);
  return all;
}

std::size_t SurfelMap::CellHash::operator()(const Cell& cell) const {
  std::uint64_t hash = 0;
  for (const std::int32_t number : {cell.fragment, cell.x, cell.y, cell.z}) {
    hash = (hash ^ static_cast<std::uint32_t>(number)) * 0x9e3779b97f4a7c15ULL;
    hash ^= hash >> 32;
  }
  return static_cast<std::size_t>(hash);
}

SurfelMap::Cell SurfelMap::cellAt(int fragment, float x, float y, float z) const {
  return {fragment, cellOf(x, block_side_m_), cellOf(y, block_side_m_), cellOf(z, block_side_m_)};
}

std::uint32_t SurfelMap::blockAt(const Cell& cell) {
  const auto found = index_.find(cell);
  if (found != index_.end()) return found->second;
  const auto limit = static_cast<std::size_t>(config_.memory_limit_mb * 1024.0 * 1024.0);
  if (memory_ + sizeof(SurfelBlock) + kChunk * SurfelArrays::bytesPerSurfel() > limit) {
    return kNoBlock;
  }
  memory_ += sizeof(SurfelBlock);
  const auto block = static_cast<std::uint32_t>(blocks_.size());
  blocks_.append().fragment = cell.fragment;
  index_.emplace(cell, block);
  return block;
}

std::size_t SurfelMap::makeRoom(SurfelBlock& block, std::size_t count) {
  const std::size_t size = block.surfels.size(), held = block.surfels.x.capacity();
  if (size + count <= held) return count;
  const auto limit = static_cast<std::size_t>(config_.memory_limit_mb * 1024.0 * 1024.0);
  const std::size_t left = (limit - std::min(limit, memory_)) / SurfelArrays::bytesPerSurfel();
  const std::size_t wanted = roundedUp(std::max(size + count, held + held / kGrowthShare));
  const std::size_t reserved = std::min(wanted, held + left);
  if (reserved > held) {
    block.surfels.forEachArray([&](auto& array) { array.reserve(reserved); });
    memory_ += (reserved - held) * SurfelArrays::bytesPerSurfel();
  }
  return std::min(count, reserved - size);
}

std::size_t SurfelMap::add(const SurfelArrays& s, int fragment) {
  // Bring the surfels of each block together, keeping their order.
  struct Group {
    std::uint32_t block;
    std::vector<std::uint32_t> members;
  };
  std::vector<Group> groups;
  std::unordered_map<std::uint32_t, std::size_t> group_of;
  std::uint32_t last_block = kNoBlock;
  std::size_t group = 0, finite = 0;
  for (std::size_t i = 0; i < s.size(); ++i) {
    if (!std::isfinite(s.x[i] + s.y[i] + s.z[i])) continue;
    ++finite;
    const std::uint32_t block = blockAt(cellAt(fragment, s.x[i], s.y[i], s.z[i]));
    if (block == kNoBlock) continue;
    if (block != last_block) {
      group = group_of.emplace(block, groups.size()).first->second;
      if (group == groups.size()) groups.push_back({block, {}});
      last_block = block;
    }
    groups[group].members.push_back(static_cast<std::uint32_t>(i));
  }
  std::size_t added = 0;
  for (Group& g : groups) {
    g.members.resize(makeRoom(blocks_.change(g.block), g.members.size()));
    added += g.members.size();
  }
  parallelFor(groups.size(), 1, [&](std::size_t begin, std::size_t end) {
    for (std::size_t k = begin; k < end; ++k) {
      SurfelBlock& block = blocks_.change(groups[k].block);
      const std::size_t first = block.surfels.size();
      block.surfels.append(s, groups[k].members.data(), groups[k].members.size());
      fit(block.surfels, first, block);
      block.any_unstable = true;
      block.changed = frame_;
    }
  });
  refused_ += finite - added;
  return added;
}

void SurfelMap::keepOnly(const std::vector<std::uint32_t>& kept, SurfelBlock& block) const {
  const std::size_t wanted = roundedUp(kept.size());
  const bool shrink = 2 * wanted < block.surfels.x.capacity();
  block.surfels.forEachArray([&](auto& array) {
    for (std::size_t k = 0; k < kept.size(); ++k) array[k] = array[kept[k]];
    array.resize(kept.size());
    if (!shrink) return;
    std::decay_t<decltype(array)> smaller;
    smaller.reserve(wanted);
    smaller.assign(array.begin(), array.end());
    array.swap(smaller);
  });
  refit(block);
}

/// The surfels have changed.
void SurfelMap::refit(SurfelBlock& block) const {
  block.changed = frame_;
  block.bounds.setEmpty();
  block.largest_radius = 0;
  fit(block.surfels, 0, block);
}

void SurfelMap::countMemory() {
  memory_ = 0;
  for (const SurfelBlock& block : blocks_) memory_ += block.memory();
}

void SurfelMap::clear() {
  blocks_.clear();
  index_.clear();
  frame_ = -1;
  memory_ = 0;
  refused_ = 0;
}

}  // namespace pf
