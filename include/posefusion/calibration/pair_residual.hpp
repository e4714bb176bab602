// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Geometry>
#include <optional>

#include "posefusion/calibration/depth_field.hpp"
#include "posefusion/calibration/view_surface.hpp"
#include "posefusion/core/se3.hpp"

namespace pf {

/// How far a patch of view `from` is from the surface that view `to` saw, both corrected by a
/// field, along the view of `to` and in inverse depth:
///
///     q = T_to_from ray / (w + d(x)),    e = 1 / q_z - (w_to(q) + d(x_q))      (1/m)
///
/// w_to(q) is the plane of the patch of `to` nearest to the pixel of q. Its distance along the
/// normal is e times a factor (`metres`), so that normalised by its noise it is the point-to-plane
/// residual. Derivatives are those of exactly this.
struct PairResidual {
  double e = 0;                     ///< 1/m
  double variance = 0;              ///< of e by the noise of both, (1/m)^2
  double metres = 0;                ///< |distance to the plane| / |e|, m^2
  double pixel_u = 0, pixel_v = 0;  ///< of q
  FieldWeights at_from, at_to;
  double by_from = 0;  ///< of e by d at `from`
  double by_to = 0;    ///< of e by d at `to`: -1
  Vector6d by_pose;    ///< of e by the twist x (m, rad) of exp(x) T_to_from
};

/// Nothing where `to` has no surface there, or one that faces another way.
std::optional<PairResidual> pairResidual(const SurfacePatch& patch, const ViewSurface& from,
                                         const ViewSurface& to, const Eigen::Isometry3d& T_to_from,
                                         const DepthField& field);

}  // namespace pf
