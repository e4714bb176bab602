// SPDX-License-Identifier: BSD-3-Clause
#include "point_pair.hpp"

#include "normal_equations_kernel.hpp"

namespace pf {
namespace {

constexpr double kNear_m = 0.05;

}  // namespace

bool findPair(const ModelPoints& model, std::size_t i, const FrameLevel& frame,
              const Eigen::Isometry3d& T_frame_model, const TermSettings& settings,
              PointPair& pair) {
  pair.q = T_frame_model * Eigen::Vector3d(model.x[i], model.y[i], model.z[i]);
  if (pair.q.z() < kNear_m) return false;
  const Eigen::Vector2d at = frame.camera.project(pair.q);
  const bool inside = at.x() >= 0 && at.y() >= 0 && at.x() < frame.camera.width - 1 &&
                      at.y() < frame.camera.height - 1;
  if (!inside) return false;
  pair.u = static_cast<int>(at.x() + 0.5);
  pair.v = static_cast<int>(at.y() + 0.5);
  const double depth = frame.depth_m.at<float>(pair.v, pair.u);
  if (depth <= 0) return false;
  pair.p = frame.camera.unproject(pair.u, pair.v, depth);
  const float sigma = settings.sensor.sigma(static_cast<float>(depth));
  return (pair.q - pair.p).norm() < kernel::mostApart(settings.max_distance_m, sigma);
}

}  // namespace pf
