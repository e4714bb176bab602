// SPDX-License-Identifier: BSD-3-Clause
#include "posefusion/map/fusion.hpp"

#include <algorithm>
#include <cmath>

#include "posefusion/core/noise.hpp"
#include "posefusion/core/parallel.hpp"
#include "posefusion/core/rigid_motion.hpp"
#include "surfel_update.hpp"

namespace pf {
namespace {

constexpr std::size_t kSurfelGrain = 4096;
// Moving all arrays costs more than carrying a few dead surfels for some frames: they are compacted
// when more than one surfel in so many is to go, and now and then anyway.
constexpr std::size_t kCompactionShare = 50;
constexpr int kCompactionFrames = 10;

/// Smallest valid depth of 3x3 pixels where the centre is valid, else 0.
void nearestOf3x3(const cv::Mat& depth, cv::Mat& nearest) {
  nearest.create(depth.size(), CV_32FC1);
  parallelFor(depth.rows, 16, [&](std::size_t begin, std::size_t end) {
    for (auto v = static_cast<int>(begin); v < static_cast<int>(end); ++v) {
      for (int u = 0; u < depth.cols; ++u) {
        float smallest = depth.at<float>(v, u);
        if (smallest > 0) {
          for (int row = std::max(0, v - 1); row <= std::min(depth.rows - 1, v + 1); ++row) {
            const float* d = depth.ptr<float>(row);
            for (int col = std::max(0, u - 1); col <= std::min(depth.cols - 1, u + 1); ++col) {
              if (d[col] > 0) smallest = std::min(smallest, d[col]);
            }
          }
        }
        nearest.at<float>(v, u) = smallest;
      }
    }
  });
}

bool isWanted(const WorkingFrame& frame, const std::vector<std::uint8_t>& explained, int u, int v) {
  return explained[v * frame.camera.width + u] == 0 && frame.depth_m.at<float>(v, u) > 0 &&
         frame.levels[0].normal_z.at<float>(v, u) < 0;
}

void insertSurfel(const WorkingFrame& frame, const RigidMotion& to_map, int now, int u, int v,
                  std::size_t i, SurfelArrays& s) {
  const float z = frame.depth_m.at<float>(v, u);
  const auto fx = static_cast<float>(frame.camera.fx), fy = static_cast<float>(frame.camera.fy);
  const float x = (static_cast<float>(u) - static_cast<float>(frame.camera.cx)) / fx * z;
  const float y = (static_cast<float>(v) - static_cast<float>(frame.camera.cy)) / fy * z;
  const FrameLevel& level = frame.levels[0];
  to_map.point(x, y, z, s.x[i], s.y[i], s.z[i]);
  to_map.direction(level.normal_x.at<float>(v, u), level.normal_y.at<float>(v, u),
                   level.normal_z.at<float>(v, u), s.nx[i], s.ny[i], s.nz[i]);
  const auto& color = frame.color.at<cv::Vec3b>(v, u);
  s.r[i] = color[0];
  s.g[i] = color[1];
  s.b[i] = color[2];
  const float cosine = -(level.normal_x.at<float>(v, u) * x + level.normal_y.at<float>(v, u) * y +
                         level.normal_z.at<float>(v, u) * z) /
                       std::sqrt(x * x + y * y + z * z);
  s.radius[i] = footprintRadius(z, fx, cosine);
  s.weight[i] = measurementWeight(z);
  s.confidence[i] = 1.0F;
  s.created[i] = s.seen[i] = now;
  s.violations[i] = 0;
}

/// Appends a surfel for each unexplained pixel, row by row. Returns how many.
std::size_t insertUnexplained(const WorkingFrame& frame, const Eigen::Isometry3d& T_map_camera,
                              const std::vector<std::uint8_t>& explained,
                              std::vector<std::uint32_t>& row_start, SurfelMap& map) {
  const int rows = frame.camera.height, cols = frame.camera.width;
  row_start.assign(rows + 1, 0);
  parallelFor(rows, 16, [&](std::size_t begin, std::size_t end) {
    for (auto v = static_cast<int>(begin); v < static_cast<int>(end); ++v) {
      for (int u = 0; u < cols; ++u) row_start[v + 1] += isWanted(frame, explained, u, v) ? 1 : 0;
    }
  });
  for (int v = 0; v < rows; ++v) row_start[v + 1] += row_start[v];
  SurfelArrays& s = map.surfels();
  const std::size_t first = s.size();
  const std::size_t room = std::max(map.capacity(), first) - first;
  const std::size_t wanted = row_start[rows], count = std::min(wanted, room);
  map.countRefused(wanted - count);
  s.forEachArray([&](auto& array) { array.resize(first + count); });
  const RigidMotion to_map(T_map_camera);
  parallelFor(rows, 16, [&](std::size_t begin, std::size_t end) {
    for (auto v = static_cast<int>(begin); v < static_cast<int>(end); ++v) {
      std::size_t next = row_start[v];
      for (int u = 0; u < cols && next < count; ++u) {
        if (!isWanted(frame, explained, u, v)) continue;
        insertSurfel(frame, to_map, map.frame(), u, v, first + next, s);
        ++next;
      }
    }
  });
  return count;
}

/// Unstable surfels that were not confirmed, and those that frames see through.
bool isDoomed(const SurfelMap& map, std::size_t i) {
  const SurfelArrays& s = map.surfels();
  if (s.violations[i] > map.config().max_violations) return true;
  return !map.isStable(i) && map.frame() - s.seen[i] > map.config().max_unstable_age_frames;
}

}  // namespace

FusionCounts Fuser::fuse(const WorkingFrame& frame, const Eigen::Isometry3d& T_map_camera,
                         SurfelMap& map) {
  map.advance();
  FusionCounts counts;
  nearestOf3x3(frame.depth_m, nearest_m_);
  explained_.assign(frame.depth_m.total(), 0);
  const SurfelUpdate update(frame, nearest_m_, T_map_camera, map, explained_);
  const std::size_t old_size = map.surfels().size();
  doomed_.resize(old_size);
  counts.merged = deterministicSum<std::size_t>(old_size, kSurfelGrain,
                                                [&](std::size_t begin, std::size_t end) {
                                                  std::size_t merged = 0;
                                                  for (std::size_t i = begin; i < end; ++i) {
                                                    if (map.isActive(i) && update.update(i))
                                                      ++merged;
                                                    doomed_[i] = isDoomed(map, i) ? 1 : 0;
                                                  }
                                                  return merged;
                                                });
  const std::size_t doomed = std::count(doomed_.begin(), doomed_.end(), 1);
  if (doomed * kCompactionShare > old_size ||
      (doomed > 0 && map.frame() % kCompactionFrames == 0)) {
    counts.removed = compact(doomed_, map.surfels());
  }
  counts.inserted = insertUnexplained(frame, T_map_camera, explained_, row_start_, map);
  return counts;
}

std::size_t compact(const std::vector<std::uint8_t>& doomed, SurfelArrays& surfels) {
  std::size_t kept = 0;
  surfels.forEachArray([&](auto& array) {
    kept = 0;
    for (std::size_t i = 0; i < array.size(); ++i) {
      array[kept] = array[i];
      kept += doomed[i] == 0 ? 1 : 0;
    }
    array.resize(kept);
  });
  return doomed.size() - kept;
}

}  // namespace pf
