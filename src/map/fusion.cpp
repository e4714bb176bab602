// SPDX-License-Identifier: BSD-3-Clause
#include "posefusion/map/fusion.hpp"

#include <algorithm>
#include <string>
#include <vector>

#include "insertion.hpp"
#include "posefusion/core/error.hpp"
#include "posefusion/core/noise.hpp"
#include "posefusion/core/parallel.hpp"
#include "posefusion/map/visibility.hpp"
#include "surfel_update.hpp"

namespace pf {
namespace {

// A block is compacted when more than one of so many surfels is to go, and now and then anyway:
// moving all arrays costs more than carrying a few dead surfels for some frames.
constexpr std::size_t kCompactionShare = 50;
constexpr int kCompactionFrames = 10;
// Blocks out of view are cleaned in turn, each once in so many frames.
constexpr int kCleaningFrames = 30;

/// Where all of 3x3 pixels see at least that far (m); 0 where the centre sees nothing.
POSEFUSION_SIMD_CLONES
void nearestOf3x3(const float* above, const float* row, const float* below, float* nearest,
                  int width) {
  constexpr float kFar = 1e9F;
  for (int u = 0; u < width; ++u) {
    const int left = u > 0 ? u - 1 : 0, right = u < width - 1 ? u + 1 : width - 1;
    float smallest = kFar;
    for (const float* d : {above, row, below}) {
      const float a = d[left], b = d[u], c = d[right];
      const float fa = a > 0 ? a : kFar, fb = b > 0 ? b : kFar, fc = c > 0 ? c : kFar;
      const float ab = fa < fb ? fa : fb, abc = ab < fc ? ab : fc;
      smallest = smallest < abc ? smallest : abc;
    }
    nearest[u] = row[u] > 0 ? smallest : 0.0F;
  }
}

void findFreeSpace(const WorkingFrame& frame, cv::Mat& free_m) {
  free_m.create(frame.depth_m.size(), CV_32FC1);
  const cv::Mat& depth = frame.depth_m;
  parallelFor(depth.rows, 16, [&](std::size_t begin, std::size_t end) {
    for (auto v = static_cast<int>(begin); v < static_cast<int>(end); ++v) {
      nearestOf3x3(depth.ptr<float>(std::max(0, v - 1)), depth.ptr<float>(v),
                   depth.ptr<float>(std::min(depth.rows - 1, v + 1)), free_m.ptr<float>(v),
                   depth.cols);
    }
  });
}

}  // namespace

/// What is kept between calls.
struct Fuser::Scratch {
  Evidence evidence;
  std::vector<std::uint32_t> visible;  // blocks in view of the frame
  SurfelArrays fresh;                  // new surfels, in the order of their pixels
};

Fuser::Fuser() : scratch_(std::make_unique<Scratch>()) {}
Fuser::~Fuser() = default;

FusionCounts Fuser::fuse(const WorkingFrame& frame, const Eigen::Isometry3d& T_map_camera,
                         SurfelMap& map, const FusionOptions& options) {
  map.advance();
  FusionCounts counts;
  Scratch& s = *scratch_;
  update(frame, T_map_camera, options, map, counts);
  counts.removed = clean(map);
  surfelsOfUnexplained(frame, T_map_camera, options, map.frame(), s.evidence.explained, s.fresh);
  counts.inserted = map.add(s.fresh);
  return counts;
}

void Fuser::update(const WorkingFrame& frame, const Eigen::Isometry3d& T_map_camera,
                   const FusionOptions& options, SurfelMap& map, FusionCounts& counts) {
  Scratch& s = *scratch_;
  findFreeSpace(frame, s.evidence.free_m);
  s.evidence.explained.assign(frame.depth_m.total(), 0);
  double farthest_m = 0;
  cv::minMaxLoc(s.evidence.free_m, nullptr, &farthest_m);
  // A surfel farther than all that was measured can still agree with it.
  farthest_m += 2.0 * surfaceTolerance(static_cast<float>(farthest_m), 5.0F);
  s.visible = visibleBlocks(map, frame.camera, T_map_camera, farthest_m);
  const auto ranges = rangesOf(map, s.visible);
  const SurfelUpdate update(frame, T_map_camera, options, map, s.evidence);
  std::vector<SurfelUpdate::Result> results(ranges.size());
  parallelFor(ranges.size(), 1, [&](std::size_t begin, std::size_t end) {
    for (std::size_t k = begin; k < end; ++k) {
      results[k] = update.update(ranges[k], map.blocks_[ranges[k].block].surfels);
    }
  });
  for (std::size_t k = 0; k < ranges.size(); ++k) {
    counts.merged += results[k].merged;
    map.blocks_[ranges[k].block].bounds.extend(results[k].moved);
  }
}

/// Sweeps up the dead surfels of the blocks in view, and in some of the others.
std::size_t Fuser::clean(SurfelMap& map) {
  std::vector<std::uint32_t> blocks = scratch_->visible;
  for (auto i = static_cast<std::uint32_t>(map.frame() % kCleaningFrames); i < map.blocks_.size();
       i += kCleaningFrames) {
    if (map.blocks_[i].any_unstable) blocks.push_back(i);
  }
  std::sort(blocks.begin(), blocks.end());
  blocks.erase(std::unique(blocks.begin(), blocks.end()), blocks.end());
  const auto removed =
      deterministicSum<std::size_t>(blocks.size(), 1, [&](std::size_t begin, std::size_t end) {
        std::size_t count = 0;
        for (std::size_t k = begin; k < end; ++k) {
          SurfelBlock& block = map.blocks_[blocks[k]];
          const SurfelArrays& s = block.surfels;
          std::size_t dead = 0, unstable = 0;
          for (std::size_t i = 0; i < s.size(); ++i) {
            dead += map.isDead(s, i) ? 1 : 0;
            unstable += map.isStable(s, i) ? 0 : 1;
          }
          block.any_unstable = unstable > 0;
          const bool turn =
              map.frame() % kCompactionFrames == static_cast<int>(blocks[k] % kCompactionFrames);
          if (dead * kCompactionShare <= s.size() && !(turn && dead > 0)) continue;
          count += map.removeFrom(block, [&](const SurfelArrays& surfels, std::size_t i) {
            return map.isDead(surfels, i);
          });
        }
        return count;
      });
  if (removed > 0) map.countMemory();
  return removed;
}

}  // namespace pf
