// SPDX-License-Identifier: BSD-3-Clause
#include "posefusion/segmentation/background.hpp"

#include <algorithm>
#include <cmath>

#include "posefusion/core/parallel.hpp"

namespace pf {
namespace {

constexpr float kMinViewDepth_m = 0.1F;  // nearer points of a view do not count
constexpr int kMinKnown = 4;      // of the 9 pixels looked at, for a verdict other than agreement
constexpr float kClearly = 2.0F;  // tolerances between surfaces that are surely not the same

/// Difference of depth that noise, the map's error and the pose's explain, metres.
float depthTolerance(const DepthSensor& sensor, float z_m) {
  constexpr float kPose_m = 0.01F, kSigmas = 4.0F;
  return kPose_m + sensor.tolerance(z_m, kSigmas);
}

/// A rigid motion and a projection in floats.
struct Projection {
  float r[3][3], t[3];
  float fx, fy, cx, cy;

  Projection(const Eigen::Isometry3d& T_view_camera, const PinholeCamera& camera)
      : fx(static_cast<float>(camera.fx)),
        fy(static_cast<float>(camera.fy)),
        cx(static_cast<float>(camera.cx)),
        cy(static_cast<float>(camera.cy)) {
    for (int i = 0; i < 3; ++i) {
      for (int j = 0; j < 3; ++j) r[i][j] = static_cast<float>(T_view_camera.linear()(i, j));
      t[i] = static_cast<float>(T_view_camera.translation()[i]);
    }
  }
};

/// Some points of the grid, and where they are in the view, as arrays for the kernel.
struct Points {
  static constexpr int kMost = 64;  // at once
  int count = 0;
  int cell[kMost];
  float x[kMost], y[kMost], z[kMost];  // in the grid's camera
  float u[kMost], v[kMost];            // pixels of the view
  float view_z[kMost];                 // depth in the view

  void add(const SceneGrid& grid, int at) {
    cell[count] = at;
    x[count] = grid.x[at];
    y[count] = grid.y[at];
    z[count] = grid.z[at];
    ++count;
  }
};

POSEFUSION_SIMD_CLONES
void project(const Projection& p, Points& points) {
  for (int i = 0; i < points.count; ++i) {
    const float x = points.x[i], y = points.y[i], z = points.z[i];
    const float qx = (p.r[0][0] * x + (p.r[0][1] * y + p.r[0][2] * z)) + p.t[0];
    const float qy = (p.r[1][0] * x + (p.r[1][1] * y + p.r[1][2] * z)) + p.t[1];
    const float qz = (p.r[2][0] * x + (p.r[2][1] * y + p.r[2][2] * z)) + p.t[2];
    const float inverse_z = 1.0F / qz;
    points.u[i] = p.fx * qx * inverse_z + p.cx;
    points.v[i] = p.fy * qy * inverse_z + p.cy;
    points.view_z[i] = qz;
  }
}

/// A view of the map, and which of its depths may be of a surface seen now.
class Comparison {
 public:
  Comparison(const SceneGrid& grid, const ModelView& view, const Eigen::Isometry3d& T_view_camera,
             const DepthSensor& sensor)
      : view_(view),
        sensor_(sensor),
        projection_(T_view_camera, view.camera),
        reach_px_(std::max(
            1, static_cast<int>(std::lround(static_cast<double>(view.camera.width) / grid.cols)))) {
  }

  /// Of points that are not projected yet.
  void compare(Points& points, std::vector<Background>& result) const {
    project(projection_, points);
    for (int i = 0; i < points.count; ++i) {
      if (points.view_z[i] <= kMinViewDepth_m) continue;
      result[points.cell[i]] =
          compareOne(cvRound(points.u[i]), cvRound(points.v[i]), points.view_z[i]);
    }
  }

 private:
  bool isStable(int x, int y) const {
    return view_.stable.empty() || view_.stable.ptr<std::uint8_t>(y)[x] != 0;
  }

  /// Looks for a point at depth z of the view among the 3x3 pixels, reach_px_ apart, around its
  /// place.
  Background compareOne(int u, int v, float z) const {
    const cv::Mat& depth_m = view_.depth_m;
    const float tolerance = depthTolerance(sensor_, z);
    // Nearly always the pixel in the middle says it all.
    if (u >= 0 && v >= 0 && u < depth_m.cols && v < depth_m.rows &&
        std::abs(depth_m.ptr<float>(v)[u] - z) < tolerance && isStable(u, v)) {
      return Background::agrees;
    }
    return compareAround(u, v, z, tolerance);
  }

  Background compareAround(int u, int v, float z, float tolerance) const {
    const cv::Mat& depth_m = view_.depth_m;
    int known = 0, behind = 0, before = 0;
    bool recent = false;
    for (int y = v - reach_px_; y <= v + reach_px_; y += reach_px_) {
      if (y < 0 || y >= depth_m.rows) continue;
      const auto* row = depth_m.ptr<float>(y);
      for (int x = u - reach_px_; x <= u + reach_px_; x += reach_px_) {
        if (x < 0 || x >= depth_m.cols || !(row[x] > 0.0F)) continue;
        ++known;
        if (std::abs(row[x] - z) < tolerance) {
          if (isStable(x, y)) return Background::agrees;
          recent = true;
        }
        behind += row[x] > z + kClearly * tolerance;
        before += row[x] < z - kClearly * tolerance;
      }
    }
    if (recent) return Background::recent;
    if (known >= kMinKnown && behind == known) return Background::nearer;
    if (known >= kMinKnown && before == known) return Background::farther;
    return Background::unknown;
  }

  const ModelView& view_;
  const DepthSensor& sensor_;
  Projection projection_;
  int reach_px_;
};

/// Compares the cells cellAt(i) for i in [0, count).
template <typename CellAt>
void compareCells(const Comparison& comparison, const SceneGrid& grid, std::size_t count,
                  const CellAt& cellAt, std::vector<Background>& result) {
  result.assign(grid.size(), Background::unknown);
  parallelFor(count, kCellsAtOnce, [&](std::size_t begin, std::size_t end) {
    Points points;
    for (std::size_t i = begin; i < end; ++i) {
      const int cell = cellAt(i);
      if (grid.hasDepth(cell)) points.add(grid, cell);
      if (points.count < Points::kMost && i + 1 < end) continue;
      comparison.compare(points, result);
      points.count = 0;
    }
  });
}

}  // namespace

void compareWithModel(const SceneGrid& grid, const ModelView& view,
                      const Eigen::Isometry3d& T_view_camera, const DepthSensor& sensor,
                      std::vector<Background>& result) {
  compareCells(
      {grid, view, T_view_camera, sensor}, grid, grid.size(),
      [](std::size_t i) { return static_cast<int>(i); }, result);
}

void compareWithModel(const SceneGrid& grid, const std::vector<int>& cells, const ModelView& view,
                      const Eigen::Isometry3d& T_view_camera, const DepthSensor& sensor,
                      std::vector<Background>& result) {
  compareCells(
      {grid, view, T_view_camera, sensor}, grid, cells.size(),
      [&](std::size_t i) { return cells[i]; }, result);
}

}  // namespace pf
