// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <vector>

#include "posefusion/calibration/field_estimate.hpp"

namespace pf {

/// The field that fits pairs best, and what is known of it.
struct FieldSolution {
  DepthField field;
  Eigen::MatrixXd covariance;
  std::size_t residuals = 0;
  PairModel model;  ///< as in the last step
};

/// Pairs start from the poses given, views from theirs.
FieldSolution solveField(std::vector<ViewPair> pairs, const std::vector<ViewSurface>& surfaces,
                         const FieldEstimateConfig& config);

/// Compares a field with none, on pairs that it was not learned from.
KeptOut judgeField(const std::vector<ViewPair>& pairs, const std::vector<ViewSurface>& surfaces,
                   const DepthField& field, const PairModel& model);

}  // namespace pf
