// SPDX-License-Identifier: BSD-3-Clause
#include "place_errors.hpp"

#include <array>
#include <cmath>

#include "point_pair.hpp"
#include "posefusion/calibration/depth_field.hpp"

namespace pf {
namespace {

// A calibration's nodes are as far apart as errors are known to go together.
constexpr int kAcross = DepthField::kColumns, kDown = DepthField::kRows;

/// Standard deviation (m) of what does not average out within a place at distance z (m): the
/// systematic error, and the rounding of a surface that lies within one step.
double placeSigma(const DepthSensor& sensor, double z_m) {
  const double uniform = sensor.step_1_m / std::sqrt(12.0);
  const double per_square = std::hypot(sensor.systematic_1_m, uniform);
  return std::hypot(sensor.systematic_m, per_square * z_m * z_m);
}

/// A pair, and the model's normal in the camera frame.
struct FacingPair : PointPair {
  Eigen::Vector3d normal;
};

/// False where there is no pair within the gates.
bool findPair(const ModelPoints& model, std::size_t i, const FrameLevel& frame,
              const Eigen::Isometry3d& T, const TermSettings& settings, FacingPair& pair) {
  PointPair& points = pair;
  if (!findPair(model, i, frame, T, settings, points)) return false;
  pair.normal = T.linear() * Eigen::Vector3d(model.nx[i], model.ny[i], model.nz[i]);
  const Eigen::Vector3d seen(frame.normal_x.at<float>(pair.v, pair.u),
                             frame.normal_y.at<float>(pair.v, pair.u),
                             frame.normal_z.at<float>(pair.v, pair.u));
  return pair.normal.dot(seen) > settings.min_normal_cosine;
}

/// w J' times what the residual is off by where the place is off by one standard deviation.
Vector6d pullOf(const FacingPair& pair, float point_weight, const TermSettings& settings) {
  const auto depth = static_cast<float>(pair.p.z());
  const double sigma = settings.sensor.sigma(depth);
  const double x = pair.normal.dot(pair.q - pair.p) / (sigma * settings.robust_scale);
  const double root = 1.0 / (1.0 + x * x);
  const double weight = root * root * static_cast<double>(point_weight) / (sigma * sigma);
  const double off_m = placeSigma(settings.sensor, pair.p.z());
  Vector6d J;
  J << pair.normal, pair.q.cross(pair.normal);
  return weight * pair.normal.dot(pair.p) / pair.p.z() * off_m * J;
}

}  // namespace

PlaceErrors placeErrors(const ModelPoints& model, const FrameLevel& frame,
                        const Eigen::Isometry3d& T_frame_model, const TermSettings& settings) {
  std::array<Vector6d, static_cast<std::size_t>(kAcross) * kDown> places;
  places.fill(Vector6d::Zero());
  PlaceErrors errors;
  int pairs = 0;
  double inverse_distances = 0;
  FacingPair pair;
  for (std::size_t i = 0; i < model.count; i += kEvery) {
    if (!findPair(model, i, frame, T_frame_model, settings, pair)) continue;
    const int place =
        pair.v * kDown / frame.camera.height * kAcross + pair.u * kAcross / frame.camera.width;
    places[static_cast<std::size_t>(place)] += pullOf(pair, model.weight[i], settings);
    inverse_distances += 1.0 / pair.p.norm();
    ++pairs;
  }
  if (pairs == 0) return errors;
  errors.distance_m = pairs / inverse_distances;
  for (const Vector6d& b : places) errors.gradient += b * b.transpose();
  errors.gradient *= static_cast<double>(kEvery * kEvery);
  return errors;
}

}  // namespace pf
