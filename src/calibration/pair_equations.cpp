// SPDX-License-Identifier: BSD-3-Clause
#include "posefusion/calibration/pair_equations.hpp"

#include <algorithm>
#include <array>
#include <cmath>

namespace pf {
namespace {

// Cells of a grid of 12 x 9 splines: the outermost do not reach into the image.
constexpr double kCells = 9 * 6;

template <typename Visit>
void forSome(const std::vector<SurfacePatch>& patches, std::size_t most, const Visit& visit) {
  const std::size_t count = std::min(patches.size(), most);
  for (std::size_t i = 0; i < count; ++i) visit(patches[i * patches.size() / count]);
}

/// Calls visit(residual, by_x) for the patches of both views; by_x: derivative by the pair's twist.
template <typename Visit>
void forResiduals(const ViewPair& pair, const std::vector<ViewSurface>& surfaces,
                  const DepthField& field, std::size_t patches, const Visit& visit) {
  const ViewSurface &a = surfaces[pair.from], &b = surfaces[pair.to];
  const Eigen::Isometry3d &T_b_a = pair.T_to_from, T_a_b = T_b_a.inverse();
  forSome(a.patches(), patches, [&](const SurfacePatch& patch) {
    if (const auto r = pairResidual(patch, a, b, T_b_a, field)) visit(*r, r->by_pose);
  });
  // exp(d) T_b_a is T_a_b exp(-d) the other way: exp(-Ad d) T_a_b.
  const Matrix6d back = -adjoint(T_a_b).transpose();
  forSome(b.patches(), patches, [&](const SurfacePatch& patch) {
    if (const auto r = pairResidual(patch, b, a, T_a_b, field)) {
      visit(*r, Vector6d(back * r->by_pose));
    }
  });
}

Judged judged(const PairResidual& r) {
  return {r.e, r.variance, 1.0 + r.by_from * r.by_from, r.metres};
}

/// Sums over the residuals of one pair.
struct PairSums {
  Matrix6d P;
  Vector6d p;
  SixRows C;
  // Of the field: with its mirror image, and the products of each node with itself.
  Eigen::MatrixXd half;
  Eigen::VectorXd squares;

  explicit PairSums(Eigen::Index nodes)
      : P(Matrix6d::Zero()),
        p(Vector6d::Zero()),
        C(SixRows::Zero(6, nodes)),
        half(Eigen::MatrixXd::Zero(nodes, nodes)),
        squares(Eigen::VectorXd::Zero(nodes)) {}
};

Vector6d slackInformation(const PairModel& model) {
  // A pose that is held has no variance: then nothing must move it.
  const double m = std::max(model.slack_m, 1e-9), rad = std::max(model.slack_rad, 1e-9);
  Vector6d information;
  information << Eigen::Vector3d::Constant(1 / (m * m)), Eigen::Vector3d::Constant(1 / (rad * rad));
  return information;
}

/// The derivatives of a residual by the nodes (some twice) that it depends on.
struct NodeRow {
  static constexpr std::size_t kNodes = 2 * FieldWeights::kNodes;
  std::array<Eigen::Index, kNodes> node;
  std::array<double, kNodes> value;

  explicit NodeRow(const PairResidual& r) {
    for (std::size_t k = 0; k < FieldWeights::kNodes; ++k) {
      node[k] = r.at_from.node[k];
      value[k] = r.by_from * r.at_from.weight[k];
      node[k + FieldWeights::kNodes] = r.at_to.node[k];
      value[k + FieldWeights::kNodes] = r.by_to * r.at_to.weight[k];
    }
  }
};

void addResidual(const PairResidual& r, const Vector6d& by_x, double weight, PairSums& pair,
                 Eigen::VectorXd& g) {
  const NodeRow row(r);
  const Vector6d weighted = weight * by_x;
  pair.P.noalias() += weighted * by_x.transpose();
  pair.p += weighted * r.e;
  for (std::size_t i = 0; i < NodeRow::kNodes; ++i) {
    pair.C.col(row.node[i]) += weighted * row.value[i];
    const double wi = weight * row.value[i];
    g[row.node[i]] += wi * r.e;
    double* column = pair.half.col(row.node[i]).data();
    for (std::size_t j = 0; j < i; ++j) column[row.node[j]] += wi * row.value[j];
    pair.squares[row.node[i]] += wi * row.value[i];
  }
}

}  // namespace

double PairModel::patchesOfCell() const { return static_cast<double>(patches) / kCells; }

double Judged::loss(const PairModel& model) const {
  const double rest = model.rest_per_m * model.rest_per_m * share;
  const double x = e * e / ((variance + rest) * model.robust_scale * model.robust_scale);
  return x / (1.0 + x);
}

double Judged::weight(const PairModel& model) const {
  const double rest = model.rest_per_m * model.rest_per_m * share;
  const double x = e * e / ((variance + rest) * model.robust_scale * model.robust_scale);
  return 1.0 / ((variance + model.patchesOfCell() * rest) * (1.0 + x) * (1.0 + x));
}

std::vector<Judged> residualsOf(const ViewPair& pair, const std::vector<ViewSurface>& surfaces,
                                const DepthField& field, const PairModel& model) {
  std::vector<Judged> all;
  forResiduals(pair, surfaces, field, model.patches,
               [&](const PairResidual& r, const Vector6d&) { all.push_back(judged(r)); });
  return all;
}

FieldEquations& FieldEquations::operator+=(const FieldEquations& other) {
  if (other.H.size() == 0) return *this;
  if (H.size() == 0) return *this = other;
  H += other.H;
  g += other.g;
  residuals += other.residuals;
  return *this;
}

void addPair(const ViewPair& pair, const std::vector<ViewSurface>& surfaces,
             const DepthField& field, const Vector6d& c, const PairModel& model,
             FieldEquations& equations, PairStep& step) {
  const auto nodes = static_cast<Eigen::Index>(field.nodes().size());
  if (equations.H.size() == 0) {
    equations.H.setZero(nodes, nodes);
    equations.g.setZero(nodes);
  }
  PairSums sums(nodes);
  step.g.setZero(nodes);
  forResiduals(pair, surfaces, field, model.patches,
               [&](const PairResidual& r, const Vector6d& by_x) {
                 addResidual(r, by_x, judged(r).weight(model), sums, step.g);
                 ++equations.residuals;
               });
  equations.H += sums.half + sums.half.transpose();
  equations.H.diagonal() += sums.squares;
  const Matrix6d W = slackInformation(model).asDiagonal();
  const Matrix6d P = sums.P + W;
  step.own = -solve(P, sums.p - W * c);
  step.by_field = -solve(P, sums.C);
  step.by_views = solve(P, W);
  step.H_views = W - W * step.by_views;
  step.g_views = W * (c - step.own);
  step.H_views_field = -W * step.by_field;
  equations.H.noalias() += sums.C.transpose() * step.by_field;
  step.g.noalias() += sums.C.transpose() * step.own;
  equations.g += step.g;
}

ViewPair fitted(ViewPair pair, const std::vector<ViewSurface>& surfaces, const DepthField& field,
                const PairModel& model) {
  constexpr int kSteps = 3;
  for (int i = 0; i < kSteps; ++i) {
    PairSums sums(0);
    forResiduals(pair, surfaces, field, model.patches,
                 [&](const PairResidual& r, const Vector6d& by_x) {
                   const double weight = judged(r).weight(model);
                   sums.P.noalias() += weight * by_x * by_x.transpose();
                   sums.p += weight * r.e * by_x;
                 });
    pair.T_to_from = expSe3(-solve(sums.P, sums.p)) * pair.T_to_from;
  }
  return pair;
}

}  // namespace pf
