// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <array>
#include <cstddef>
#include <functional>
#include <vector>

namespace pf {

/// How much each node of a grid counts at a place in the image: those of four rows and columns, by
/// the product of what both count.
struct FieldWeights {
  static constexpr int kNodes = 16;
  int first = 0, columns = 0;  ///< index of the first of them, and how far on the next row is
  std::array<double, 4> across{}, down{};
  std::array<double, 4> across_slope{}, down_slope{};  ///< derivatives by x and y

  /// Of number k of them, row by row. @{
  int node(int k) const { return first + k / 4 * columns + k % 4; }
  double weight(int k) const { return down[k / 4] * across[k % 4]; }
  /// @}
};

/// The smooth systematic error of a depth camera: 1/z_true = 1/z_measured + d(x, y), d in 1/m. To
/// first order it is what a wrong disparity does. A cubic B-spline: the nodes are its coefficients;
/// those of the outermost rows and columns lie one step outside of the image. Places are
/// x = (u + 0.5) / width, y = (v + 0.5) / height, so that one field holds for all sizes of the same
/// image.
class DepthField {
 public:
  static constexpr int kColumns = 12, kRows = 9;

  /// No error.
  DepthField() : DepthField(kColumns, kRows) {}
  DepthField(int columns, int rows)
      : DepthField(columns, rows, std::vector<double>(nodeCount(columns, rows), 0.0)) {}

  /// `nodes_per_m`: row by row, 1/m. Throws std::invalid_argument for fewer than 4 columns or rows,
  /// another number of nodes, or numbers that are not finite.
  DepthField(int columns, int rows, std::vector<double> nodes_per_m);

  int columns() const { return columns_; }
  int rows() const { return rows_; }
  const std::vector<double>& nodes() const { return nodes_; }

  /// d (1/m). Places outside of the image count as on its border.
  double at(double x, double y) const;
  double at(const FieldWeights& weights) const;
  FieldWeights weights(double x, double y) const;
  /// Derivatives of d by x and y.
  std::array<double, 2> slopeAt(const FieldWeights& weights) const;

  /// z_true (m) of a measured depth; 0 where there is none.
  double corrected(double z_m, double x, double y) const;

  /// How much each node counts in the mean over the image; they sum up to 1.
  std::vector<double> shares() const;

  double mean() const;         ///< over the image, 1/m
  double rms() const;          ///< over the image, 1/m
  DepthField centred() const;  ///< less its mean: the gauge, as the mean cannot be observed

  /// The field that distorts as this one corrects.
  DepthField inverse() const;

  /// This field, then another: what both together correct, on the other's grid. The true fields of
  /// the simulator are finer than what is estimated.
  DepthField then(const DepthField& next) const;

 private:
  static std::size_t nodeCount(int columns, int rows);

  int columns_, rows_;
  std::vector<double> nodes_;
};

/// The field nearest to a function of (x, y) in [0, 1].
DepthField fittedField(int columns, int rows, const std::function<double(double, double)>& d);

/// How alike two fields are over the image, on 64 x 48 places, their means aside.
struct FieldComparison {
  double correlation = 0;         ///< 0 where one of them is flat
  double rms_a = 0, rms_b = 0;    ///< 1/m
  double rms_difference = 0;      ///< 1/m
  double mean_a = 0, mean_b = 0;  ///< 1/m
};

FieldComparison compare(const DepthField& a, const DepthField& b);

}  // namespace pf
