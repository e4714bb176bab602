// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string>
#include <vector>

#include "posefusion/calibration/color_camera.hpp"
#include "posefusion/calibration/edge_view.hpp"

namespace pf {

/// The colour camera in which the steps of depth lie on edges best.
struct ColorEstimate {
  ColorCamera camera;
  double offset_px = 0;     ///< how far colour is from where it belongs, RMS over the steps
  double unknown_px = 0;    ///< by how much the estimates of two halves of the views differ, halved
  double significance = 0;  ///< gain in views that were kept out, over its standard error
  double contrast = 1;      ///< how much more of an edge is at the steps than around them
  std::string doubt;        ///< why colour is to be left as it is; empty: it is off
};

/// `depth`: the camera of the views, without distortion. The same bits for any number of threads.
ColorEstimate estimateColorCamera(const std::vector<EdgeView>& views, const PinholeCamera& depth);

}  // namespace pf
