// SPDX-License-Identifier: BSD-3-Clause
#include "posefusion/calibration/view_poses.hpp"

#include <Eigen/SparseCholesky>

#include "posefusion/core/symmetric.hpp"

namespace pf {
namespace {

using Blocks = std::vector<Eigen::Triplet<double>>;

// To so much (m, rad) a step of a view is held, so that all of them together, which no pair ties
// to anything, have a place.
constexpr double kHeld_m = 3.0, kHeld_rad = 1.5;

Eigen::Index rowOf(std::size_t view) { return 6 * static_cast<Eigen::Index>(view); }

void addBlock(std::size_t a, std::size_t b, const Matrix6d& block, Blocks& H) {
  for (Eigen::Index col = 0; col < 6; ++col) {
    for (Eigen::Index row = 0; row < 6; ++row) {
      H.emplace_back(rowOf(a) + row, rowOf(b) + col, block(row, col));
    }
  }
}

/// exp(v) of a pair for small steps of its views, twists in their own frames.
template <typename Block>
auto stepOf(const ViewPair& pair, const Block& of_views) {
  return (adjoint(pair.T_to_from) * of_views.middleRows(rowOf(pair.from), 6) -
          of_views.middleRows(rowOf(pair.to), 6))
      .eval();
}

}  // namespace

ViewPoses::ViewPoses(const std::vector<ViewSurface>& surfaces) {
  for (const ViewSurface& surface : surfaces) T_map_view_.push_back(surface.T_map_camera());
}

Eigen::Isometry3d ViewPoses::T_to_from(const ViewPair& pair) const {
  return T_map_view_[pair.to].inverse() * T_map_view_[pair.from];
}

Vector6d ViewPoses::apart(const ViewPair& pair) const {
  return logSe3(T_to_from(pair) * pair.T_to_from.inverse());
}

void ViewPoses::eliminate(const std::vector<ViewPair>& pairs, const std::vector<PairStep>& steps,
                          FieldEquations& sum) {
  const Eigen::Index unknowns = rowOf(T_map_view_.size()), nodes = sum.g.size();
  Blocks blocks;
  const Matrix6d held = inverse(independentCovariance(kHeld_m, kHeld_rad));
  for (std::size_t i = 0; i < T_map_view_.size(); ++i) addBlock(i, i, held, blocks);
  // The equations of the views with the field, and without it.
  Eigen::MatrixXd right = Eigen::MatrixXd::Zero(unknowns, nodes + 1);
  for (std::size_t k = 0; k < pairs.size(); ++k) {
    const std::size_t from = pairs[k].from, to = pairs[k].to;
    const Matrix6d by_from = adjoint(pairs[k].T_to_from);
    const Matrix6d H_from = by_from.transpose() * steps[k].H_views;
    addBlock(from, from, H_from * by_from, blocks);
    addBlock(from, to, -H_from, blocks);
    addBlock(to, from, -H_from.transpose(), blocks);
    addBlock(to, to, steps[k].H_views, blocks);
    Eigen::MatrixXd of_pair(6, nodes + 1);
    of_pair << steps[k].H_views_field, steps[k].g_views;
    right.middleRows(rowOf(from), 6).noalias() += by_from.transpose() * of_pair;
    right.middleRows(rowOf(to), 6) -= of_pair;
  }
  Eigen::SparseMatrix<double> H(unknowns, unknowns);
  H.setFromTriplets(blocks.begin(), blocks.end());
  const Eigen::SimplicialLDLT<Eigen::SparseMatrix<double>> solver(H);
  by_field_ = -solver.solve(right);
  const Eigen::MatrixXd less = right.leftCols(nodes).transpose() * by_field_;
  sum.H += less.leftCols(nodes);
  sum.g += less.col(nodes);
}

Eigen::VectorXd ViewPoses::scoreOf(const ViewPair& pair, const PairStep& step) const {
  const auto by_field = stepOf(pair, by_field_);
  return step.g + by_field.leftCols(by_field.cols() - 1).transpose() * step.g_views;
}

void ViewPoses::move(const Eigen::VectorXd& step, const std::vector<PairStep>& steps,
                     std::vector<ViewPair>& pairs) {
  const Eigen::Index nodes = step.size();
  const Eigen::VectorXd y = by_field_.leftCols(nodes) * step + by_field_.col(nodes);
  for (std::size_t k = 0; k < pairs.size(); ++k) {
    const Vector6d v = stepOf(pairs[k], y);
    const Vector6d x = steps[k].own + steps[k].by_field * step + steps[k].by_views * v;
    pairs[k].T_to_from = expSe3(x) * pairs[k].T_to_from;
  }
  for (std::size_t i = 0; i < T_map_view_.size(); ++i) {
    T_map_view_[i] = T_map_view_[i] * expSe3(Vector6d(y.segment<6>(rowOf(i))));
  }
}

}  // namespace pf
