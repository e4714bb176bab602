// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <array>
#include <vector>

namespace pf {

/// Where a place in the image lies among the nodes of a grid: bilinear weights, and how they change
/// with the place.
struct FieldWeights {
  std::array<int, 4> node{};  ///< indices, row by row
  std::array<double, 4> weight{};
  std::array<double, 4> by_x{}, by_y{};  ///< derivatives by x and y
};

/// The smooth systematic error of a depth camera: 1/z_true = 1/z_measured + d(x, y), d in 1/m. To
/// first order it is what a wrong disparity does. Bilinear between nodes that span the image.
/// Places are x = (u + 0.5) / width, y = (v + 0.5) / height, so that one field holds for all sizes
/// of the same image.
class DepthField {
 public:
  static constexpr int kColumns = 12, kRows = 9;

  /// No error.
  DepthField() : DepthField(kColumns, kRows) {}
  DepthField(int columns, int rows)
      : DepthField(columns, rows, std::vector<double>(nodeCount(columns, rows), 0.0)) {}

  /// `nodes_per_m`: row by row, 1/m. Throws std::invalid_argument for fewer than 2 columns or rows,
  /// another number of nodes, or numbers that are not finite.
  DepthField(int columns, int rows, std::vector<double> nodes_per_m);

  int columns() const { return columns_; }
  int rows() const { return rows_; }
  const std::vector<double>& nodes() const { return nodes_; }

  /// d (1/m). Places outside of the image count as on its border.
  double at(double x, double y) const;
  double at(const FieldWeights& weights) const;
  FieldWeights weights(double x, double y) const;

  /// z_true (m) of a measured depth; 0 where there is none.
  double corrected(double z_m, double x, double y) const;

  double mean() const;         ///< of the nodes, 1/m
  double rms() const;          ///< of the nodes, 1/m
  DepthField centred() const;  ///< less its mean: the gauge, as the mean cannot be observed

  /// The field that distorts as this one corrects.
  DepthField inverse() const;

  /// This field, then another: what both together correct, on the nodes of this one.
  DepthField then(const DepthField& next) const;

 private:
  static std::size_t nodeCount(int columns, int rows);

  int columns_, rows_;
  std::vector<double> nodes_;
};

/// How alike two fields are over the image, on 64 x 48 places, their means aside.
struct FieldComparison {
  double correlation = 0;         ///< 0 where one of them is flat
  double rms_a = 0, rms_b = 0;    ///< 1/m
  double rms_difference = 0;      ///< 1/m
  double mean_a = 0, mean_b = 0;  ///< 1/m
};

FieldComparison compare(const DepthField& a, const DepthField& b);

}  // namespace pf
