// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "disc.hpp"
#include "posefusion/core/rigid_motion.hpp"
#include "posefusion/map/render.hpp"
#include "posefusion/map/visibility.hpp"
#include "projection.hpp"

namespace pf {

/// Turns surfels into the discs that a camera may see.
class DiscMaker {
 public:
  DiscMaker(const SurfelMap& map, const RenderOptions& options, const PinholeCamera& camera,
            const Eigen::Isometry3d& T_map_camera)
      : map_(map),
        options_(options),
        projection_(camera, T_map_camera),
        to_camera_(T_map_camera.inverse()),
        rays_(camera) {}

  const Rays& rays() const { return rays_; }

  /// Writes the discs of a range, in order; returns their number.
  std::uint32_t make(const SurfelRange& range, Disc* discs) const;

 private:
  /// The pixels that the disc may cover; false for none.
  bool cover(const ProjectedRange& seen, std::uint32_t k, Disc& d) const;

  const SurfelMap& map_;
  const RenderOptions& options_;
  Projection projection_;
  RigidMotion to_camera_;
  Rays rays_;
};

}  // namespace pf
