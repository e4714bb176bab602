// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <vector>

#include "posefusion/calibration/pair_residual.hpp"
#include "posefusion/calibration/view_pairs.hpp"
#include "posefusion/core/symmetric.hpp"

namespace pf {

/// How residuals of pairs are weighed.
struct PairModel {
  /// Standard deviation (1/m) of what is wrong with inverse depth besides the noise of the sensor:
  /// as yet unknown field, finer structure than the grid, normals.
  double rest_per_m = 0.005;
  std::size_t patches = 1000;  ///< of each view are compared, spread over it
  /// By so much (m, rad) the pose that fits a pair may be off from where its two views are,
  /// besides what the noise of its patches explains.
  double slack_m = 0.0025, slack_rad = 0.00125;
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

/// All residuals of a pair, of the patches of both views, at its pose.
std::vector<Judged> residualsOf(const ViewPair& pair, const std::vector<ViewSurface>& surfaces,
                                const DepthField& field, const PairModel& model);

/// Normal equations of a Gauss-Newton step of the field, summed over pairs.
struct FieldEquations {
  Eigen::MatrixXd H;
  Eigen::VectorXd g;
  std::size_t residuals = 0;

  FieldEquations& operator+=(const FieldEquations& other);
};

/// What one pair has to say. Its pose is exp(x) T_to_from; its views, where they are, say
/// exp(c + v) T_to_from, v being a step of theirs.
struct PairStep {
  /// How its pose follows from steps of the field and of its views:
  /// x = own + by_field * step + by_views * v.
  Vector6d own = Vector6d::Zero();
  SixRows by_field;
  Matrix6d by_views = Matrix6d::Zero();
  Eigen::VectorXd g;                    ///< its part of FieldEquations::g
  Matrix6d H_views = Matrix6d::Zero();  ///< normal equations of v
  Vector6d g_views = Vector6d::Zero();
  SixRows H_views_field;
};

/// Adds a pair to the equations of the field; `c` is how far its pose is from where its views are.
/// The pose of the pair, normally distributed about that, is eliminated (Schur complement): what a
/// wrong pose explains teaches the field nothing.
void addPair(const ViewPair& pair, const std::vector<ViewSurface>& surfaces,
             const DepthField& field, const Vector6d& c, const PairModel& model,
             FieldEquations& equations, PairStep& step);

/// The pair at the pose that fits it best with the field as it is, wherever its views are.
ViewPair fitted(ViewPair pair, const std::vector<ViewSurface>& surfaces, const DepthField& field,
                const PairModel& model);

}  // namespace pf
