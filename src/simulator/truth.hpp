// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "simulator/renderer.hpp"
#include "simulator/simulation.hpp"

namespace pf::simulator {

/// Joints of a person in a picture: where, in view, visible. `view` is what the depth camera sees
/// without noise; a joint lies inside the body, so that the person's own skin may be a little
/// nearer.
PersonTruth observe(int person, const std::array<Eigen::Vector3f, kJointCount>& joints_world,
                    const PinholeCamera& camera, const Eigen::Isometry3d& T_world_camera,
                    const DepthView& view);

/// Likelihoods are 1 for visible joints, the others are not seen: what a perfect detector would
/// say.
People asDetected(const SimulatedFrame& frame);

}  // namespace pf::simulator
