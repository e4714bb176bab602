// SPDX-License-Identifier: BSD-3-Clause
#include "insertion.hpp"

#include <algorithm>
#include <cmath>
#include <vector>

#include "measurement.hpp"
#include "posefusion/core/parallel.hpp"
#include "posefusion/core/rigid_motion.hpp"

namespace pf {
namespace {

/// A pixel that no surfel explains, of a surface that its level is to show.
struct Wanted {
  int u, v;                  // of the level
  int working_u, working_v;  // of the working frame
  float z;                   // m
  Eigen::Vector3f n;
};

/// Calls visit(wanted) for each pixel of a level's row that wants a surfel.
template <typename Visit>
void forEachWanted(const Evidence& evidence, int index, int v, const cv::Size& working,
                   const Visit& visit) {
  const MeasuredSurface::Level& level = evidence.measured[index];
  const std::int64_t* explained = evidence.explained.at(level.at(0, v));
  const auto* depth = level.depth_m.ptr<float>(v);
  const auto inWorking = [&](int pixel, int size) {
    return std::min(static_cast<int>((static_cast<float>(pixel) + 0.5F) / level.scale), size - 1);
  };
  const int working_v = inWorking(v, working.height);
  for (int u = 0; u < level.depth_m.cols; ++u) {
    if (explained[u] != kUnexplained || !(depth[u] > 0)) continue;
    if (evidence.measured.levelOf(depth[u]) != index) continue;
    const int working_u = inWorking(u, working.width);
    const Eigen::Vector3f n = evidence.measured.normal(working_u, working_v, depth[u]);
    if (n.z() < 0) visit(Wanted{u, v, working_u, working_v, depth[u], n});
  }
}

/// Writes the surfel of a pixel at place i.
void writeSurfel(const Wanted& w, const MeasuredSurface::Level& level, const RigidMotion& to_map,
                 const WorkingFrame& frame, const FusionOptions& options, std::size_t i,
                 SurfelArrays& s) {
  const float x = level.rayX(w.u) * w.z, y = level.rayY(w.v) * w.z;
  to_map.point(x, y, w.z, s.x[i], s.y[i], s.z[i]);
  to_map.direction(w.n.x(), w.n.y(), w.n.z(), s.nx[i], s.ny[i], s.nz[i]);
  const cv::Vec3b& color = level.color.ptr<cv::Vec3b>(w.v)[w.u];
  s.r[i] = exposed(color[0], options);
  s.g[i] = exposed(color[1], options);
  s.b[i] = exposed(color[2], options);
  const float cosine =
      -(w.n.x() * x + w.n.y() * y + w.n.z() * w.z) / std::sqrt(x * x + y * y + w.z * w.z);
  s.radius[i] = footprintRadius(w.z, level.fx, cosine);
  s.weight[i] = measurementWeight(frame.sensor, w.z);
  s.odds[i] = static_odds::supported(0.0F, frame.pace.worth());
}

/// Whether what a pixel sees came before a known surface, or into space that was seen free.
bool isNewcomer(const Wanted& w, const MeasuredSurface::Level& level, const Evidence& evidence,
                const SeenSpace::FromCamera& seen) {
  const float agreement = evidence.measured.agreement(w.z);
  return evidence.known_behind.has(w.working_u, w.working_v, w.z, agreement) ||
         seen.wasFree(level.rayX(w.u) * w.z, level.rayY(w.v) * w.z, w.z,
                      std::max(kWellBefore_m, kSeenThrough * agreement));
}

/// A row of pixels of one level.
struct PixelRow {
  int level, v;
};

}  // namespace

void surfelsOfUnexplained(const WorkingFrame& frame, const Eigen::Isometry3d& T_map_camera,
                          const FusionOptions& options, int now, const Evidence& evidence,
                          const SeenSpace::FromCamera& seen, SurfelArrays& surfels) {
  std::vector<PixelRow> rows;
  for (int i = 0; i < evidence.measured.levels(); ++i) {
    for (int v = 0; v < evidence.measured[i].depth_m.rows; ++v) rows.push_back({i, v});
  }
  const cv::Size working = frame.depth_m.size();
  std::vector<std::size_t> row_start(rows.size() + 1, 0);
  parallelFor(rows.size(), 16, [&](std::size_t begin, std::size_t end) {
    for (std::size_t k = begin; k < end; ++k) {
      forEachWanted(evidence, rows[k].level, rows[k].v, working,
                    [&](const Wanted&) { ++row_start[k + 1]; });
    }
  });
  for (std::size_t k = 0; k < rows.size(); ++k) row_start[k + 1] += row_start[k];
  surfels.resize(row_start.back());
  surfels.created.assign(row_start.back(), now);
  surfels.seen.assign(row_start.back(), now);
  const RigidMotion to_map(T_map_camera);
  parallelFor(rows.size(), 16, [&](std::size_t begin, std::size_t end) {
    for (std::size_t k = begin; k < end; ++k) {
      std::size_t next = row_start[k];
      const MeasuredSurface::Level& level = evidence.measured[rows[k].level];
      forEachWanted(evidence, rows[k].level, rows[k].v, working, [&](const Wanted& w) {
        writeSurfel(w, level, to_map, frame, options, next, surfels);
        if (isNewcomer(w, level, evidence, seen)) {
          surfels.odds[next] += static_odds::kNewcomer;
        }
        ++next;
      });
    }
  });
}

}  // namespace pf
