// SPDX-License-Identifier: BSD-3-Clause
#include "posefusion/frame/depth_filter.hpp"

#include <algorithm>
#include <cmath>
#include <opencv2/imgproc.hpp>
#include <vector>

#include "posefusion/core/parallel.hpp"

namespace pf {
namespace {

constexpr std::size_t kRowGrain = 8;
constexpr int kRadius = 3;
constexpr float kSpatialSigma_px = 2.25F;
// Smoothing leaves so much of the noise of a pixel.
constexpr float kLeftBySmoothing = 0.25F;
constexpr float kMostNormalNoise_rad = 0.26F;
constexpr float kFarthest_m = 20.0F, kDepthStep_m = 0.05F;

/// Pixels whose depths differ by less belong to one surface (a slope of 45 degrees over a few
/// pixels is still one).
inline float surfaceTolerance(const DepthSensor& sensor, float z) {
  return sensor.tolerance(z, 4.0F);
}

template <typename RowBody>
void forRows(int rows, const RowBody& body) {
  parallelFor(static_cast<std::size_t>(rows), kRowGrain, [&](std::size_t begin, std::size_t end) {
    for (std::size_t v = begin; v < end; ++v) body(static_cast<int>(v));
  });
}

/// 2x2 blocks, the usual case, without branches.
POSEFUSION_SIMD_CLONES
void halveRow(const float* row0, const float* row1, DepthSensor sensor, float* out, int width) {
  constexpr float kFar = 1e9F;
  for (int u = 0; u < width; ++u) {
    const float a = row0[2 * u], b = row0[2 * u + 1], c = row1[2 * u], d = row1[2 * u + 1];
    const float fa = a > 0 ? a : kFar, fb = b > 0 ? b : kFar;
    const float fc = c > 0 ? c : kFar, fd = d > 0 ? d : kFar;
    const float ab = fa < fb ? fa : fb, cd = fc < fd ? fc : fd;
    const float nearest = ab < cd ? ab : cd;
    const float limit = nearest + surfaceTolerance(sensor, nearest);
    const float wa = fa <= limit && fa < kFar ? 1.0F : 0.0F;
    const float wb = fb <= limit && fb < kFar ? 1.0F : 0.0F;
    const float wc = fc <= limit && fc < kFar ? 1.0F : 0.0F;
    const float wd = fd <= limit && fd < kFar ? 1.0F : 0.0F;
    const float count = wa + wb + wc + wd;
    const float sum = wa / fa + wb / fb + wc / fc + wd / fd;
    out[u] = count > 0 ? count / (count > 0 ? sum : 1.0F) : 0.0F;
  }
}

void shrinkRow(const cv::Mat& depth, int factor, const DepthSensor& sensor, int v, cv::Mat& small) {
  auto* out = small.ptr<float>(v);
  const int width = small.cols;
  for (int u = 0; u < width; ++u) {
    float nearest = 1e9F;
    for (int dv = 0; dv < factor; ++dv) {
      const float* in = depth.ptr<float>(v * factor + dv) + u * factor;
      for (int du = 0; du < factor; ++du) {
        if (in[du] > 0) nearest = std::min(nearest, in[du]);
      }
    }
    float sum = 0, count = 0;
    for (int dv = 0; dv < factor; ++dv) {
      const float* in = depth.ptr<float>(v * factor + dv) + u * factor;
      for (int du = 0; du < factor; ++du) {
        if (in[du] <= 0 || in[du] > nearest + surfaceTolerance(sensor, nearest)) continue;
        sum += 1.0F / in[du];
        count += 1;
      }
    }
    out[u] = count > 0 ? count / sum : 0.0F;
  }
}

/// Adds one tap of the window to the running sums of a row of inverse depths.
POSEFUSION_SIMD_CLONES
void addTap(const float* centre, const float* neighbour, const float* inverse_width, float spatial,
            float* weight_sum, float* difference_sum, int count) {
  for (int u = 0; u < count; ++u) {
    const float difference = neighbour[u] - centre[u];
    const float x = difference * inverse_width[u];
    const float y = 1.0F - x * x;
    const float weight = y > 0 ? spatial * y * y : 0.0F;
    weight_sum[u] += weight;
    difference_sum[u] += weight * difference;
  }
}

POSEFUSION_SIMD_CLONES
void normalRow(const float* up, const float* row, const float* down, const float* ray_x,
               float ray_y, float step_x, float step_y, DepthSensor sensor, float* nx, float* ny,
               float* nz, int count) {
  for (int u = 1; u < count - 1; ++u) {
    const float z = row[u], l = row[u - 1], r = row[u + 1], t = up[u], b = down[u];
    // Tangents: difference of neighbouring vertices (ray * depth).
    const float ax = ray_x[u + 1] * r - ray_x[u - 1] * l, ay = ray_y * (r - l), az = r - l;
    const float bx = ray_x[u] * (b - t), by = (ray_y + step_y) * b - (ray_y - step_y) * t,
                bz = b - t;
    float x = by * az - ay * bz, y = ax * bz - bx * az, w = bx * ay - ax * by;
    const float length2 = x * x + y * y + w * w;
    // The surface may lean by up to about 80 degrees; a larger step is an edge.
    const float limit = 2.0F * surfaceTolerance(sensor, z) + 12.0F * step_x * z;
    const float smallest = std::min(std::min(l, r), std::min(t, b));
    const float largest = std::max(std::max(l, r), std::max(t, b));
    const bool good = z > 0 && smallest > 0 && largest - smallest < limit && length2 > 0;
    const float scale = good ? 1.0F / std::sqrt(length2 > 0 ? length2 : 1.0F) : 0.0F;
    nx[u] = x * scale;
    ny[u] = y * scale;
    nz[u] = w * scale;
  }
}

}  // namespace

void shrinkDepth(const cv::Mat& depth_m, int factor, const DepthSensor& sensor, cv::Mat& small_m) {
  if (factor == 1) {
    depth_m.copyTo(small_m);
    return;
  }
  small_m.create(depth_m.rows / factor, depth_m.cols / factor, CV_32FC1);
  forRows(small_m.rows, [&](int v) {
    if (factor == 2) {
      halveRow(depth_m.ptr<float>(2 * v), depth_m.ptr<float>(2 * v + 1), sensor,
               small_m.ptr<float>(v), small_m.cols);
    } else {
      shrinkRow(depth_m, factor, sensor, v, small_m);
    }
  });
}

void smoothDepth(const cv::Mat& depth_m, const DepthSensor& sensor, cv::Mat& smooth_m) {
  const int width = depth_m.cols, height = depth_m.rows;
  thread_local cv::Mat inverse;  // of the calling thread; the tasks see a reference to it
  cv::Mat& in = inverse;
  in.create(depth_m.size(), CV_32FC1);
  smooth_m.create(depth_m.size(), CV_32FC1);
  forRows(height, [&](int v) {
    const float* z = depth_m.ptr<float>(v);
    float* out = in.ptr<float>(v);
    for (int u = 0; u < width; ++u) out[u] = z[u] > 0 ? 1.0F / z[u] : 0.0F;
  });
  forRows(height, [&](int v) {
    thread_local std::vector<float> inverse_width, weight_sum, difference_sum;
    inverse_width.resize(width);
    weight_sum.assign(width, 0.0F);
    difference_sum.assign(width, 0.0F);
    const float* z = depth_m.ptr<float>(v);
    const float* centre = in.ptr<float>(v);
    for (int u = 0; u < width; ++u) inverse_width[u] = z[u] * z[u] / surfaceTolerance(sensor, z[u]);
    for (int dv = std::max(-kRadius, -v); dv <= std::min(kRadius, height - 1 - v); ++dv) {
      const float* row = in.ptr<float>(v + dv);
      for (int du = -kRadius; du <= kRadius; ++du) {
        const int first = std::max(0, -du), last = width - std::max(0, du);
        const float spatial = std::exp(-static_cast<float>(du * du + dv * dv) /
                                       (2 * kSpatialSigma_px * kSpatialSigma_px));
        addTap(centre + first, row + first + du, inverse_width.data() + first, spatial,
               weight_sum.data() + first, difference_sum.data() + first, last - first);
      }
    }
    float* out = smooth_m.ptr<float>(v);
    for (int u = 0; u < width; ++u) {
      // The centre itself always has a weight, and an invalid centre (0) stays so.
      out[u] = z[u] > 0 ? 1.0F / (centre[u] + difference_sum[u] / weight_sum[u]) : 0.0F;
    }
  });
}

void computeNormals(const cv::Mat& depth_m, const PinholeCamera& camera, const DepthSensor& sensor,
                    cv::Mat& normal_x, cv::Mat& normal_y, cv::Mat& normal_z) {
  for (cv::Mat* plane : {&normal_x, &normal_y, &normal_z}) plane->create(depth_m.size(), CV_32FC1);
  const int width = depth_m.cols;
  std::vector<float> ray_x(width);
  for (int u = 0; u < width; ++u) ray_x[u] = static_cast<float>((u - camera.cx) / camera.fx);
  forRows(depth_m.rows, [&](int v) {
    float* rows[3] = {normal_x.ptr<float>(v), normal_y.ptr<float>(v), normal_z.ptr<float>(v)};
    if (v == 0 || v == depth_m.rows - 1) {
      for (float* row : rows) std::fill_n(row, width, 0.0F);
      return;
    }
    for (float* row : rows) row[0] = row[width - 1] = 0.0F;
    normalRow(depth_m.ptr<float>(v - 1), depth_m.ptr<float>(v), depth_m.ptr<float>(v + 1),
              ray_x.data(), static_cast<float>((v - camera.cy) / camera.fy),
              static_cast<float>(1.0 / camera.fx), static_cast<float>(1.0 / camera.fy), sensor,
              rows[0], rows[1], rows[2], width);
  });
}

float noisyNormalsFrom(const PinholeCamera& camera, const DepthSensor& sensor) {
  const auto baseline_px = 2.0F / static_cast<float>(camera.fx);
  const auto noise = [&](float z) {
    return kLeftBySmoothing * sensor.sigma(z) / (baseline_px * z);
  };
  float from_m = kFarthest_m;  // noise is large very near, too, where the sensor measures nothing
  while (from_m > kDepthStep_m && noise(from_m) > kMostNormalNoise_rad) from_m -= kDepthStep_m;
  return from_m;
}

void takeCoarseNormals(const cv::Mat& depth_m, float from_m, const std::array<cv::Mat, 3>& coarse,
                       int factor, const std::array<cv::Mat*, 3>& normals) {
  forRows(std::min(depth_m.rows, factor * coarse[0].rows), [&](int v) {
    const float* z = depth_m.ptr<float>(v);
    const int width = std::min(depth_m.cols, factor * coarse[0].cols);
    const float* seen = coarse[2].ptr<float>(v / factor);
    for (int u = 0; u < width; ++u) {
      if (z[u] < from_m || seen[u / factor] == 0.0F) continue;
      for (std::size_t i = 0; i < 3; ++i) {
        normals[i]->ptr<float>(v)[u] = coarse[i].ptr<float>(v / factor)[u / factor];
      }
    }
  });
}

void shrinkToIntensity(const cv::Mat& color, int factor, cv::Mat& intensity) {
  intensity.create(color.rows / factor, color.cols / factor, CV_32FC1);
  const float share = 1.0F / static_cast<float>(factor * factor);
  forRows(intensity.rows, [&](int v) {
    float* out = intensity.ptr<float>(v);
    std::fill_n(out, intensity.cols, 0.0F);
    for (int dv = 0; dv < factor; ++dv) {
      const unsigned char* in = color.ptr<unsigned char>(v * factor + dv);
      for (int u = 0; u < intensity.cols; ++u) {
        int red = 0, green = 0, blue = 0;
        for (int k = 0; k < factor; ++k, in += 3) {
          red += in[0];
          green += in[1];
          blue += in[2];
        }
        out[u] += share * (0.299F * static_cast<float>(red) + 0.587F * static_cast<float>(green) +
                           0.114F * static_cast<float>(blue));
      }
    }
  });
}

void halveIntensity(const cv::Mat& intensity, cv::Mat& small) {
  small.create(intensity.rows / 2, intensity.cols / 2, CV_32FC1);
  forRows(small.rows, [&](int v) {
    const float* a = intensity.ptr<float>(2 * v);
    const float* b = intensity.ptr<float>(2 * v + 1);
    float* out = small.ptr<float>(v);
    for (int u = 0; u < small.cols; ++u) {
      out[u] = 0.25F * (a[2 * u] + a[2 * u + 1] + b[2 * u] + b[2 * u + 1]);
    }
  });
}

}  // namespace pf
