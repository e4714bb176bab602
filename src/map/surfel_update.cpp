// SPDX-License-Identifier: BSD-3-Clause
#include "surfel_update.hpp"

namespace pf {
namespace {

constexpr float kNearM = 0.1F;
// A surfel whose plane leans further than this is not updated: its depth on the ray means little.
constexpr float kMinCosine = 0.2F;

/// Depths closer than this measure the same surface.
inline float agreement(float z) { return surfaceTolerance(z, 5.0F); }

}  // namespace

SurfelUpdate::SurfelUpdate(const WorkingFrame& frame, const cv::Mat& nearest_m,
                           const Eigen::Isometry3d& T_map_camera, SurfelMap& map,
                           std::vector<std::uint8_t>& explained)
    : frame_(frame),
      nearest_m_(nearest_m),
      to_camera_(T_map_camera.inverse()),
      to_map_(T_map_camera),
      s_(map.surfels()),
      config_(map.config()),
      now_(map.frame()),
      min_cosine_(static_cast<float>(std::cos(map.config().max_normal_angle_rad))),
      explained_(explained),
      fx_(static_cast<float>(frame.camera.fx)),
      fy_(static_cast<float>(frame.camera.fy)),
      cx_(static_cast<float>(frame.camera.cx)),
      cy_(static_cast<float>(frame.camera.cy)) {}

bool SurfelUpdate::update(std::size_t i) const {
  float x, y, z;
  to_camera_.point(s_.x[i], s_.y[i], s_.z[i], x, y, z);
  if (z < kNearM) return false;
  const float fu = x / z * fx_ + cx_, fv = y / z * fy_ + cy_;
  if (!(fu > -0.5F && fv > -0.5F && fu < static_cast<float>(frame_.camera.width) - 0.5F &&
        fv < static_cast<float>(frame_.camera.height) - 0.5F)) {
    return false;
  }
  const int u = static_cast<int>(fu + 0.5F), v = static_cast<int>(fv + 0.5F);
  if (frame_.depth_m.at<float>(v, u) <= 0) return false;
  if (nearest_m_.at<float>(v, u) > z + 1.5F * agreement(z)) {
    ++s_.violations[i];
    return false;
  }
  const float measured = depthOnRay(u, v, x / z, y / z);
  if (std::abs(measured - z) > agreement(z)) return false;
  explain(fu, fv, s_.radius[i] * fx_ / z);
  merge(i, {x, y, z}, measured, u, v);
  return true;
}

Eigen::Vector3f SurfelUpdate::normal(int u, int v) const {
  const FrameLevel& level = frame_.levels[0];
  return {level.normal_x.at<float>(v, u), level.normal_y.at<float>(v, u),
          level.normal_z.at<float>(v, u)};
}

/// Depth where the ray (ray_x, ray_y, 1) meets the plane measured at the pixel next to it; the
/// pixel's own depth where it has no normal. Without this a leaning surface would gain up to half a
/// pixel's slope with each merge.
float SurfelUpdate::depthOnRay(int u, int v, float ray_x, float ray_y) const {
  const float depth = frame_.depth_m.at<float>(v, u);
  const Eigen::Vector3f n = normal(u, v);
  const Eigen::Vector3f pixel_ray((static_cast<float>(u) - cx_) / fx_,
                                  (static_cast<float>(v) - cy_) / fy_, 1.0F);
  const float cosine = n.dot(Eigen::Vector3f(ray_x, ray_y, 1.0F));
  if (cosine > -kMinCosine) return depth;
  return depth * n.dot(pixel_ray) / cosine;
}

void SurfelUpdate::explain(float fu, float fv, float radius_px) const {
  const float reach = std::max(0.5F, std::min(0.9F * radius_px, 6.0F));
  const int first_u = std::max(0, static_cast<int>(std::ceil(fu - reach)));
  const int last_u = std::min(frame_.camera.width - 1, static_cast<int>(std::floor(fu + reach)));
  const int first_v = std::max(0, static_cast<int>(std::ceil(fv - reach)));
  const int last_v = std::min(frame_.camera.height - 1, static_cast<int>(std::floor(fv + reach)));
  for (int v = first_v; v <= last_v; ++v) {
    for (int u = first_u; u <= last_u; ++u) {
      // Several threads may write the same 1: relaxed atomic stores, plain moves on any CPU.
      __atomic_store_n(&explained_[v * frame_.camera.width + u], 1, __ATOMIC_RELAXED);
    }
  }
}

/// Running weighted mean of depth along the pixel's ray, normal, colour and radius.
void SurfelUpdate::merge(std::size_t i, const Eigen::Vector3f& p, float measured, int u,
                         int v) const {
  s_.seen[i] = now_;
  s_.violations[i] = std::max(0, s_.violations[i] - 1);
  s_.confidence[i] += 1.0F;
  const Eigen::Vector3f n = normal(u, v);
  Eigen::Vector3f surfel;
  to_camera_.direction(s_.nx[i], s_.ny[i], s_.nz[i], surfel.x(), surfel.y(), surfel.z());
  const float facing = -surfel.dot(p) / p.norm();
  if (n.dot(surfel) < min_cosine_ || facing < kMinCosine) return;
  const float gain = measurementWeight(measured);
  const float old = std::min(s_.weight[i], static_cast<float>(config_.max_weight));
  const float share = gain / (old + gain);
  s_.weight[i] = old + gain;
  const float scale = 1.0F + share * (measured - p.z()) / p.z();
  to_map_.point(p.x() * scale, p.y() * scale, p.z() * scale, s_.x[i], s_.y[i], s_.z[i]);
  mergeNormal(i, share, n);
  const auto& color = frame_.color.at<cv::Vec3b>(v, u);
  s_.r[i] += share * (static_cast<float>(color[0]) - s_.r[i]);
  s_.g[i] += share * (static_cast<float>(color[1]) - s_.g[i]);
  s_.b[i] += share * (static_cast<float>(color[2]) - s_.b[i]);
  // A closer look makes it finer, never coarser.
  const float radius = footprintRadius(measured, fx_, facing);
  if (radius < s_.radius[i]) s_.radius[i] += share * (radius - s_.radius[i]);
}

void SurfelUpdate::mergeNormal(std::size_t i, float share, const Eigen::Vector3f& n) const {
  float mx, my, mz;
  to_map_.direction(n.x(), n.y(), n.z(), mx, my, mz);
  const float x = s_.nx[i] + share * (mx - s_.nx[i]);
  const float y = s_.ny[i] + share * (my - s_.ny[i]);
  const float z = s_.nz[i] + share * (mz - s_.nz[i]);
  const float inverse = 1.0F / std::sqrt(x * x + y * y + z * z);
  s_.nx[i] = x * inverse;
  s_.ny[i] = y * inverse;
  s_.nz[i] = z * inverse;
}

}  // namespace pf
