// SPDX-License-Identifier: BSD-3-Clause
#include "posefusion/calibration/pair_equations.hpp"

#include <algorithm>
#include <cmath>
#include <cstddef>

#include "posefusion/core/parallel.hpp"

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

// Nodes in one row of a residual are three apart at most.
constexpr int kBand = 8;

/// Sums over the residuals of one pair.
struct PairSums {
  Matrix6d P;
  Vector6d p;
  SixRows C;
  // Of the field: products of nodes in different rows of a residual, with their mirror image, and
  // of those in one: kBand / 2 below the node itself.
  Eigen::MatrixXd half, band;

  explicit PairSums(Eigen::Index nodes)
      : P(Matrix6d::Zero()),
        p(Vector6d::Zero()),
        C(SixRows::Zero(6, nodes)),
        half(Eigen::MatrixXd::Zero(nodes, nodes)),
        band(Eigen::MatrixXd::Zero(kBand, nodes)) {}

  void addTo(Eigen::MatrixXd& H) const {
    H += half + half.transpose();
    for (Eigen::Index node = 0; node < band.cols(); ++node) {
      for (Eigen::Index k = 0; k < kBand; ++k) {
        const Eigen::Index other = node + k - kBand / 2;
        if (other >= 0 && other < band.cols()) H(other, node) += band(k, node);
      }
    }
  }
};

Vector6d slackInformation(const PairModel& model) {
  // A pose that is held has no variance: then nothing must move it.
  const double m = std::max(model.slack_m, 1e-9), rad = std::max(model.slack_rad, 1e-9);
  Vector6d information;
  information << Eigen::Vector3d::Constant(1 / (m * m)), Eigen::Vector3d::Constant(1 / (rad * rad));
  return information;
}

/// The derivatives of a residual by the nodes (some twice) that it depends on, in rows of four.
struct NodeRows {
  static constexpr int kRows = 8;
  int first[kRows];  ///< node of each row
  double value[4 * kRows];

  explicit NodeRows(const PairResidual& r) {
    fill(r.at_from, r.by_from, 0);
    fill(r.at_to, r.by_to, kRows / 2);
  }

 private:
  void fill(const FieldWeights& w, double by, int row) {
    for (int i = 0; i < 4; ++i) {
      first[row + i] = w.node(4 * i);
      for (int j = 0; j < 4; ++j) value[4 * (row + i) + j] = by * (w.down[i] * w.across[j]);
    }
  }
};

/// Where one residual is added to, of `nodes` nodes: see PairSums.
struct NodeSums {
  double *half, *band, *C, *g;
  int nodes;
};

/// `weighted`: the derivatives by the pose, times the weight.
POSEFUSION_SIMD_CLONES
void addToNodes(const NodeRows& rows, double weight, double e, const double* __restrict weighted,
                const NodeSums& sums) {
  for (int b = 0; b < NodeRows::kRows; ++b) {
    for (int i = 0; i < 4; ++i) {
      const int node = rows.first[b] + i;
      const double value = rows.value[4 * b + i], w = weight * value;
      double* __restrict column = sums.half + static_cast<std::ptrdiff_t>(node) * sums.nodes;
      for (int c = 0; c < b; ++c) {
        for (int j = 0; j < 4; ++j) column[rows.first[c] + j] += w * rows.value[4 * c + j];
      }
      double* __restrict own = sums.band + kBand * node + kBand / 2 - i;
      for (int j = 0; j < 4; ++j) own[j] += w * rows.value[4 * b + j];
      for (int k = 0; k < 6; ++k) sums.C[6 * node + k] += weighted[k] * value;
      sums.g[node] += w * e;
    }
  }
}

void addResidual(const PairResidual& r, const Vector6d& by_x, double weight, PairSums& pair,
                 Eigen::VectorXd& g) {
  const Vector6d weighted = weight * by_x;
  pair.P.noalias() += weighted * by_x.transpose();
  pair.p += weighted * r.e;
  addToNodes(NodeRows(r), weight, r.e, weighted.data(),
             {pair.half.data(), pair.band.data(), pair.C.data(), g.data(),
              static_cast<int>(pair.half.cols())});
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
  sums.addTo(equations.H);
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
