// SPDX-License-Identifier: BSD-3-Clause
#include "noise_information.hpp"

#include "point_pair.hpp"
#include "posefusion/frame/picture_noise.hpp"

namespace pf {
namespace {

// A difference of two interpolated pixels, of the noise's variance, over all places between pixels.
constexpr double kOfGradient = 4.0 / 3.0;

/// The point's derivatives by the camera's motion, of a gradient of 1 along u or v: as
/// normal_equations_kernel.cpp has them.
Vector6d derivative(const Eigen::Vector3d& q, double gx, double gy) {
  const Eigen::Vector3d a(gx, gy, -(gx * q.x() + gy * q.y()) / q.z());
  Vector6d J;
  J << a, q.cross(a);
  return J;
}

}  // namespace

Matrix6d noiseInformation(const ModelPoints& model, const FrameLevel& frame,
                          const Eigen::Isometry3d& T_frame_model, const TermSettings& settings) {
  Matrix6d information = Matrix6d::Zero();
  if (settings.photometric_sigma <= 0) return information;
  const PinholeCamera& camera = frame.camera;
  PointPair pair;
  for (std::size_t i = 0; i < model.count; i += kEvery) {
    if (!findPair(model, i, frame, T_frame_model, settings, pair)) continue;
    const Brightness& b = settings.brightness;
    const double residual =
        frame.intensity.at<float>(pair.v, pair.u) - (b.gain * model.intensity[i] + b.offset);
    const double x = residual / (3 * settings.photometric_sigma);
    const double root = 1.0 / (1.0 + x * x);
    const double weight = root * root * static_cast<double>(model.weight[i]);
    const Vector6d by_u = derivative(pair.q, camera.fx / pair.q.z(), 0);
    const Vector6d by_v = derivative(pair.q, 0, camera.fy / pair.q.z());
    information += weight * (by_u * by_u.transpose() + by_v * by_v.transpose());
  }
  const double noise = pictureNoise(frame.intensity) / settings.photometric_sigma;
  return static_cast<double>(kEvery) * kOfGradient * noise * noise * information;
}

}  // namespace pf
