// SPDX-License-Identifier: BSD-3-Clause
#include "posefusion/map/render.hpp"

#include <algorithm>
#include <cmath>
#include <cstring>

#include "posefusion/core/noise.hpp"
#include "posefusion/core/parallel.hpp"
#include "posefusion/core/rigid_motion.hpp"

namespace pf {
namespace {

constexpr std::size_t kSurfelGrain = 4096;
constexpr std::uint64_t kNothing = ~std::uint64_t{0};
// A disc seen under a flatter angle than this is drawn as if it faced the camera: the plane
// intersection is of no use there.
constexpr float kMinCosine = 0.15F;
constexpr float kNearM = 0.1F;
constexpr float kMaxSplatRadiusPx = 12.0F;
constexpr float kAlmostOne = 0.9999F;  // int(x + kAlmostOne) rounds x up

/// Discs closer together than this (m) belong to one surface.
inline float surfaceThickness(float z) { return surfaceTolerance(z, 5.0F); }

/// A surfel in the camera frame.
struct Disc {
  float x, y, z, nx, ny, nz;
  float offset;           ///< n . (x, y, z): the disc's plane
  float inverse_radius2;  ///< 1 / radius^2
};

/// Where a ray meets a disc.
struct Hit {
  float depth = 0;     ///< along the optical axis; 0 when the ray misses
  float distance = 0;  ///< from the disc's centre, as part of its radius, squared
};

inline Hit intersect(const Disc& d, float ray_x, float ray_y) {
  const float cosine = d.nx * ray_x + d.ny * ray_y + d.nz;  // times the length of the ray
  const bool steep =
      cosine * cosine < kMinCosine * kMinCosine * (ray_x * ray_x + ray_y * ray_y + 1);
  const float depth = steep ? d.z : d.offset / cosine;
  const float dx = ray_x * depth - d.x, dy = ray_y * depth - d.y, dz = depth - d.z;
  const float distance = (dx * dx + dy * dy + dz * dz) * d.inverse_radius2;
  if (distance > 1.0F || depth < kNearM) return {};
  return {depth, distance};
}

/// Orders hits on a pixel: stable before unstable, then by `value` (>= 0), then by index.
std::uint64_t keyOf(bool stable, float value, std::size_t index) {
  std::uint32_t bits = 0;
  std::memcpy(&bits, &value, sizeof bits);  // floats that are not negative order like their bits
  return (stable ? 0 : std::uint64_t{1} << 63) | (std::uint64_t{bits} << 32) | index;
}

bool stableOf(std::uint64_t key) { return key >> 63 == 0; }

float valueOf(std::uint64_t key) {
  const auto bits = static_cast<std::uint32_t>(key >> 32) & 0x7fffffffU;
  float value = 0;
  std::memcpy(&value, &bits, sizeof value);
  return value;
}

void keepSmaller(std::atomic<std::uint64_t>& slot, std::uint64_t key) {
  std::uint64_t old = slot.load(std::memory_order_relaxed);
  while (key < old && !slot.compare_exchange_weak(old, key, std::memory_order_relaxed)) {
  }
}

class Splatter {
 public:
  Splatter(const SurfelArrays& surfels, const PinholeCamera& camera,
           const Eigen::Isometry3d& T_map_camera)
      : s_(surfels),
        T_(T_map_camera.inverse()),
        width_(camera.width),
        height_(camera.height),
        fx_(static_cast<float>(camera.fx)),
        fy_(static_cast<float>(camera.fy)),
        cx_(static_cast<float>(camera.cx)),
        cy_(static_cast<float>(camera.cy)),
        inverse_fx_(1.0F / fx_),
        inverse_fy_(1.0F / fy_) {}

  Disc disc(std::size_t i) const {
    Disc d;
    T_.point(s_.x[i], s_.y[i], s_.z[i], d.x, d.y, d.z);
    turn(i, d);
    return d;
  }

  float rayX(int u) const { return (static_cast<float>(u) - cx_) * inverse_fx_; }
  float rayY(int v) const { return (static_cast<float>(v) - cy_) * inverse_fy_; }

  /// Calls found(pixel, hit) for each pixel whose ray meets disc i; false when none can.
  template <typename Found>
  bool splat(std::size_t i, const Found& found) const {
    Disc d;
    T_.point(s_.x[i], s_.y[i], s_.z[i], d.x, d.y, d.z);
    if (d.z < kNearM) return false;
    const float inverse_z = 1.0F / d.z;
    const float u = d.x * inverse_z * fx_ + cx_, v = d.y * inverse_z * fy_ + cy_;
    const float reach = std::min(s_.radius[i] * fx_ * inverse_z, kMaxSplatRadiusPx);
    if (!(u + reach >= 0 && v + reach >= 0 && u - reach <= static_cast<float>(width_ - 1) &&
          v - reach <= static_cast<float>(height_ - 1))) {
      return false;
    }
    turn(i, d);
    if (d.offset > 0) return false;  // seen from behind
    // Casts cut towards zero: rounding down, since nothing below zero is left after max().
    const int first_u = static_cast<int>(std::max(0.0F, u - reach) + kAlmostOne);
    const int last_u = std::min(width_ - 1, static_cast<int>(u + reach));
    const int first_v = static_cast<int>(std::max(0.0F, v - reach) + kAlmostOne);
    const int last_v = std::min(height_ - 1, static_cast<int>(v + reach));
    for (int row = first_v; row <= last_v; ++row) {
      const float ray_y = rayY(row);
      for (int col = first_u; col <= last_u; ++col) {
        const Hit hit = intersect(d, rayX(col), ray_y);
        if (hit.depth > 0) found(row * width_ + col, hit);
      }
    }
    return true;
  }

 private:
  /// What of the disc depends on its normal.
  void turn(std::size_t i, Disc& d) const {
    T_.direction(s_.nx[i], s_.ny[i], s_.nz[i], d.nx, d.ny, d.nz);
    d.offset = d.nx * d.x + d.ny * d.y + d.nz * d.z;
    d.inverse_radius2 = 1.0F / (s_.radius[i] * s_.radius[i]);
  }

  const SurfelArrays& s_;
  RigidMotion T_;
  int width_, height_;
  float fx_, fy_, cx_, cy_, inverse_fx_, inverse_fy_;
};

void prepare(const PinholeCamera& camera, const Eigen::Isometry3d& T, bool color, ModelView& view) {
  const cv::Size size(camera.width, camera.height);
  view.camera = camera;
  view.T_map_camera = T;
  for (cv::Mat* plane : {&view.depth_m, &view.normal_x, &view.normal_y, &view.normal_z,
                         &view.intensity, &view.support}) {
    plane->create(size, CV_32FC1);
  }
  view.index.create(size, CV_32SC1);
  view.stable.create(size, CV_8UC1);
  if (color) {
    view.color.create(size, CV_8UC3);
  } else {
    view.color = cv::Mat();
  }
}

void resolvePixel(const Splatter& splatter, const SurfelArrays& s, std::uint64_t key, int u, int v,
                  ModelView& view) {
  const bool hit = key != kNothing;
  const auto i = static_cast<std::uint32_t>(key);
  const Disc d = hit ? splatter.disc(i) : Disc{};
  view.stable.at<std::uint8_t>(v, u) = hit && stableOf(key) ? 1 : 0;
  view.index.at<int>(v, u) = hit ? static_cast<int>(i) : -1;
  view.depth_m.at<float>(v, u) =
      hit ? intersect(d, splatter.rayX(u), splatter.rayY(v)).depth : 0.0F;
  view.normal_x.at<float>(v, u) = d.nx;
  view.normal_y.at<float>(v, u) = d.ny;
  view.normal_z.at<float>(v, u) = d.nz;
  view.intensity.at<float>(v, u) = hit ? 0.299F * s.r[i] + 0.587F * s.g[i] + 0.114F * s.b[i] : 0.0F;
  view.support.at<float>(v, u) = hit ? s.confidence[i] : 0.0F;
  if (view.color.empty()) return;
  view.color.at<cv::Vec3b>(v, u) = hit ? cv::Vec3b(cv::saturate_cast<unsigned char>(s.r[i]),
                                                   cv::saturate_cast<unsigned char>(s.g[i]),
                                                   cv::saturate_cast<unsigned char>(s.b[i]))
                                       : cv::Vec3b(0, 0, 0);
}

/// Which surfels the options leave, and of which class.
enum Shown : std::uint8_t { kHidden, kUnstable, kStable };

Shown classOf(const SurfelMap& map, const RenderOptions& options, std::size_t i) {
  if (options.only_active && !map.isActive(i)) return kHidden;
  if (map.isStable(i)) return kStable;
  return options.only_stable ? kHidden : kUnstable;
}

}  // namespace

void SurfelRenderer::clear(std::size_t pixels) {
  if (buffer_size_ != pixels) {
    nearest_ = std::make_unique<Buffer>(pixels);
    chosen_ = std::make_unique<Buffer>(pixels);
    buffer_size_ = pixels;
  }
  parallelFor(pixels, 1 << 14, [&](std::size_t begin, std::size_t end) {
    for (std::size_t i = begin; i < end; ++i) {
      nearest_[i].store(kNothing, std::memory_order_relaxed);
      chosen_[i].store(kNothing, std::memory_order_relaxed);
    }
  });
}

void SurfelRenderer::render(const SurfelMap& map, const PinholeCamera& camera,
                            const Eigen::Isometry3d& T_map_camera, const RenderOptions& options,
                            ModelView& view) {
  clear(static_cast<std::size_t>(camera.width) * camera.height);
  const SurfelArrays& surfels = map.surfels();
  const Splatter splatter(surfels, camera, T_map_camera);
  shown_.resize(surfels.size());
  parallelFor(surfels.size(), kSurfelGrain, [&](std::size_t begin, std::size_t end) {
    for (std::size_t i = begin; i < end; ++i) {
      shown_[i] = classOf(map, options, i);
      if (shown_[i] == kHidden) continue;
      const bool stable = shown_[i] == kStable;
      const bool visible = splatter.splat(i, [&](int pixel, const Hit& hit) {
        keepSmaller(nearest_[pixel], keyOf(stable, hit.depth, i));
      });
      if (!visible) shown_[i] = kHidden;
    }
  });
  parallelFor(surfels.size(), kSurfelGrain, [&](std::size_t begin, std::size_t end) {
    for (std::size_t i = begin; i < end; ++i) {
      if (shown_[i] == kHidden) continue;
      const bool stable = shown_[i] == kStable;
      splatter.splat(i, [&](int pixel, const Hit& hit) {
        const std::uint64_t nearest = nearest_[pixel].load(std::memory_order_relaxed);
        const float depth = valueOf(nearest);
        if (stableOf(nearest) != stable || hit.depth > depth + surfaceThickness(depth)) return;
        keepSmaller(chosen_[pixel], keyOf(stable, hit.distance, i));
      });
    }
  });
  prepare(camera, T_map_camera, options.with_color, view);
  parallelFor(camera.height, 8, [&](std::size_t begin, std::size_t end) {
    for (auto v = static_cast<int>(begin); v < static_cast<int>(end); ++v) {
      for (int u = 0; u < camera.width; ++u) {
        const std::uint64_t key = chosen_[v * camera.width + u].load(std::memory_order_relaxed);
        resolvePixel(splatter, surfels, key, u, v, view);
      }
    }
  });
}

}  // namespace pf
