// SPDX-License-Identifier: BSD-3-Clause
#include "posefusion/tracking/model_points.hpp"

#include <algorithm>
#include <cmath>

#include "posefusion/core/parallel.hpp"
#include "posefusion/core/static_odds.hpp"

namespace pf {
namespace {

// The surer it is that a surfel stands still, the more it counts: it may belong to an unmasked
// person. Its weight is never 0: a turn shows little but new surfels.
constexpr float kLeastWeight = 0.2F;

float weightOf(float odds) {
  return std::clamp(odds * (1.0F / static_odds::kMost), kLeastWeight, 1.0F);
}

/// Mean over the nearest surface of a 2x2 block of `fine`, into pixel (u, v) of `coarse`.
void halvePixel(const ModelPlanes& fine, const DepthSensor& sensor, int u, int v,
                ModelPlanes& coarse) {
  float nearest = 1e9F;
  for (int k = 0; k < 4; ++k) {
    const float z = fine.depth_m.at<float>(2 * v + k / 2, 2 * u + k % 2);
    if (z > 0 && z < nearest) nearest = z;
  }
  const float limit = nearest + sensor.tolerance(nearest, 4.0F);
  float inverse = 0, normal[3] = {}, intensity = 0, odds = 0, count = 0;
  for (int k = 0; k < 4; ++k) {
    const int row = 2 * v + k / 2, col = 2 * u + k % 2;
    const float z = fine.depth_m.at<float>(row, col);
    if (z <= 0 || z > limit) continue;
    inverse += 1.0F / z;
    for (int i = 0; i < 3; ++i) normal[i] += fine.normal[i].at<float>(row, col);
    intensity += fine.intensity.at<float>(row, col);
    odds += fine.odds.at<float>(row, col);
    count += 1;
  }
  const float share = count > 0 ? 1.0F / count : 0.0F;
  const float length =
      std::sqrt(normal[0] * normal[0] + normal[1] * normal[1] + normal[2] * normal[2]) + 1e-12F;
  coarse.depth_m.at<float>(v, u) = count > 0 ? count / inverse : 0.0F;
  for (int i = 0; i < 3; ++i) coarse.normal[i].at<float>(v, u) = normal[i] / length;
  coarse.intensity.at<float>(v, u) = intensity * share;
  coarse.odds.at<float>(v, u) = odds * share;
}

/// The view, and the frame where the view shows nothing or something well behind the frame's
/// surface.
void fillFrom(const FrameLevel& frame, const ModelView& view, const DepthSensor& sensor,
              ModelPlanes& planes) {
  view.depth_m.copyTo(planes.depth_m);
  view.normal_x.copyTo(planes.normal[0]);
  view.normal_y.copyTo(planes.normal[1]);
  view.normal_z.copyTo(planes.normal[2]);
  view.intensity.copyTo(planes.intensity);
  view.odds.copyTo(planes.odds);
  parallelFor(view.depth_m.rows, 16, [&](std::size_t begin, std::size_t end) {
    for (auto v = static_cast<int>(begin); v < static_cast<int>(end); ++v) {
      const float* seen = frame.depth_m.ptr<float>(v);
      for (int u = 0; u < view.depth_m.cols; ++u) {
        const float known = view.depth_m.at<float>(v, u);
        const bool hides = known <= 0 || seen[u] + sensor.tolerance(seen[u], 5.0F) < known;
        if (seen[u] <= 0 || !hides || frame.normal_z.at<float>(v, u) >= 0) continue;
        planes.depth_m.at<float>(v, u) = seen[u];
        planes.normal[0].at<float>(v, u) = frame.normal_x.at<float>(v, u);
        planes.normal[1].at<float>(v, u) = frame.normal_y.at<float>(v, u);
        planes.normal[2].at<float>(v, u) = frame.normal_z.at<float>(v, u);
        planes.intensity.at<float>(v, u) = frame.intensity.at<float>(v, u);
        planes.odds.at<float>(v, u) = static_odds::kFrame;
      }
    }
  });
}

void halve(const ModelPlanes& fine, const DepthSensor& sensor, ModelPlanes& coarse) {
  const cv::Size size(fine.depth_m.cols / 2, fine.depth_m.rows / 2);
  for (cv::Mat* plane : {&coarse.depth_m, &coarse.normal[0], &coarse.normal[1], &coarse.normal[2],
                         &coarse.intensity, &coarse.odds}) {
    plane->create(size, CV_32FC1);
  }
  parallelFor(size.height, 8, [&](std::size_t begin, std::size_t end) {
    for (auto v = static_cast<int>(begin); v < static_cast<int>(end); ++v) {
      for (int u = 0; u < size.width; ++u) halvePixel(fine, sensor, u, v, coarse);
    }
  });
}

}  // namespace

void ModelPoints::assign(const PinholeCamera& camera, const ModelPlanes& planes) {
  const std::size_t capacity = planes.depth_m.total() + kLanes;
  for (auto* v : {&x, &y, &z, &nx, &ny, &nz, &intensity, &weight}) v->resize(capacity);
  count = 0;
  const auto inverse_fx = static_cast<float>(1.0 / camera.fx);
  const auto inverse_fy = static_cast<float>(1.0 / camera.fy);
  for (int v = 0; v < planes.depth_m.rows; ++v) {
    const float* depth = planes.depth_m.ptr<float>(v);
    const float* normal[3] = {planes.normal[0].ptr<float>(v), planes.normal[1].ptr<float>(v),
                              planes.normal[2].ptr<float>(v)};
    const float* grey = planes.intensity.ptr<float>(v);
    const float* odds = planes.odds.ptr<float>(v);
    const float ray_y = (static_cast<float>(v) - static_cast<float>(camera.cy)) * inverse_fy;
    for (int u = 0; u < planes.depth_m.cols; ++u) {
      if (depth[u] <= 0) continue;
      const float ray_x = (static_cast<float>(u) - static_cast<float>(camera.cx)) * inverse_fx;
      x[count] = ray_x * depth[u];
      y[count] = ray_y * depth[u];
      z[count] = depth[u];
      nx[count] = normal[0][u];
      ny[count] = normal[1][u];
      nz[count] = normal[2][u];
      intensity[count] = grey[u];
      weight[count] = weightOf(odds[u]);
      ++count;
    }
  }
  // Points behind the camera never project into an image.
  for (std::size_t i = count; i < capacity && i % kLanes != 0; ++i) {
    x[i] = y[i] = nx[i] = ny[i] = intensity[i] = weight[i] = 0.0F;
    z[i] = nz[i] = -1.0F;
  }
}

void ModelPyramid::assign(const ModelView& view, const DepthSensor& sensor,
                          const FrameLevel* fill) {
  ModelPlanes& finest = planes_[0];
  if (fill != nullptr) {
    fillFrom(*fill, view, sensor, finest);
  } else {
    finest = {
        view.depth_m, {view.normal_x, view.normal_y, view.normal_z}, view.intensity, view.odds};
  }
  PinholeCamera camera = view.camera;
  for (int i = 0; i < kLevels; ++i) {
    if (i > 0) {
      halve(planes_[i - 1], sensor, planes_[i]);
      camera = camera.shrunk(2);
    }
    levels_[i].assign(camera, planes_[i]);
  }
}

}  // namespace pf
