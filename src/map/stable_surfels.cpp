// SPDX-License-Identifier: BSD-3-Clause
#include "posefusion/map/stable_surfels.hpp"

#include "posefusion/core/rigid_motion.hpp"

namespace pf {

SurfelArrays stableSurfels(const SurfelMap& map, const Eigen::Isometry3d& T_out_map) {
  SurfelArrays out;
  std::vector<std::uint32_t> stable;
  for (const SurfelBlock& block : map.blocks()) {
    if (block.fragment != kFirstFragment) continue;
    stable.clear();
    for (std::size_t i = 0; i < block.surfels.size(); ++i) {
      if (map.isStable(block.surfels, i)) stable.push_back(static_cast<std::uint32_t>(i));
    }
    out.append(block.surfels, stable.data(), stable.size());
  }
  const RigidMotion motion(T_out_map);
  for (std::size_t i = 0; i < out.size(); ++i) {
    motion.point(out.x[i], out.y[i], out.z[i], out.x[i], out.y[i], out.z[i]);
    motion.direction(out.nx[i], out.ny[i], out.nz[i], out.nx[i], out.ny[i], out.nz[i]);
  }
  return out;
}

}  // namespace pf
