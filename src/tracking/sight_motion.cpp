// SPDX-License-Identifier: BSD-3-Clause
#include "sight_motion.hpp"

#include <Eigen/Cholesky>
#include <algorithm>
#include <cmath>

#include "posefusion/core/symmetric.hpp"
#include "posefusion/frame/flow.hpp"

namespace pf {
namespace {

constexpr int kMaxIterations = 10;
// Standard deviation of a corner's place, in cornerPixel(): the same angle in images of any size,
// as far as those have the pixels.
constexpr double kCornerSigma = 0.3;
constexpr double kCauchyScale = 1.0;  // standard deviations
constexpr double kInlierSigmas = 4.0;
constexpr double kNearest_m = 0.1;  // before the later camera
// 1 / variance of SightMotion::far, of which anything from 0 to 2 is equally likely.
constexpr double kFarInformation = 3.0;
// Degrees of freedom of Student's t-distribution, by which a motion differs from the expected one:
// mostly little, and seldom, as a foot or a falling robot hits the ground, a lot.
constexpr double kSteadiness = 4.0;

using Vector7d = Eigen::Matrix<double, 7, 1>;
using Matrix7d = Eigen::Matrix<double, 7, 7>;

/// For the twist of T_after_before (update exp(twist) * T), and the step of `far`.
struct System {
  Matrix7d H = Matrix7d::Zero();
  Matrix6d H_expected = Matrix6d::Zero();  ///< what is expected adds to H
  Vector7d g = Vector7d::Zero();
  double weighted = 0, weights = 0;  ///< sums of weighted squared residuals (in sigmas), of weights
  double squared_px = 0;
  double cost = 0;
  int inliers = 0;

  /// Adds J'wJ and J'wr of one residual in standard deviations.
  void add(const Eigen::Matrix<double, 1, 7>& J, double r, double weight) {
    H += weight * J.transpose() * J;
    g += weight * J.transpose() * r;
    weighted += weight * r * r;
    weights += weight;
  }
};

void addSight(const Sight& l, const PinholeCamera& camera, const SightMotion& at, System& system) {
  const double sigma_px = l.spread * kCornerSigma * cornerPixel(camera.width);
  // Of a corner without depth all is in units of its distance.
  const double unit = l.hasDepth() ? 1.0 : at.far * l.far_inverse;
  const Eigen::Vector3d t = at.T_after_before.translation();
  const Eigen::Vector3d q = at.T_after_before.linear() * l.before + unit * t;
  if (q.z() < kNearest_m) return;
  const double iz = 1.0 / q.z();
  const Eigen::Vector2d error = (camera.project(q) - l.after_px) / sigma_px;
  Eigen::Matrix<double, 3, 7> dq;
  dq << unit * Eigen::Matrix3d::Identity(), -hat(q), l.far_inverse * t;
  Eigen::Matrix<double, 2, 3> dp;
  dp << camera.fx * iz, 0, -camera.fx * q.x() * iz * iz, 0, camera.fy * iz,
      -camera.fy * q.y() * iz * iz;
  double depth_error = 0, depth_sigma = 1;
  if (l.after_m > 0) {
    // Both depths are measured; the plane through a corner's depths halves the noise, edges add.
    depth_sigma = 1.4 * l.after_sigma_m;
    depth_error = (q.z() - l.after_m) / depth_sigma;
  }
  const double distance2 = error.squaredNorm() + depth_error * depth_error;
  const double weight = 1.0 / (1.0 + distance2 / (kCauchyScale * kCauchyScale));
  const Eigen::Matrix<double, 2, 7> J = dp * dq / sigma_px;
  system.add(J.row(0), error.x(), weight);
  system.add(J.row(1), error.y(), weight);
  if (l.after_m > 0) system.add(dq.row(2) / depth_sigma, depth_error, weight);
  system.cost -= 0.5 * kCauchyScale * kCauchyScale * std::log(weight);
  // Those beside people agree no sooner than others.
  const double plain2 = l.spread * l.spread * error.squaredNorm() + depth_error * depth_error;
  if (plain2 > kInlierSigmas * kInlierSigmas) return;
  ++system.inliers;
  system.squared_px += error.squaredNorm() * sigma_px * sigma_px;
}

/// The twist from the expected motion is small wherever it has weight: its derivative is taken as
/// the identity.
void addExpected(const ExpectedStep& expected, const SightMotion& at, System& system) {
  const Vector6d twist = logSe3(at.T_after_before * expected.T_before_after);
  const Matrix6d information = inverse(expected.covariance);
  const double distance2 = twist.dot(information * twist);
  const double weight = (kSteadiness + 6.0) / (kSteadiness + distance2);
  system.H_expected = weight * information;
  system.g.head<6>() += weight * information * twist;
  system.cost += 0.5 * (kSteadiness + 6.0) * std::log1p(distance2 / kSteadiness);
}

System build(const std::vector<Sight>& sights, const PinholeCamera& camera,
             const std::optional<ExpectedStep>& expected, const SightMotion& at) {
  System system;
  if (expected) addExpected(*expected, at, system);
  for (const Sight& sight : sights) addSight(sight, camera, at, system);
  system.H(6, 6) += kFarInformation;
  system.g[6] += kFarInformation * (at.far - 1.0);
  return system;
}

}  // namespace

bool fitMotion(const std::vector<Sight>& sights, const PinholeCamera& camera,
               const std::optional<ExpectedStep>& expected, SightMotion& motion) {
  System system;
  for (int i = 0; i < kMaxIterations; ++i) {
    system = build(sights, camera, expected, motion);
    Matrix7d H = system.H;
    H.topLeftCorner<6, 6>() += system.H_expected;
    const Vector7d step = H.ldlt().solve(-system.g);
    const Vector6d twist = step.head<6>();
    if (!step.allFinite() || twist.norm() > 1.0) return false;
    motion.T_after_before = expSe3(twist) * motion.T_after_before;
    motion.far = std::clamp(motion.far + step[6], 0.0, 2.0);
    if (twist.norm() < 1e-5) break;
  }
  motion.inliers = system.inliers;
  motion.squared_px = system.squared_px;
  motion.cost = system.cost;
  // How much worse than assumed the corners are: blurred, of a misplaced color camera.
  const double scale = std::max(1.0, system.weighted / system.weights);
  // What was expected follows from the steps before: in a chain of them its error would be counted
  // as if each were independent.
  const Matrix7d inverse = system.H.ldlt().solve(Matrix7d::Identity());
  motion.covariance = scale * inverse.topLeftCorner<6, 6>();
  return true;
}

}  // namespace pf
