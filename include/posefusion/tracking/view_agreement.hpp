// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "posefusion/frame/model_view.hpp"
#include "posefusion/frame/working_frame.hpp"

namespace pf {

/// How a frame and the map, seen from one pose, agree.
struct ViewAgreement {
  double overlap = 0;       ///< part of the frame's pixels with depth where the map shows something
  double agreeing = 0;      ///< part of those at the same depth, facing the same way
  double seen_through = 0;  ///< part of those where the frame sees beyond the map's surface
  double hidden = 0;        ///< part of those where the frame has something before it
  double correlation = 0;   ///< of the grey levels where the depths agree, in small windows
  /// How much the normals of what agrees vary: the least eigenvalue of their mean outer product, 0
  /// for one or two walls, 1/3 at most. Where it is small the pose may have slid.
  double spread = 0;
  double view = 1;  ///< part of the frame's pixels with depth
};

/// Compares a frame with the map drawn from its pose.
ViewAgreement compareViews(const WorkingFrame& frame, const ModelView& view);

}  // namespace pf
