// SPDX-License-Identifier: BSD-3-Clause
#include "field_solver.hpp"

#include <Eigen/Cholesky>
#include <algorithm>
#include <cmath>

#include "posefusion/calibration/view_poses.hpp"
#include "posefusion/core/parallel.hpp"

namespace pf {
namespace {

constexpr std::size_t kPairGrain = 16;

/// A step of the field that is so small a part of what an uncalibrated camera has is the last.
constexpr double kConverged = 0.002;

/// Patches, of all pairs, that tell what the field leaves unexplained: half a percent sure.
constexpr std::size_t kPatchesOfRest = 50000;

/// Half of |x| of a standard normal variable is below it.
constexpr double kMedianOfNormal = 0.6745;

/// Adds what is known of any camera: errors are small, and smooth over the image.
void addPrior(const DepthField& found, const FieldEstimateConfig& config, FieldEquations& sum) {
  const DepthField field = config.known.then(found);
  const double node = 1.0 / (config.node_sigma_per_m * config.node_sigma_per_m);
  const double smooth = 1.0 / (config.smooth_sigma_per_m * config.smooth_sigma_per_m);
  const auto& d = field.nodes();
  const auto couple = [&](Eigen::Index a, Eigen::Index b) {
    const double difference = d[static_cast<std::size_t>(a)] - d[static_cast<std::size_t>(b)];
    sum.H(a, a) += smooth;
    sum.H(b, b) += smooth;
    sum.H(a, b) -= smooth;
    sum.H(b, a) -= smooth;
    sum.g[a] += smooth * difference;
    sum.g[b] -= smooth * difference;
  };
  for (int row = 0; row < field.rows(); ++row) {
    for (int col = 0; col < field.columns(); ++col) {
      const Eigen::Index i = row * field.columns() + col;
      sum.H(i, i) += node;
      sum.g[i] += node * d[static_cast<std::size_t>(i)];
      if (col + 1 < field.columns()) couple(i, i + 1);
      if (row + 1 < field.rows()) couple(i, i + field.columns());
    }
  }
}

/// What the field leaves unexplained (1/m): such that half of the residuals are within the median
/// of a normal distribution.
double restOf(const std::vector<ViewPair>& pairs, const std::vector<ViewSurface>& surfaces,
              const DepthField& field, const PairModel& model, double most) {
  PairModel some_patches = model;
  some_patches.patches =
      std::min(model.patches, std::max<std::size_t>(1, kPatchesOfRest / (2 * pairs.size() + 1)));
  std::vector<std::vector<Judged>> of_pair(pairs.size());
  parallelFor(pairs.size(), kPairGrain, [&](std::size_t begin, std::size_t end) {
    for (std::size_t i = begin; i < end; ++i) {
      of_pair[i] = residualsOf(pairs[i], surfaces, field, some_patches);
    }
  });
  std::size_t count = 0;
  for (const auto& some : of_pair) count += some.size();
  if (count == 0) return most;
  const auto within = [&](double rest) {
    std::size_t inside = 0;
    for (const auto& some : of_pair) {
      for (const Judged& r : some) {
        const double sigma2 = r.variance + rest * rest * r.share;
        if (r.e * r.e < kMedianOfNormal * kMedianOfNormal * sigma2) ++inside;
      }
    }
    return 2 * inside >= count;
  };
  double low = 0, high = most;
  for (int i = 0; i < 12; ++i) (within((low + high) / 2) ? high : low) = (low + high) / 2;
  return high;
}

/// The inverse of the equations where the mean of the field is held, and the step to a field whose
/// mean is zero.
struct Step {
  Eigen::MatrixXd inverse;
  Eigen::VectorXd step;
};

Step solveStep(const FieldEquations& sum, const DepthField& field) {
  const Eigen::Index n = sum.g.size();
  const std::vector<double> shares = field.shares();
  const Eigen::VectorXd mean = Eigen::Map<const Eigen::VectorXd>(shares.data(), n);
  const Eigen::MatrixXd inverse = sum.H.ldlt().solve(Eigen::MatrixXd::Identity(n, n));
  const Eigen::VectorXd toward = inverse * mean;
  const double stiffness = mean.dot(toward);
  Step result;
  result.inverse = inverse - toward * toward.transpose() / stiffness;
  result.step = -result.inverse * sum.g - toward * (field.mean() / stiffness);
  return result;
}

DepthField moved(const DepthField& field, const Eigen::VectorXd& step) {
  std::vector<double> nodes = field.nodes();
  for (std::size_t i = 0; i < nodes.size(); ++i) nodes[i] += step[static_cast<Eigen::Index>(i)];
  return {field.columns(), field.rows(), std::move(nodes)};
}

/// Of the sum over pairs the steps of their poses belong to the pairs.
FieldEquations equationsOf(const std::vector<ViewPair>& pairs,
                           const std::vector<ViewSurface>& surfaces, const DepthField& field,
                           const ViewPoses& views, const PairModel& model,
                           std::vector<PairStep>& steps) {
  return deterministicSum<FieldEquations>(
      pairs.size(), kPairGrain, [&](std::size_t begin, std::size_t end) {
        FieldEquations sum;
        for (std::size_t i = begin; i < end; ++i) {
          addPair(pairs[i], surfaces, field, views.apart(pairs[i]), model, sum, steps[i]);
        }
        return sum;
      });
}

/// Covariance by how much the views say different things (the sandwich of White 1980, clustered):
/// what the errors of a view have in common, a pose or a rim, counts whole. The noise of the sensor
/// alone promises too much.
Eigen::MatrixXd scatterOf(const std::vector<ViewPair>& pairs,
                          const std::vector<ViewSurface>& surfaces,
                          const FieldEstimateConfig& config, const FieldSolution& solution,
                          ViewPoses views) {
  std::vector<PairStep> steps(pairs.size());
  FieldEquations sum = equationsOf(pairs, surfaces, solution.field, views, solution.model, steps);
  views.eliminate(pairs, steps, sum);
  const FieldEquations data = sum;
  addPrior(solution.field, config, sum);
  Eigen::MatrixXd scatter = sum.H - data.H;  // the prior's own part
  Eigen::VectorXd of_view = Eigen::VectorXd::Zero(data.g.size());
  for (std::size_t i = 0; i < pairs.size(); ++i) {
    of_view += views.scoreOf(pairs[i], steps[i]);
    if (i + 1 < pairs.size() && pairs[i + 1].from == pairs[i].from) continue;
    scatter.noalias() += of_view * of_view.transpose();
    of_view.setZero();
  }
  const Eigen::MatrixXd inverse = solveStep(sum, solution.field).inverse;
  return inverse * scatter * inverse;
}

double medianOf(std::vector<double>& values) {
  if (values.empty()) return 0;
  const auto middle = values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2);
  std::nth_element(values.begin(), middle, values.end());
  return *middle;
}

/// One pair with one field: mean loss, and distances (mm) appended to `distances`.
double lossOf(const std::vector<Judged>& residuals, const PairModel& model,
              std::vector<double>& distances) {
  double loss = 0;
  for (const Judged& r : residuals) {
    loss += r.loss(model);
    distances.push_back(1000.0 * std::abs(r.e) * r.metres);
  }
  return residuals.empty() ? 0 : loss / static_cast<double>(residuals.size());
}

/// How many standard deviations a normal variate has to be off to be as unlikely as Student's t of
/// so many degrees of freedom (Wallace, "Bounds on normal approximations to Student's and the
/// chi-square distributions", 1959).
double asNormal(double t, double freedom) {
  const double size = std::sqrt(freedom * std::log1p(t * t / freedom));
  return std::copysign(size * (8 * freedom + 1) / (8 * freedom + 3), t);
}

/// Mean over its standard error, where what happens in a view may be one piece of luck; of few
/// views the standard error is not known well, and says less.
double significanceOf(const std::vector<ViewPair>& pairs, const std::vector<double>& gains) {
  double sum = 0;
  for (const double gain : gains) sum += gain;
  const double mean = sum / static_cast<double>(gains.size());
  double variance = 0, cluster = 0, views = 0;
  for (std::size_t i = 0; i < pairs.size(); ++i) {
    cluster += gains[i] - mean;
    if (i + 1 < pairs.size() && pairs[i + 1].from == pairs[i].from) continue;
    variance += cluster * cluster;
    cluster = 0;
    ++views;
  }
  if (!(variance > 0) || views < 2) return 0;
  const double freedom = views - 1;
  return asNormal(sum / std::sqrt(variance * views / freedom), freedom);
}

}  // namespace

FieldSolution solveField(std::vector<ViewPair> pairs, const std::vector<ViewSurface>& surfaces,
                         const FieldEstimateConfig& config) {
  FieldSolution solution;
  solution.field = DepthField(config.columns, config.rows);
  solution.model = config.model;
  solution.model.patches = config.most_patches / (2 * std::max<std::size_t>(1, pairs.size()));
  std::vector<PairStep> steps(pairs.size());
  ViewPoses views(surfaces);
  for (int i = 0; i < config.most_steps; ++i) {
    if (i > 0) {
      solution.model.rest_per_m =
          restOf(pairs, surfaces, solution.field, solution.model, config.model.rest_per_m);
    }
    FieldEquations sum = equationsOf(pairs, surfaces, solution.field, views, solution.model, steps);
    views.eliminate(pairs, steps, sum);
    addPrior(solution.field, config, sum);
    const Step step = solveStep(sum, solution.field);
    solution.field = moved(solution.field, step.step);
    views.move(step.step, steps, pairs);
    solution.residuals = sum.residuals;
    if (i > 1 && step.step.cwiseAbs().maxCoeff() < kConverged * config.node_sigma_per_m) break;
  }
  solution.field = solution.field.centred();
  solution.covariance = scatterOf(pairs, surfaces, config, solution, views);
  return solution;
}

KeptOut judgeField(const std::vector<ViewPair>& pairs, const std::vector<ViewSurface>& surfaces,
                   const DepthField& field, const PairModel& model) {
  KeptOut result;
  result.pairs = pairs.size();
  if (pairs.empty()) return result;
  const DepthField none(field.columns(), field.rows());
  std::vector<std::vector<Judged>> before(pairs.size()), after(pairs.size());
  parallelFor(pairs.size(), kPairGrain, [&](std::size_t begin, std::size_t end) {
    for (std::size_t i = begin; i < end; ++i) {
      const auto fit = [&](const DepthField& f) {
        return residualsOf(fitted(pairs[i], surfaces, f, model), surfaces, f, model);
      };
      before[i] = fit(none);
      after[i] = fit(field);
    }
  });
  std::vector<double> gains, before_mm, after_mm;
  for (std::size_t i = 0; i < pairs.size(); ++i) {
    const double old_loss = lossOf(before[i], model, before_mm);
    const double new_loss = lossOf(after[i], model, after_mm);
    gains.push_back(old_loss - new_loss);
    result.before_loss += old_loss / static_cast<double>(pairs.size());
    result.after_loss += new_loss / static_cast<double>(pairs.size());
  }
  result.before_mm = medianOf(before_mm);
  result.after_mm = medianOf(after_mm);
  result.significance = significanceOf(pairs, gains);
  return result;
}

}  // namespace pf
