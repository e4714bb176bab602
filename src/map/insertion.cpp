// SPDX-License-Identifier: BSD-3-Clause
#include "insertion.hpp"

#include <cmath>

#include "measurement.hpp"
#include "posefusion/core/parallel.hpp"
#include "posefusion/core/rigid_motion.hpp"

namespace pf {
namespace {

bool isWanted(const WorkingFrame& frame, const Evidence& evidence, int u, int v) {
  return evidence.explained[v * frame.camera.width + u] == kUnexplained &&
         frame.depth_m.at<float>(v, u) > 0 && frame.levels[0].normal_z.at<float>(v, u) < 0;
}

/// Writes the surfel of pixel (u, v) at place i.
void writeSurfel(const WorkingFrame& frame, const RigidMotion& to_map, const FusionOptions& options,
                 int u, int v, std::size_t i, SurfelArrays& s) {
  const float z = frame.depth_m.at<float>(v, u);
  const auto fx = static_cast<float>(frame.camera.fx), fy = static_cast<float>(frame.camera.fy);
  const float x = (static_cast<float>(u) - static_cast<float>(frame.camera.cx)) / fx * z;
  const float y = (static_cast<float>(v) - static_cast<float>(frame.camera.cy)) / fy * z;
  const FrameLevel& level = frame.levels[0];
  const float nx = level.normal_x.at<float>(v, u), ny = level.normal_y.at<float>(v, u);
  const float nz = level.normal_z.at<float>(v, u);
  to_map.point(x, y, z, s.x[i], s.y[i], s.z[i]);
  to_map.direction(nx, ny, nz, s.nx[i], s.ny[i], s.nz[i]);
  const auto& color = frame.color.at<cv::Vec3b>(v, u);
  s.r[i] = exposed(color[0], options);
  s.g[i] = exposed(color[1], options);
  s.b[i] = exposed(color[2], options);
  const float cosine = -(nx * x + ny * y + nz * z) / std::sqrt(x * x + y * y + z * z);
  s.radius[i] = footprintRadius(z, fx, cosine);
  s.weight[i] = measurementWeight(frame.sensor, z);
  s.odds[i] = static_odds::supported(0.0F, frame.pace.worth());
}

}  // namespace

void surfelsOfUnexplained(const WorkingFrame& frame, const Eigen::Isometry3d& T_map_camera,
                          const FusionOptions& options, int now, const Evidence& evidence,
                          SurfelArrays& surfels) {
  const int rows = frame.camera.height, cols = frame.camera.width;
  std::vector<std::size_t> row_start(rows + 1, 0);
  parallelFor(rows, 16, [&](std::size_t begin, std::size_t end) {
    for (auto v = static_cast<int>(begin); v < static_cast<int>(end); ++v) {
      for (int u = 0; u < cols; ++u) row_start[v + 1] += isWanted(frame, evidence, u, v) ? 1 : 0;
    }
  });
  for (int v = 0; v < rows; ++v) row_start[v + 1] += row_start[v];
  surfels.resize(row_start[rows]);
  surfels.created.assign(row_start[rows], now);
  surfels.seen.assign(row_start[rows], now);
  const RigidMotion to_map(T_map_camera);
  parallelFor(rows, 16, [&](std::size_t begin, std::size_t end) {
    for (auto v = static_cast<int>(begin); v < static_cast<int>(end); ++v) {
      std::size_t next = row_start[v];
      for (int u = 0; u < cols; ++u) {
        if (isWanted(frame, evidence, u, v)) {
          writeSurfel(frame, to_map, options, u, v, next, surfels);
          if (evidence.known_behind.has(u, v)) surfels.odds[next] += static_odds::kNewcomer;
          ++next;
        }
      }
    }
  });
}

}  // namespace pf
