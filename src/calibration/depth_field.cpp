// SPDX-License-Identifier: BSD-3-Clause
#include "posefusion/calibration/depth_field.hpp"

#include <Eigen/Cholesky>
#include <algorithm>
#include <cmath>
#include <numeric>
#include <stdexcept>
#include <string>
#include <utility>

#include "posefusion/calibration/cubic_splines.hpp"

namespace pf {
namespace {

// Places that represent the image.
constexpr int kAcross = 64, kDown = 48;

using Cubic = CubicSplines<double>;

/// The integrals of the splines along one axis over [0, 1]: of each interval the four that are not
/// zero there have 1, 11, 11 and 1 parts of 24.
std::vector<double> sharesAlong(int count) {
  const int intervals = count - 3;
  std::vector<double> shares(static_cast<std::size_t>(count), 0.0);
  for (int i = 0; i < intervals; ++i) {
    const double parts[] = {1, 11, 11, 1};
    for (int k = 0; k < 4; ++k) shares[static_cast<std::size_t>(i + k)] += parts[k];
  }
  for (double& share : shares) share /= 24.0 * intervals;
  return shares;
}

/// Calls visit(x, y) for places spread over the image.
template <typename Visit>
void overImage(const Visit& visit) {
  for (int row = 0; row < kDown; ++row) {
    for (int col = 0; col < kAcross; ++col) visit((col + 0.5) / kAcross, (row + 0.5) / kDown);
  }
}

/// Takes the values of a function at `samples` places from 0 to 1 to the spline nearest to them. A
/// trace of smoothness keeps the outermost nodes, which hardly count in the image, from running
/// off.
Eigen::MatrixXd fitting(int count, int samples) {
  constexpr double kSmooth = 1e-6;
  Eigen::MatrixXd values = Eigen::MatrixXd::Zero(samples, count);
  for (int i = 0; i < samples; ++i) {
    const Cubic c(static_cast<double>(i) / (samples - 1), count);
    for (int k = 0; k < 4; ++k) values(i, c.first + k) = c.weight[k];
  }
  Eigen::MatrixXd bend = Eigen::MatrixXd::Zero(count - 2, count);
  for (int i = 0; i + 2 < count; ++i) bend.row(i).segment<3>(i) << 1, -2, 1;
  const Eigen::MatrixXd A = values.transpose() * values + kSmooth * bend.transpose() * bend;
  return A.ldlt().solve(values.transpose());
}

double squared(double x) { return x * x; }

double alongRow(const std::array<double, 4>& weights, const double* nodes) {
  return (weights[0] * nodes[0] + weights[1] * nodes[1]) +
         (weights[2] * nodes[2] + weights[3] * nodes[3]);
}

}  // namespace

DepthField::DepthField(int columns, int rows, std::vector<double> nodes_per_m)
    : columns_(columns), rows_(rows), nodes_(std::move(nodes_per_m)) {
  if (nodes_.size() != nodeCount(columns, rows)) {
    throw std::invalid_argument("a field of " + std::to_string(columns) + " x " +
                                std::to_string(rows) + " nodes was given " +
                                std::to_string(nodes_.size()));
  }
  for (const double node : nodes_) {
    if (!std::isfinite(node)) throw std::invalid_argument("a node of a field is not finite");
  }
}

std::size_t DepthField::nodeCount(int columns, int rows) {
  if (columns < 4 || rows < 4) throw std::invalid_argument("a field needs 4 x 4 nodes or more");
  return static_cast<std::size_t>(columns) * static_cast<std::size_t>(rows);
}

FieldWeights DepthField::weights(double x, double y) const {
  const Cubic c(x, columns_), r(y, rows_);
  FieldWeights w;
  w.first = r.first * columns_ + c.first;
  w.columns = columns_;
  std::copy_n(c.weight, 4, w.across.begin());
  std::copy_n(c.slope, 4, w.across_slope.begin());
  std::copy_n(r.weight, 4, w.down.begin());
  std::copy_n(r.slope, 4, w.down_slope.begin());
  return w;
}

double DepthField::at(const FieldWeights& w) const {
  const double* row = &nodes_[static_cast<std::size_t>(w.first)];
  double sum = 0;
  for (std::size_t i = 0; i < 4; ++i, row += columns_) sum += w.down[i] * alongRow(w.across, row);
  return sum;
}

std::array<double, 2> DepthField::slopeAt(const FieldWeights& w) const {
  const double* row = &nodes_[static_cast<std::size_t>(w.first)];
  std::array<double, 2> slope{};
  for (std::size_t i = 0; i < 4; ++i, row += columns_) {
    slope[0] += w.down[i] * alongRow(w.across_slope, row);
    slope[1] += w.down_slope[i] * alongRow(w.across, row);
  }
  return slope;
}

double DepthField::at(double x, double y) const { return at(weights(x, y)); }

double DepthField::corrected(double z_m, double x, double y) const {
  const double inverse = 1.0 + z_m * at(x, y);
  return z_m > 0 && inverse > 0 ? z_m / inverse : 0.0;
}

std::vector<double> DepthField::shares() const {
  const std::vector<double> across = sharesAlong(columns_), down = sharesAlong(rows_);
  std::vector<double> shares;
  for (const double row : down) {
    for (const double column : across) shares.push_back(row * column);
  }
  return shares;
}

double DepthField::mean() const {
  const std::vector<double> counts = shares();
  return std::inner_product(nodes_.begin(), nodes_.end(), counts.begin(), 0.0);
}

double DepthField::rms() const {
  double sum = 0;
  overImage([&](double x, double y) { sum += squared(at(x, y)); });
  return std::sqrt(sum / (kAcross * kDown));
}

DepthField DepthField::centred() const {
  DepthField field = *this;
  const double middle = mean();
  for (double& node : field.nodes_) node -= middle;
  return field;
}

DepthField DepthField::inverse() const {
  DepthField field = *this;
  for (double& node : field.nodes_) node = -node;
  return field;
}

DepthField DepthField::then(const DepthField& next) const {
  if (next.columns_ != columns_ || next.rows_ != rows_) {
    return fittedField(next.columns_, next.rows_, [&](double x, double y) { return at(x, y); })
        .then(next);
  }
  DepthField field = *this;
  for (std::size_t i = 0; i < nodes_.size(); ++i) field.nodes_[i] += next.nodes_[i];
  return field;
}

DepthField fittedField(int columns, int rows, const std::function<double(double, double)>& d) {
  const int across = 4 * columns, down = 4 * rows;
  Eigen::MatrixXd values(down, across);
  for (int r = 0; r < down; ++r) {
    for (int c = 0; c < across; ++c) {
      values(r, c) = d(static_cast<double>(c) / (across - 1), static_cast<double>(r) / (down - 1));
    }
  }
  // Transposed, its columns one after another are the rows of the field.
  const Eigen::MatrixXd nodes =
      (fitting(rows, down) * values * fitting(columns, across).transpose()).transpose();
  return {columns, rows, std::vector<double>(nodes.data(), nodes.data() + nodes.size())};
}

FieldComparison compare(const DepthField& a, const DepthField& b) {
  std::vector<double> of_a, of_b;
  overImage([&](double x, double y) {
    of_a.push_back(a.at(x, y));
    of_b.push_back(b.at(x, y));
  });
  const double count = static_cast<double>(of_a.size());
  FieldComparison result;
  result.mean_a = std::accumulate(of_a.begin(), of_a.end(), 0.0) / count;
  result.mean_b = std::accumulate(of_b.begin(), of_b.end(), 0.0) / count;
  double aa = 0, bb = 0, ab = 0, dd = 0;
  for (std::size_t i = 0; i < of_a.size(); ++i) {
    const double da = of_a[i] - result.mean_a, db = of_b[i] - result.mean_b;
    aa += squared(da);
    bb += squared(db);
    ab += da * db;
    dd += squared(da - db);
  }
  if (aa > 0 && bb > 0) result.correlation = ab / std::sqrt(aa * bb);
  result.rms_a = std::sqrt(aa / count);
  result.rms_b = std::sqrt(bb / count);
  result.rms_difference = std::sqrt(dd / count);
  return result;
}

}  // namespace pf
