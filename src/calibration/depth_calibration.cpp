// SPDX-License-Identifier: BSD-3-Clause
#include "posefusion/calibration/depth_calibration.hpp"

#include <algorithm>
#include <cmath>
#include <sstream>

namespace pf {

std::string misfit(const DepthCalibration& calibration, const PinholeCamera& camera) {
  const PinholeCamera& own = calibration.camera;
  const auto shift = [](double f_own, double c_own, int size_own, double f, double c, int size) {
    // Rays at both borders of the images, in parts of their width.
    double most = 0;
    for (const double border : {0.0, 1.0}) {
      const double ray = (border * size_own - 0.5 - c_own) / f_own;
      most = std::max(most, std::abs((f * ray + c + 0.5) / size - border));
    }
    return most;
  };
  const double x = shift(own.fx, own.cx, own.width, camera.fx, camera.cx, camera.width);
  const double y = shift(own.fy, own.cy, own.height, camera.fy, camera.cy, camera.height);
  if (x < 0.5 / (DepthField::kColumns - 1) && y < 0.5 / (DepthField::kRows - 1)) return {};
  std::ostringstream text;
  text << "is of a camera of another view (" << own.width << " x " << own.height << ", fx "
       << own.fx << ") than the frames (" << camera.width << " x " << camera.height << ", fx "
       << camera.fx << ")";
  return text.str();
}

}  // namespace pf
