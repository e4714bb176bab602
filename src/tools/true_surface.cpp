// SPDX-License-Identifier: BSD-3-Clause
#include "true_surface.hpp"

#include "posefusion/io/ply.hpp"

namespace pf {

SurfaceSamples trueSurface(const std::string& sequence) {
  SurfaceSamples samples;
  for (const SurfacePoint& point : loadPoints(sequence + "/scene_points.ply")) {
    samples.positions.push_back(point.position);
    samples.normals.push_back(point.normal);
  }
  return samples;
}

}  // namespace pf
