// SPDX-License-Identifier: BSD-3-Clause
#include "projection.hpp"

#include "posefusion/core/parallel.hpp"

namespace pf {
namespace {

POSEFUSION_SIMD_CLONES
void projectPositions(const float* __restrict x, const float* __restrict y,
                      const float* __restrict z, const float* __restrict radius, int count,
                      const Projection& p, ProjectedRange& __restrict out) {
  // Copies, so that the compiler need not fear that the output overlaps them.
  const float r0 = p.r[0], r1 = p.r[1], r2 = p.r[2], r3 = p.r[3], r4 = p.r[4], r5 = p.r[5];
  const float r6 = p.r[6], r7 = p.r[7], r8 = p.r[8], t0 = p.t[0], t1 = p.t[1], t2 = p.t[2];
  const float fx = p.fx, fy = p.fy, cx = p.cx, cy = p.cy;
  const float right = p.width - 0.5F, bottom = p.height - 0.5F;
  for (int i = 0; i < count; ++i) {
    const float px = r0 * x[i] + r1 * y[i] + r2 * z[i] + t0;
    const float py = r3 * x[i] + r4 * y[i] + r5 * z[i] + t1;
    const float pz = r6 * x[i] + r7 * y[i] + r8 * z[i] + t2;
    const float inverse_z = 1.0F / (pz > kNear_m ? pz : kNear_m);
    const float u = px * inverse_z * fx + cx, v = py * inverse_z * fy + cy;
    const float reach = radius[i] * fx * inverse_z;
    out.x[i] = px;
    out.y[i] = py;
    out.z[i] = pz;
    out.u[i] = u;
    out.v[i] = v;
    out.reach[i] = reach;
    const int near_enough = pz >= kNear_m, left_of = u - reach<right, below = v + reach> - 0.5F;
    const int right_of = u + reach > -0.5F, above = v - reach < bottom;
    out.inside[i] = near_enough & left_of & right_of & above & below;
  }
}

POSEFUSION_SIMD_CLONES
void projectNormals(const float* __restrict x, const float* __restrict y, const float* __restrict z,
                    const float* __restrict nx, const float* __restrict ny,
                    const float* __restrict nz, int count, const Projection& p,
                    float* __restrict facing) {
  const float c0 = p.centre[0], c1 = p.centre[1], c2 = p.centre[2];
  for (int i = 0; i < count; ++i) {
    facing[i] = nx[i] * (x[i] - c0) + ny[i] * (y[i] - c1) + nz[i] * (z[i] - c2);
  }
}

}  // namespace

Projection::Projection(const PinholeCamera& camera, const Eigen::Isometry3d& T_map_camera)
    : fx(static_cast<float>(camera.fx)),
      fy(static_cast<float>(camera.fy)),
      cx(static_cast<float>(camera.cx)),
      cy(static_cast<float>(camera.cy)),
      width(static_cast<float>(camera.width)),
      height(static_cast<float>(camera.height)) {
  const Eigen::Isometry3d T = T_map_camera.inverse();
  for (int row = 0; row < 3; ++row) {
    for (int col = 0; col < 3; ++col) r[3 * row + col] = static_cast<float>(T(row, col));
    t[row] = static_cast<float>(T(row, 3));
    centre[row] = static_cast<float>(T_map_camera(row, 3));
  }
}

void project(const SurfelArrays& s, const SurfelRange& range, const Projection& projection,
             ProjectedRange& out) {
  const std::uint32_t b = range.begin;
  const int count = static_cast<int>(range.end - range.begin);
  projectPositions(&s.x[b], &s.y[b], &s.z[b], &s.radius[b], count, projection, out);
  projectNormals(&s.x[b], &s.y[b], &s.z[b], &s.nx[b], &s.ny[b], &s.nz[b], count, projection,
                 out.facing);
}

}  // namespace pf
