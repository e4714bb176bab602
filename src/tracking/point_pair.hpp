// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "posefusion/tracking/normal_equations.hpp"

namespace pf {

/// For what is the same for neighbouring points a seventh of them, prime to the rows' lengths, is
/// enough.
constexpr std::size_t kEvery = 7;

/// A model point and the frame's pixel that it falls on.
struct PointPair {
  Eigen::Vector3d q, p;  ///< the model's point, moved into the camera frame; the frame's point
  int u = 0, v = 0;
};

/// False where the point falls on no depth, or is farther from the frame's than the gates allow.
bool findPair(const ModelPoints& model, std::size_t i, const FrameLevel& frame,
              const Eigen::Isometry3d& T_frame_model, const TermSettings& settings,
              PointPair& pair);

}  // namespace pf
