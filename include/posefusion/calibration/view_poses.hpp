// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Geometry>
#include <vector>

#include "posefusion/calibration/pair_equations.hpp"
#include "posefusion/calibration/view_surface.hpp"

namespace pf {

/// Poses of the views of many pairs, from the pairs alone and not from the map, whose poses were
/// found with depth that is off by the field. A circle of pairs teaches the field what no single
/// pair can show: steps that all turn a little too far do not add up to a whole turn.
class ViewPoses {
 public:
  /// Starts where the map has them.
  explicit ViewPoses(const std::vector<ViewSurface>& surfaces);

  /// Of a pair, by where its views are.
  Eigen::Isometry3d T_to_from(const ViewPair& pair) const;

  /// How far the pose of a pair is from that: exp(c) T_to_from.
  Vector6d apart(const ViewPair& pair) const;

  /// Eliminates the steps of all views from the equations of the field, summed over pairs (Schur
  /// complement).
  void eliminate(const std::vector<ViewPair>& pairs, const std::vector<PairStep>& steps,
                 FieldEquations& sum);

  /// What one of these pairs has to say of the field (gradient), once views are eliminated.
  Eigen::VectorXd scoreOf(const ViewPair& pair, const PairStep& step) const;

  /// Moves the views as a step of the field wants them, once eliminated, and pairs as both want.
  void move(const Eigen::VectorXd& step, const std::vector<PairStep>& steps,
            std::vector<ViewPair>& pairs);

 private:
  std::vector<Eigen::Isometry3d> T_map_view_;
  /// How steps of the views follow from one of the field; last column: those without one.
  Eigen::MatrixXd by_field_;
};

}  // namespace pf
