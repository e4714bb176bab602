// SPDX-License-Identifier: BSD-3-Clause
#include "normal_equations_kernel.hpp"

#include "posefusion/core/parallel.hpp"

namespace pf::kernel {
namespace {

constexpr int kLanes = 16;

// Nothing nearer is seen.
constexpr float kNear_m = 0.05F;

#define POSEFUSION_INLINE inline __attribute__((always_inline))
#define FOR_LANES for (int l = 0; l < kLanes; ++l)

/// A group of model points in the frame's camera, and the pixels they fall on.
struct Group {
  float x[kLanes], y[kLanes], z[kLanes];
  float nx[kLanes], ny[kLanes], nz[kLanes];
  float u[kLanes], v[kLanes], inverse_z[kLanes];
  float inside[kLanes];  ///< 1 where all four neighbours are in the image
  int nearest[kLanes], corner[kLanes];
};

/// Adds w * J'J, w * J'r for J = [a, q x a].
POSEFUSION_INLINE void addTerm(const Group& q, const float* ax, const float* ay, const float* az,
                               const float* weight, const float* residual,
                               float (&sums)[kSums][kLanes]) {
  float j[6][kLanes];
  FOR_LANES {
    j[0][l] = ax[l];
    j[1][l] = ay[l];
    j[2][l] = az[l];
    j[3][l] = q.y[l] * az[l] - q.z[l] * ay[l];
    j[4][l] = q.z[l] * ax[l] - q.x[l] * az[l];
    j[5][l] = q.x[l] * ay[l] - q.y[l] * ax[l];
  }
  int k = 0;
  for (int row = 0; row < 6; ++row) {
    float weighted[kLanes];
    FOR_LANES weighted[l] = weight[l] * j[row][l];
    for (int col = row; col < 6; ++col, ++k) {
      FOR_LANES sums[k][l] += weighted[l] * j[col][l];
    }
    FOR_LANES sums[21 + row][l] += weighted[l] * residual[l];
  }
}

POSEFUSION_INLINE void project(const Points& p, const Image& image, const Motion& m, std::size_t i,
                               Group& q) {
  FOR_LANES {
    const float x = p.x[i + l], y = p.y[i + l], z = p.z[i + l];
    const float a = p.nx[i + l], b = p.ny[i + l], c = p.nz[i + l];
    q.x[l] = m.r[0] * x + m.r[1] * y + m.r[2] * z + m.t[0];
    q.y[l] = m.r[3] * x + m.r[4] * y + m.r[5] * z + m.t[1];
    q.z[l] = m.r[6] * x + m.r[7] * y + m.r[8] * z + m.t[2];
    q.nx[l] = m.r[0] * a + m.r[1] * b + m.r[2] * c;
    q.ny[l] = m.r[3] * a + m.r[4] * b + m.r[5] * c;
    q.nz[l] = m.r[6] * a + m.r[7] * b + m.r[8] * c;
  }
  const auto max_u = static_cast<float>(image.width - 1);
  const auto max_v = static_cast<float>(image.height - 1);
  // Numbers instead of branches: the compiler makes SIMD code of no other loop.
  float in_front[kLanes], u[kLanes], v[kLanes];
  FOR_LANES in_front[l] = static_cast<float>(static_cast<int>(q.z[l] > kNear_m));
  FOR_LANES {
    const float z = q.z[l] * in_front[l] + (1 - in_front[l]);
    q.inverse_z[l] = 1.0F / z;
    u[l] = image.fx * q.x[l] * q.inverse_z[l] + image.cx;
    v[l] = image.fy * q.y[l] * q.inverse_z[l] + image.cy;
  }
  FOR_LANES {
    const int inside = static_cast<int>(u[l] >= 0) & static_cast<int>(u[l] < max_u) &
                       static_cast<int>(v[l] >= 0) & static_cast<int>(v[l] < max_v);
    q.inside[l] = static_cast<float>(inside) * in_front[l];
  }
  FOR_LANES {
    q.u[l] = u[l] * q.inside[l];
    q.v[l] = v[l] * q.inside[l];
    q.corner[l] = static_cast<int>(q.v[l]) * image.width + static_cast<int>(q.u[l]);
    q.nearest[l] = static_cast<int>(q.v[l] + 0.5F) * image.width + static_cast<int>(q.u[l] + 0.5F);
  }
}

/// Point to plane. Leaves 1 in `near` where the frame's surface is close to the model's.
POSEFUSION_INLINE void geometricTerm(const Points& p, std::size_t i, const Group& q,
                                     const Image& image, const Gates& gates, float (&near)[kLanes],
                                     float (&sums)[kSums][kLanes]) {
  float weight[kLanes], residual[kLanes];
  const float inverse_fx = 1.0F / image.fx, inverse_fy = 1.0F / image.fy;
  const float inverse_scale2 = 1.0F / (gates.robust_scale * gates.robust_scale);
  FOR_LANES {
    const int at = q.nearest[l];
    const float depth = image.depth[at];
    const float fx = image.nx[at], fy = image.ny[at], fz = image.nz[at];
    // Nearest pixel, so the frame's point is that pixel's own ray.
    const float pu = static_cast<float>(static_cast<int>(q.u[l] + 0.5F));
    const float pv = static_cast<float>(static_cast<int>(q.v[l] + 0.5F));
    const float px = (pu - image.cx) * inverse_fx * depth;
    const float py = (pv - image.cy) * inverse_fy * depth;
    const float dx = q.x[l] - px, dy = q.y[l] - py, dz = q.z[l] - depth;
    const float r = q.nx[l] * dx + q.ny[l] * dy + q.nz[l] * dz;
    const float distance2 = dx * dx + dy * dy + dz * dz;
    const float cosine = q.nx[l] * fx + q.ny[l] * fy + q.nz[l] * fz;
    const float candidate = depth > 0 ? q.inside[l] : 0.0F;
    const float sigma = gates.sensor.sigma(depth);
    const float most = mostApart(gates.max_distance, sigma);
    near[l] = distance2 < most * most ? candidate : 0.0F;
    const float inlier = cosine > gates.min_cosine ? near[l] : 0.0F;
    const float x2 = r * r / (sigma * sigma);
    const float root = 1.0F / (1.0F + x2 * inverse_scale2);
    weight[l] = inlier * root * root * p.weight[i + l] / (sigma * sigma);
    residual[l] = r;
    const float agrees = x2 < kInlierSigmas * kInlierSigmas ? inlier : 0.0F;
    sums[kGeometricError][l] += agrees * r * r;
    // What has no partner costs as much as the worst of those that have.
    const float cost = 1.0F - inlier * root;
    sums[kCost][l] += candidate * p.weight[i + l] * cost;
    sums[kCostWeight][l] += candidate * p.weight[i + l];
    sums[kCandidates][l] += candidate;
    sums[kInliers][l] += agrees;
    sums[kSeenThrough][l] += depth - q.z[l] > most ? candidate : 0.0F;
  }
  addTerm(q, q.nx, q.ny, q.nz, weight, residual, sums);
}

POSEFUSION_INLINE void photometricTerm(const Points& p, std::size_t i, const Group& q,
                                       const Image& image, const Gates& gates,
                                       const float (&near)[kLanes], float (&sums)[kSums][kLanes]) {
  float ax[kLanes], ay[kLanes], az[kLanes], weight[kLanes], residual[kLanes];
  float i00s[kLanes], i01s[kLanes], i10s[kLanes], i11s[kLanes];
  FOR_LANES {
    i00s[l] = image.intensity[q.corner[l]];
    i01s[l] = image.intensity[q.corner[l] + 1];
    i10s[l] = image.intensity[q.corner[l] + image.width];
    i11s[l] = image.intensity[q.corner[l] + image.width + 1];
  }
  FOR_LANES {
    const float i00 = i00s[l], i01 = i01s[l], i10 = i10s[l], i11 = i11s[l];
    const float du = q.u[l] - static_cast<float>(static_cast<int>(q.u[l]));
    const float dv = q.v[l] - static_cast<float>(static_cast<int>(q.v[l]));
    const float top = i00 + du * (i01 - i00), bottom = i10 + du * (i11 - i10);
    const float gu = (1 - dv) * (i01 - i00) + dv * (i11 - i10);
    const float gv = bottom - top;
    const float r =
        top + dv * gv - (gates.brightness_gain * p.intensity[i + l] + gates.brightness_offset);
    const float gx = gu * image.fx * q.inverse_z[l], gy = gv * image.fy * q.inverse_z[l];
    ax[l] = gx;
    ay[l] = gy;
    az[l] = -(gx * q.x[l] + gy * q.y[l]) * q.inverse_z[l];
    const float s = gates.inverse_photometric_sigma;
    const float x2 = r * r * s * s;
    const float root = 1.0F / (1.0F + x2 * (1.0F / 9.0F));
    const float robust = near[l] * root * root * p.weight[i + l];
    weight[l] = robust * s * s;
    residual[l] = r;
    const float m = p.intensity[i + l], y = top + dv * gv;
    sums[kPhotometricError][l] += near[l] * r * r;
    sums[kBrightnessWeight][l] += robust;
    sums[kBrightnessM][l] += robust * m;
    sums[kBrightnessY][l] += robust * y;
    sums[kBrightnessMM][l] += robust * m * m;
    sums[kBrightnessMY][l] += robust * m * y;
    const float cost = 1.0F - near[l] * root;
    sums[kCost][l] += q.inside[l] * p.weight[i + l] * cost;
    sums[kCostWeight][l] += q.inside[l] * p.weight[i + l];
    sums[kPhotometricInliers][l] += near[l];
  }
  addTerm(q, ax, ay, az, weight, residual, sums);
}

}  // namespace

POSEFUSION_SIMD_CLONES
void accumulate(const Points& points, const Image& image, const Motion& motion, const Gates& gates,
                std::size_t begin, std::size_t end, double* sums) {
  float lanes[kSums][kLanes] = {};
  for (std::size_t i = begin; i < end; i += kLanes) {
    Group q;
    float near[kLanes];
    project(points, image, motion, i, q);
    geometricTerm(points, i, q, image, gates, near, lanes);
    if (gates.inverse_photometric_sigma > 0) {
      photometricTerm(points, i, q, image, gates, near, lanes);
    }
  }
  for (int k = 0; k < kSums; ++k) {
    FOR_LANES sums[k] += static_cast<double>(lanes[k][l]);
  }
}

}  // namespace pf::kernel
