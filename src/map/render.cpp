// SPDX-License-Identifier: BSD-3-Clause
#include "posefusion/map/render.hpp"

#include <algorithm>
#include <cmath>
#include <cstring>

#include "disc_maker.hpp"
#include "posefusion/core/noise.hpp"
#include "posefusion/core/parallel.hpp"
#include "posefusion/map/visibility.hpp"

namespace pf {
namespace {

constexpr std::size_t kPixelGrain = 1 << 14;
constexpr std::uint64_t kNothing = ~std::uint64_t{0};

/// Discs closer together than this (m) belong to one surface.
inline float surfaceThickness(float z) { return surfaceTolerance(z, 5.0F); }

/// Orders hits on a pixel: stable before unstable, then by `value` (>= 0), then by disc.
inline std::uint64_t keyOf(bool stable, float value, std::size_t disc) {
  std::uint32_t bits = 0;
  std::memcpy(&bits, &value, sizeof bits);  // floats that are not negative order like their bits
  return (stable ? 0 : std::uint64_t{1} << 63) | (std::uint64_t{bits} << 32) | disc;
}

inline bool stableOf(std::uint64_t key) { return key >> 63 == 0; }

inline float valueOf(std::uint64_t key) {
  const auto bits = static_cast<std::uint32_t>(key >> 32) & 0x7fffffffU;
  float value = 0;
  std::memcpy(&value, &bits, sizeof value);
  return value;
}

inline void keepSmaller(std::atomic<std::uint64_t>& slot, std::uint64_t key) {
  std::uint64_t old = slot.load(std::memory_order_relaxed);
  while (key < old && !slot.compare_exchange_weak(old, key, std::memory_order_relaxed)) {
  }
}

void prepare(const PinholeCamera& camera, const Eigen::Isometry3d& T, bool color, ModelView& view) {
  const cv::Size size(camera.width, camera.height);
  view.camera = camera;
  view.T_map_camera = T;
  for (cv::Mat* plane : {&view.depth_m, &view.normal_x, &view.normal_y, &view.normal_z,
                         &view.intensity, &view.support}) {
    plane->create(size, CV_32FC1);
  }
  view.stable.create(size, CV_8UC1);
  if (color) {
    view.color.create(size, CV_8UC3);
  } else {
    view.color = cv::Mat();
  }
}

/// Fills a pixel from the disc that it shows; `d` is null where it shows none.
void resolvePixel(const Disc* d, const SurfelArrays* s, const Rays& rays, int u, int v,
                  ModelView& view) {
  const std::uint32_t i = d != nullptr ? d->slot : 0;
  view.stable.at<std::uint8_t>(v, u) = d != nullptr && d->stable ? 1 : 0;
  view.depth_m.at<float>(v, u) = d != nullptr ? intersect(*d, rays.x(u), rays.y(v)).depth : 0.0F;
  view.normal_x.at<float>(v, u) = d != nullptr ? d->nx : 0.0F;
  view.normal_y.at<float>(v, u) = d != nullptr ? d->ny : 0.0F;
  view.normal_z.at<float>(v, u) = d != nullptr ? d->nz : 0.0F;
  view.intensity.at<float>(v, u) =
      d != nullptr ? 0.299F * s->r[i] + 0.587F * s->g[i] + 0.114F * s->b[i] : 0.0F;
  view.support.at<float>(v, u) = d != nullptr ? s->confidence[i] : 0.0F;
  if (view.color.empty()) return;
  view.color.at<cv::Vec3b>(v, u) = d != nullptr
                                       ? cv::Vec3b(cv::saturate_cast<unsigned char>(s->r[i]),
                                                   cv::saturate_cast<unsigned char>(s->g[i]),
                                                   cv::saturate_cast<unsigned char>(s->b[i]))
                                       : cv::Vec3b(0, 0, 0);
}

}  // namespace

/// What is kept between calls. Range k owns the discs from k * kRangeSurfels on.
struct SurfelRenderer::Buffers {
  using Keys = std::unique_ptr<std::atomic<std::uint64_t>[]>;
  Keys nearest, chosen;  // per pixel
  std::size_t pixels = 0;
  std::unique_ptr<Disc[]> discs;  // never initialised as a whole: most of it is never touched
  std::size_t disc_capacity = 0;
  std::vector<std::uint32_t> counts;  // discs of each range

  void prepare(std::size_t pixel_count, std::size_t range_count) {
    if (pixels != pixel_count) {
      nearest = std::make_unique<std::atomic<std::uint64_t>[]>(pixel_count);
      chosen = std::make_unique<std::atomic<std::uint64_t>[]>(pixel_count);
      pixels = pixel_count;
    }
    counts.assign(range_count, 0);
    if (disc_capacity < range_count * kRangeSurfels) {
      disc_capacity = (range_count + range_count / 4) * kRangeSurfels;
      discs.reset(new Disc[disc_capacity]);
    }
    parallelFor(pixels, kPixelGrain, [&](std::size_t begin, std::size_t end) {
      for (std::size_t i = begin; i < end; ++i) {
        nearest[i].store(kNothing, std::memory_order_relaxed);
        chosen[i].store(kNothing, std::memory_order_relaxed);
      }
    });
  }

  /// Calls visit(disc number, disc) for the discs of a range.
  template <typename Visit>
  void forDiscs(std::size_t range, const Visit& visit) const {
    const std::size_t first = range * kRangeSurfels;
    for (std::size_t d = first; d < first + counts[range]; ++d) visit(d, discs[d]);
  }
};

SurfelRenderer::SurfelRenderer() : buffers_(std::make_unique<Buffers>()) {}
SurfelRenderer::~SurfelRenderer() = default;

void SurfelRenderer::render(const SurfelMap& map, const PinholeCamera& camera,
                            const Eigen::Isometry3d& T_map_camera, const RenderOptions& options,
                            ModelView& view) {
  const auto ranges = rangesOf(map, visibleBlocks(map, camera, T_map_camera, options.max_depth_m));
  const DiscMaker maker(map, options, camera, T_map_camera);
  const Rays& rays = maker.rays();
  Buffers& b = *buffers_;
  b.prepare(static_cast<std::size_t>(camera.width) * camera.height, ranges.size());
  parallelFor(ranges.size(), 1, [&](std::size_t begin, std::size_t end) {
    for (std::size_t k = begin; k < end; ++k) {
      b.counts[k] = maker.make(ranges[k], &b.discs[k * kRangeSurfels]);
      b.forDiscs(k, [&](std::size_t number, const Disc& d) {
        splat(d, rays, [&](int pixel, const Hit& hit) {
          keepSmaller(b.nearest[pixel], keyOf(d.stable, hit.depth, number));
        });
      });
    }
  });
  parallelFor(ranges.size(), 1, [&](std::size_t begin, std::size_t end) {
    for (std::size_t k = begin; k < end; ++k) {
      b.forDiscs(k, [&](std::size_t number, const Disc& d) {
        splat(d, rays, [&](int pixel, const Hit& hit) {
          const std::uint64_t nearest = b.nearest[pixel].load(std::memory_order_relaxed);
          const float depth = valueOf(nearest);
          if (stableOf(nearest) != d.stable || hit.depth > depth + surfaceThickness(depth)) return;
          keepSmaller(b.chosen[pixel], keyOf(d.stable, hit.distance, number));
        });
      });
    }
  });
  prepare(camera, T_map_camera, options.with_color, view);
  parallelFor(camera.height, 8, [&](std::size_t begin, std::size_t end) {
    for (auto v = static_cast<int>(begin); v < static_cast<int>(end); ++v) {
      for (int u = 0; u < camera.width; ++u) {
        const std::uint64_t key = b.chosen[v * camera.width + u].load(std::memory_order_relaxed);
        const bool hit = key != kNothing;
        const auto number = static_cast<std::uint32_t>(key);
        const std::uint32_t block = hit ? ranges[number / kRangeSurfels].block : 0;
        resolvePixel(hit ? &b.discs[number] : nullptr, hit ? &map.blocks()[block].surfels : nullptr,
                     rays, u, v, view);
      }
    }
  });
}

}  // namespace pf
