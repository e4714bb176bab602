// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <vector>

#include "posefusion/calibration/pair_residual.hpp"
#include "posefusion/calibration/view_pairs.hpp"

namespace pf {

/// How residuals of pairs are weighed.
struct PairModel {
  /// Standard deviation (1/m) of what is wrong with inverse depth besides the noise of the sensor:
  /// as yet unknown field, finer structure than the grid, normals.
  double rest_per_m = 0.005;
  std::size_t patches = 1000;  ///< of each view are compared, spread over it
  /// To so much (m, rad) the pose of a pair is held to the map's. Next to nothing: it was found
  /// with depth that is off by the field, and would hold the field to its own error.
  double pose_sigma_m = 0.3, pose_sigma_rad = 0.15;
  /// Residuals beyond so many standard deviations hardly count (Geman and McClure).
  double robust_scale = 2.0;

  /// How many patches share what is wrong, as they lie in one cell of the grid.
  double patchesOfCell() const;
};

/// A residual as it is judged.
struct Judged {
  double e = 0;         ///< 1/m
  double variance = 0;  ///< of the noise alone
  double share = 0;     ///< how often the rest enters: 1 + by_from^2
  double metres = 0;    ///< as in PairResidual

  double loss(const PairModel& model) const;    ///< 0..1
  double weight(const PairModel& model) const;  ///< (1/m)^-2
};

/// All residuals of a pair, of the patches of both views, at a pose that is `x` (twist) off.
std::vector<Judged> residualsOf(const ViewPair& pair, const std::vector<ViewSurface>& surfaces,
                                const DepthField& field, const Vector6d& x, const PairModel& model);

/// Normal equations of a Gauss-Newton step of the field, summed over pairs.
struct FieldEquations {
  Eigen::MatrixXd H;
  Eigen::VectorXd g;
  std::size_t residuals = 0;

  FieldEquations& operator+=(const FieldEquations& other);
};

/// What one pair has to say.
struct PairStep {
  /// How its pose follows from a step of the field: x += own + by_field * step.
  Vector6d own = Vector6d::Zero();
  Eigen::Matrix<double, 6, Eigen::Dynamic> by_field;
  Eigen::VectorXd g;  ///< its part of FieldEquations::g
};

/// Adds a pair whose pose is `x` off to the equations of the field. The pose of the pair, normally
/// distributed about the one given, is eliminated (Schur complement): what a wrong pose explains
/// teaches the field nothing.
void addPair(const ViewPair& pair, const std::vector<ViewSurface>& surfaces,
             const DepthField& field, const Vector6d& x, const PairModel& model,
             FieldEquations& equations, PairStep& step);

/// The pose (twist x) that fits a pair best with the field as it is.
Vector6d fittedPose(const ViewPair& pair, const std::vector<ViewSurface>& surfaces,
                    const DepthField& field, const PairModel& model);

}  // namespace pf
