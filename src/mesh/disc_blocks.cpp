// SPDX-License-Identifier: BSD-3-Clause
#include <tbb/parallel_sort.h>

#include <algorithm>
#include <cstdio>
#include <string>

#include "discs.hpp"
#include "posefusion/core/error.hpp"
#include "posefusion/core/parallel.hpp"

namespace pf {
namespace {

constexpr std::size_t kDiscsAtOnce = 4096;
// What a block takes: distance and vertex of each corner, and about 1.5 layers of vertices and
// triangles, in pieces and as a whole.
constexpr double kBytesPerBlock = 10'000;

/// One disc and one block that it reaches.
struct Entry {
  std::uint64_t block = 0;
  std::uint32_t surfel = 0;
};

int blockOf(int cell) {
  return cell >= 0 ? cell / BlockLattice::kSide : -1 - (-1 - cell) / BlockLattice::kSide;
}

/// The same in blocks.
CellRange blocksOf(const CellRange& cells) {
  return {cells.low.unaryExpr(&blockOf), cells.high.unaryExpr(&blockOf)};
}

std::size_t countOf(const CellRange& range) {
  return static_cast<std::size_t>((range.high - range.low + Eigen::Vector3i::Ones()).prod());
}

[[noreturn]] void refuse(double mb, const MeshConfig& config) {
  char text[200];
  std::snprintf(text, sizeof text,
                "a mesh with cells of %g m takes about %.0f MB: expected at most %.0f MB (larger "
                "cells, or a larger memory limit)",
                config.cell_m, mb, config.memory_limit_mb);
  throw InputError(text);
}

/// How many blocks each surfel reaches.
std::vector<std::uint32_t> blockCounts(const DiscMaker& maker, std::size_t surfels) {
  std::vector<std::uint32_t> counts(surfels, 0);
  parallelFor(surfels, kDiscsAtOnce, [&](std::size_t begin, std::size_t end) {
    Disc disc;
    CellRange range;
    for (std::size_t i = begin; i < end; ++i) {
      if (!maker.make(i, disc) || !maker.cells(disc, range)) continue;
      counts[i] = static_cast<std::uint32_t>(std::min<std::size_t>(countOf(blocksOf(range)), 1e9));
    }
  });
  return counts;
}

/// All pairs of surfel and block, block by block.
std::vector<Entry> entriesOf(const DiscMaker& maker, const std::vector<std::size_t>& first) {
  std::vector<Entry> entries(first.back());
  parallelFor(first.size() - 1, kDiscsAtOnce, [&](std::size_t begin, std::size_t end) {
    Disc disc;
    CellRange cells;
    for (std::size_t i = begin; i < end; ++i) {
      if (!maker.make(i, disc) || !maker.cells(disc, cells)) continue;
      const CellRange range = blocksOf(cells);
      Entry* out = &entries[first[i]];
      for (int z = range.low.z(); z <= range.high.z(); ++z) {
        for (int y = range.low.y(); y <= range.high.y(); ++y) {
          for (int x = range.low.x(); x <= range.high.x(); ++x) {
            *out++ = {BlockLattice::keyOf({x, y, z}), static_cast<std::uint32_t>(i)};
          }
        }
      }
    }
  });
  tbb::parallel_sort(entries, [](const Entry& a, const Entry& b) {
    return a.block != b.block ? a.block < b.block : a.surfel < b.surfel;
  });
  return entries;
}

}  // namespace

DiscBlocks discBlocks(const SurfelArrays& surfels, const MeshConfig& config) {
  const DiscMaker maker(surfels, config);
  const std::vector<std::uint32_t> counts = blockCounts(maker, surfels.size());
  std::vector<std::size_t> first(surfels.size() + 1, 0);
  for (std::size_t i = 0; i < counts.size(); ++i) first[i + 1] = first[i] + counts[i];
  const double entries_mb = 1e-6 * static_cast<double>(first.back()) * (sizeof(Entry) + 4);
  if (entries_mb > config.memory_limit_mb) refuse(entries_mb, config);

  const std::vector<Entry> entries = entriesOf(maker, first);
  std::vector<std::uint64_t> keys;
  for (const Entry& entry : entries) {
    if (keys.empty() || keys.back() != entry.block) keys.push_back(entry.block);
  }
  const double blocks_mb = 1e-6 * static_cast<double>(keys.size()) * kBytesPerBlock;
  if (entries_mb + blocks_mb > config.memory_limit_mb) refuse(entries_mb + blocks_mb, config);
  DiscBlocks blocks{
      {Eigen::Vector3f::Zero(), static_cast<float>(config.cell_m), std::move(keys)}, {}, {}};
  blocks.surfels.reserve(entries.size());
  for (const Entry& entry : entries) {
    if (blocks.surfels.empty() || (&entry)[-1].block != entry.block) {
      blocks.first.push_back(blocks.surfels.size());
    }
    blocks.surfels.push_back(entry.surfel);
  }
  blocks.first.push_back(blocks.surfels.size());
  return blocks;
}

}  // namespace pf
