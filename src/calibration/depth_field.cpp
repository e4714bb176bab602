// SPDX-License-Identifier: BSD-3-Clause
#include "posefusion/calibration/depth_field.hpp"

#include <algorithm>
#include <cmath>
#include <numeric>
#include <stdexcept>
#include <string>
#include <utility>

namespace pf {
namespace {

struct Cell {
  int index;
  double part;
};

/// Between which of `count` nodes a place in [0, 1] lies.
Cell cellOf(double place, int count) {
  const double at = std::clamp(place, 0.0, 1.0) * (count - 1);
  const int index = std::min(static_cast<int>(at), count - 2);
  return {index, at - index};
}

double squared(double x) { return x * x; }

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
  if (columns < 2 || rows < 2) throw std::invalid_argument("a field needs 2 x 2 nodes or more");
  return static_cast<std::size_t>(columns) * static_cast<std::size_t>(rows);
}

FieldWeights DepthField::weights(double x, double y) const {
  const Cell c = cellOf(x, columns_), r = cellOf(y, rows_);
  const int first = r.index * columns_ + c.index;
  const double p = c.part, q = r.part, sx = columns_ - 1, sy = rows_ - 1;
  return {{first, first + 1, first + columns_, first + columns_ + 1},
          {(1 - p) * (1 - q), p * (1 - q), (1 - p) * q, p * q},
          {-sx * (1 - q), sx * (1 - q), -sx * q, sx * q},
          {-sy * (1 - p), -sy * p, sy * (1 - p), sy * p}};
}

double DepthField::at(const FieldWeights& w) const {
  double sum = 0;
  for (std::size_t k = 0; k < 4; ++k) {
    sum += w.weight[k] * nodes_[static_cast<std::size_t>(w.node[k])];
  }
  return sum;
}

double DepthField::at(double x, double y) const { return at(weights(x, y)); }

double DepthField::corrected(double z_m, double x, double y) const {
  const double inverse = 1.0 + z_m * at(x, y);
  return z_m > 0 && inverse > 0 ? z_m / inverse : 0.0;
}

double DepthField::mean() const {
  return std::accumulate(nodes_.begin(), nodes_.end(), 0.0) / static_cast<double>(nodes_.size());
}

double DepthField::rms() const {
  double sum = 0;
  for (const double node : nodes_) sum += node * node;
  return std::sqrt(sum / static_cast<double>(nodes_.size()));
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
  DepthField field = *this;
  for (int row = 0; row < rows_; ++row) {
    for (int col = 0; col < columns_; ++col) {
      const double x = static_cast<double>(col) / (columns_ - 1);
      const double y = static_cast<double>(row) / (rows_ - 1);
      field.nodes_[static_cast<std::size_t>(row * columns_ + col)] += next.at(x, y);
    }
  }
  return field;
}

FieldComparison compare(const DepthField& a, const DepthField& b) {
  constexpr int kColumns = 64, kRows = 48;
  std::vector<double> of_a, of_b;
  for (int row = 0; row < kRows; ++row) {
    for (int col = 0; col < kColumns; ++col) {
      const double x = (col + 0.5) / kColumns, y = (row + 0.5) / kRows;
      of_a.push_back(a.at(x, y));
      of_b.push_back(b.at(x, y));
    }
  }
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
