// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <memory>
#include <vector>

#include "posefusion/frame/model_view.hpp"
#include "posefusion/map/surfel_map.hpp"

namespace pf {

/// Surfels by their last support: within MapConfig::active_window_s, or longer ago.
enum class SurfelAge { active, inactive, all };

/// Which surfels a view shows.
struct RenderOptions {
  bool with_color = false;   ///< fill ModelView::color
  bool only_stable = false;  ///< leave out unstable surfels; else they show where nothing stable is
  SurfelAge age = SurfelAge::active;
  double max_depth_m = 0;         ///< blocks that are farther as a whole are left out; 0: none are
  int fragment = kFirstFragment;  ///< that the pose is in; nothing of others is seen
};

/// Splats surfels as discs: each pixel shows, of the discs of the nearest surface that its ray hits
/// (stable ones first), the one whose centre is closest to the ray. Taking simply the nearest disc
/// would pull every surface towards the camera by its own noise, and tracking with it. Keeps its
/// buffers between calls. Not thread safe. The bits do not depend on the number of threads: the
/// buffers keep minima, whatever the order.
class SurfelRenderer {
 public:
  SurfelRenderer();
  ~SurfelRenderer();

  void render(const SurfelMap& map, const PinholeCamera& camera,
              const Eigen::Isometry3d& T_map_camera, const RenderOptions& options, ModelView& view);

 private:
  struct Buffers;
  std::unique_ptr<Buffers> buffers_;
};

}  // namespace pf
