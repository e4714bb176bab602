// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <opencv2/core.hpp>
#include <string>
#include <vector>

#include "posefusion/core/trajectory.hpp"
#include "posefusion/io/ply.hpp"

namespace pf {

/// What a plan shows, all in the frame of the truth (or of the estimate where there is no truth).
struct Plan {
  std::vector<SurfacePoint> surface;  ///< the room, or the map; may be empty
  Trajectory truth;                   ///< may be empty
  Trajectory estimate;                ///< may be empty where there is a truth
  std::vector<std::size_t> wrong;     ///< indices of wrong poses of the estimate
  std::string title;                  ///< one line of figures

  const Trajectory& leading() const { return truth.empty() ? estimate : truth; }
};

/// Up in the frame of a trajectory: against the mean of the camera's y axis (down in the image),
/// or the axis of the frame nearest to that, when it is less than 30 degrees away. Unit length.
Eigen::Vector3d upOf(const Trajectory& trajectory);

/// The plan: surface, true and estimated path from above, with start and end, the wrong poses, a
/// scale bar and a legend. Surface that faces down (the ceiling) is left out, walls are grey.
/// CV_8UC3 R G B, 1200 pixels wide.
cv::Mat drawPlan(const Plan& plan);

}  // namespace pf
