// SPDX-License-Identifier: BSD-3-Clause
#include "posefusion/map/render.hpp"

#include <tbb/enumerable_thread_specific.h>

#include <algorithm>
#include <cstring>

#include "disc_maker.hpp"
#include "pixel_minima.hpp"
#include "posefusion/core/parallel.hpp"
#include "posefusion/map/visibility.hpp"

namespace pf {
namespace {

constexpr int kAhead = 12;  // pixels

/// Discs closer together than this (m) belong to one surface.
inline float surfaceThickness(const DepthSensor& sensor, float z) {
  return sensor.tolerance(z, 5.0F);
}

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

void prepare(const PinholeCamera& camera, const Eigen::Isometry3d& T, bool color, ModelView& view) {
  const cv::Size size(camera.width, camera.height);
  view.camera = camera;
  view.T_map_camera = T;
  for (cv::Mat* plane : {&view.depth_m, &view.normal_x, &view.normal_y, &view.normal_z,
                         &view.intensity, &view.odds}) {
    plane->create(size, CV_32FC1);
  }
  view.stable.create(size, CV_8UC1);
  if (color) {
    view.color.create(size, CV_8UC3);
  } else {
    view.color = cv::Mat();
  }
}

/// The planes of a view, where one of its rows begins.
struct ViewRow {
  ViewRow(ModelView& view, int v)
      : stable(view.stable.ptr<std::uint8_t>(v)),
        depth_m(view.depth_m.ptr<float>(v)),
        normal_x(view.normal_x.ptr<float>(v)),
        normal_y(view.normal_y.ptr<float>(v)),
        normal_z(view.normal_z.ptr<float>(v)),
        intensity(view.intensity.ptr<float>(v)),
        odds(view.odds.ptr<float>(v)) {}

  /// Pixel u shows this disc, which its ray meets at `depth`.
  void show(int u, const Disc& d, float depth) {
    stable[u] = d.stable ? 1 : 0;
    depth_m[u] = depth;
    normal_x[u] = d.nx;
    normal_y[u] = d.ny;
    normal_z[u] = d.nz;
    intensity[u] = d.intensity;
    odds[u] = d.odds;
  }

  void showNothing(int u) {
    stable[u] = 0;
    for (float* plane : {depth_m, normal_x, normal_y, normal_z, intensity, odds}) plane[u] = 0.0F;
  }

  std::uint8_t* stable;
  float *depth_m, *normal_x, *normal_y, *normal_z, *intensity, *odds;
};

cv::Vec3b colorOf(const SurfelArrays& s, std::uint32_t i) {
  return {cv::saturate_cast<unsigned char>(s.r[i]), cv::saturate_cast<unsigned char>(s.g[i]),
          cv::saturate_cast<unsigned char>(s.b[i])};
}

/// A hit that may be what its pixel shows.
struct Candidate {
  std::uint64_t key;  ///< by the distance from the disc's centre
  int pixel;
  float depth;
};

/// Is a disc of the surface that a pixel shows, as far as `nearest` shows it?
inline bool isOfNearest(const DepthSensor& sensor, std::uint64_t nearest, bool stable,
                        float depth) {
  const float front = valueOf(nearest);
  return stableOf(nearest) == stable && depth <= front + surfaceThickness(sensor, front);
}

}  // namespace

/// What is kept between calls. Range k owns the discs from k * kRangeSurfels on, and candidates[k].
struct SurfelRenderer::Buffers {
  DepthSensor sensor;
  PixelMinima nearest, chosen;
  std::unique_ptr<Disc[]> discs;  // never initialised as a whole: most of it is never touched
  std::size_t disc_capacity = 0;
  std::vector<std::vector<Candidate>> candidates;  // of each range
  tbb::enumerable_thread_specific<std::vector<PixelHit>> hits;

  void prepare(std::size_t pixel_count, std::size_t range_count) {
    nearest.clear(pixel_count);
    chosen.clear(pixel_count);
    if (candidates.size() < range_count) candidates.resize(range_count);
    if (disc_capacity < range_count * kRangeSurfels) {
      disc_capacity = (range_count + range_count / 4) * kRangeSurfels;
      discs.reset(new Disc[disc_capacity]);
    }
  }

  /// Finds what is nearest in each pixel, and keeps the hits that may be of that surface.
  void splatRange(std::size_t range, std::uint32_t count, const Rays& rays) {
    candidates[range].clear();
    const std::size_t first = range * kRangeSurfels;
    std::size_t room = 1;
    for (std::size_t k = first; k < first + count; ++k) room += raysAt(discs[k]);
    std::vector<PixelHit>& found = hits.local();
    if (found.size() < room) found.resize(room);
    std::uint64_t* own = nearest.own();
    const std::size_t hit_count = splat(&discs[first], count, rays, found.data());
    for (std::size_t k = 0; k < hit_count; ++k) {
      const PixelHit& hit = found[k];
      const std::size_t number = first + hit.disc;
      const bool stable = discs[number].stable;
      std::uint64_t& front = own[hit.pixel];
      front = std::min(front, keyOf(stable, hit.depth, number));
      if (!isOfNearest(sensor, front, stable, hit.depth))
        continue;  // what is nearest only comes nearer
      candidates[range].push_back({keyOf(stable, hit.distance, number), hit.pixel, hit.depth});
    }
  }

  /// Of the hits on the nearest surface, finds each pixel's closest to a disc's centre.
  void choose(std::size_t range) {
    std::uint64_t* own = chosen.own();
    for (const Candidate& hit : candidates[range]) {
      if (!isOfNearest(sensor, nearest[hit.pixel], stableOf(hit.key), hit.depth)) continue;
      own[hit.pixel] = std::min(own[hit.pixel], hit.key);
    }
  }
};

SurfelRenderer::SurfelRenderer() : buffers_(std::make_unique<Buffers>()) {}
SurfelRenderer::~SurfelRenderer() = default;

void SurfelRenderer::render(const SurfelMap& map, const PinholeCamera& camera,
                            const Eigen::Isometry3d& T_map_camera, const RenderOptions& options,
                            ModelView& view) {
  const auto ranges = rangesOf(
      map, visibleBlocks(map, camera, {options.fragment, T_map_camera}, options.max_depth_m));
  const DiscMaker maker(map, options, camera, T_map_camera);
  const Rays& rays = maker.rays();
  Buffers& b = *buffers_;
  b.sensor = map.sensor();
  b.prepare(static_cast<std::size_t>(camera.width) * camera.height, ranges.size());
  parallelFor(ranges.size(), 1, [&](std::size_t begin, std::size_t end) {
    for (std::size_t k = begin; k < end; ++k) {
      b.splatRange(k, maker.make(ranges[k], &b.discs[k * kRangeSurfels]), rays);
    }
  });
  b.nearest.combine();
  parallelFor(ranges.size(), 1, [&](std::size_t begin, std::size_t end) {
    for (std::size_t k = begin; k < end; ++k) b.choose(k);
  });
  b.chosen.combine();
  prepare(camera, T_map_camera, options.with_color, view);
  view.fragment = options.fragment;
  parallelFor(camera.height, 8, [&](std::size_t begin, std::size_t end) {
    for (auto v = static_cast<int>(begin); v < static_cast<int>(end); ++v) {
      const std::size_t first = static_cast<std::size_t>(v) * camera.width;
      ViewRow row(view, v);
      for (int u = 0; u < camera.width; ++u) {
        // Neighbouring pixels' discs lie anywhere in memory.
        const std::uint64_t ahead = b.chosen[first + std::min(u + kAhead, camera.width - 1)];
        if (ahead != PixelMinima::kNothing) {
          __builtin_prefetch(&b.discs[static_cast<std::uint32_t>(ahead)]);
        }
        const std::uint64_t key = b.chosen[first + u];
        if (options.with_color) view.color.at<cv::Vec3b>(v, u) = {0, 0, 0};
        if (key == PixelMinima::kNothing) {
          row.showNothing(u);
          continue;
        }
        const auto number = static_cast<std::uint32_t>(key);
        const Disc& disc = b.discs[number];
        row.show(u, disc, intersect(disc, rays.x(u), rays.y(v)).depth);
        if (!options.with_color) continue;
        const SurfelBlock& block = map.blocks()[ranges[number / kRangeSurfels].block];
        view.color.at<cv::Vec3b>(v, u) = colorOf(block.surfels, disc.slot);
      }
    }
  });
}

}  // namespace pf
