// SPDX-License-Identifier: BSD-3-Clause
#include "posefusion/tracking/rotation.hpp"

#include <Eigen/Cholesky>
#include <cmath>

#include "posefusion/core/se3.hpp"

namespace pf {
namespace {

constexpr int kMaxTurns = 12;
constexpr double kMinOverlap = 0.3;  // part of the image that must be seen in both
constexpr double kSmallStepRad = 1e-4;

struct RotationSystem {
  Eigen::Matrix3d H = Eigen::Matrix3d::Zero();
  Eigen::Vector3d g = Eigen::Vector3d::Zero();
  double squared = 0, sum = 0, count = 0;
  Eigen::Vector3d jacobian_sum = Eigen::Vector3d::Zero();

  /// Mean squared error after the mean brightness difference is taken off.
  double error() const { return count > 0 ? squared / count - (sum / count) * (sum / count) : 0; }
};

/// Bilinear value and gradient; false outside or on a person.
bool sample(const SmallImage& image, double u, double v, Eigen::Vector3d& value_gradient) {
  if (!(u >= 0 && v >= 0 && u < image.intensity.cols - 1 && v < image.intensity.rows - 1)) {
    return false;
  }
  const int iu = static_cast<int>(u), iv = static_cast<int>(v);
  if (image.still.at<unsigned char>(iv, iu) == 0) return false;
  const double a = u - iu, b = v - iv;
  const float* top = image.intensity.ptr<float>(iv) + iu;
  const float* bottom = image.intensity.ptr<float>(iv + 1) + iu;
  const double upper = top[0] + a * (top[1] - top[0]);
  const double lower = bottom[0] + a * (bottom[1] - bottom[0]);
  value_gradient = {upper + b * (lower - upper),
                    (1 - b) * (top[1] - top[0]) + b * (bottom[1] - bottom[0]), lower - upper};
  return true;
}

RotationSystem build(const SmallImage& previous, const SmallImage& current,
                     const PinholeCamera& camera, const Eigen::Matrix3d& R) {
  RotationSystem system;
  for (int v = 0; v < previous.intensity.rows; ++v) {
    for (int u = 0; u < previous.intensity.cols; ++u) {
      if (previous.still.at<unsigned char>(v, u) == 0) continue;
      const Eigen::Vector3d q = R * camera.unproject(u, v, 1.0);
      if (q.z() < 0.1) continue;
      const Eigen::Vector2d pixel = camera.project(q);
      Eigen::Vector3d s;
      if (!sample(current, pixel.x(), pixel.y(), s)) continue;
      const double r = s[0] - previous.intensity.at<float>(v, u);
      const double gx = s[1] * camera.fx / q.z(), gy = s[2] * camera.fy / q.z();
      const Eigen::Vector3d a(gx, gy, -(gx * q.x() + gy * q.y()) / q.z());
      const Eigen::Vector3d J = q.cross(a);
      system.H += J * J.transpose();
      system.g += J * r;
      system.jacobian_sum += J;
      system.squared += r * r;
      system.sum += r;
      system.count += 1;
    }
  }
  return system;
}

}  // namespace

Eigen::Matrix3d alignRotation(const SmallImage& previous, const SmallImage& current,
                              const PinholeCamera& camera) {
  Eigen::Matrix3d best = Eigen::Matrix3d::Identity();
  Eigen::Matrix3d R = best;
  double best_error = -1;
  for (int i = 0; i < kMaxTurns; ++i) {
    const RotationSystem system = build(previous, current, camera, R);
    if (system.count < kMinOverlap * static_cast<double>(previous.intensity.total())) break;
    if (best_error >= 0 && system.error() >= best_error) break;
    best = R;
    best_error = system.error();
    // Eliminate the mean brightness difference (Schur complement of the offset).
    const Eigen::Matrix3d H =
        system.H - system.jacobian_sum * system.jacobian_sum.transpose() / system.count;
    const Eigen::Vector3d g = system.g - system.jacobian_sum * (system.sum / system.count);
    const Eigen::LDLT<Eigen::Matrix3d> ldlt(H);
    if (ldlt.info() != Eigen::Success || !(ldlt.vectorD().minCoeff() > 1e-3)) break;
    const Eigen::Vector3d step = ldlt.solve(-g);
    if (!step.allFinite() || step.norm() < kSmallStepRad) break;
    R = expSo3(step) * R;
  }
  return best;
}

}  // namespace pf
