// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <atomic>
#include <cstdint>
#include <memory>
#include <vector>

#include "posefusion/frame/model_view.hpp"
#include "posefusion/map/surfel_map.hpp"

namespace pf {

/// Which surfels a view shows.
struct RenderOptions {
  bool with_color = false;   ///< fill ModelView::color
  bool only_stable = false;  ///< leave out unstable surfels; else they show where nothing stable is
  bool only_active = true;   ///< leave out those outside the active time window
};

/// Splats surfels as discs: each pixel shows, of the discs of the nearest surface that its ray hits
/// (stable ones first), the one whose centre is closest to the ray. Taking simply the nearest disc
/// would pull every surface towards the camera by its own noise, and tracking with it. Keeps its
/// buffers between calls. Not thread safe. The bits do not depend on the number of threads: the
/// buffers keep minima, whatever the order.
class SurfelRenderer {
 public:
  void render(const SurfelMap& map, const PinholeCamera& camera,
              const Eigen::Isometry3d& T_map_camera, const RenderOptions& options, ModelView& view);

 private:
  using Buffer = std::atomic<std::uint64_t>[];
  void clear(std::size_t pixels);

  std::unique_ptr<Buffer> nearest_, chosen_;  // per pixel
  std::vector<std::uint8_t> shown_;           // per surfel
  std::size_t buffer_size_ = 0;
};

}  // namespace pf
