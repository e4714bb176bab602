// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <cstddef>
#include <optional>
#include <string>
#include <vector>

#include "posefusion/calibration/depth_calibration.hpp"
#include "posefusion/calibration/pair_equations.hpp"
#include "posefusion/calibration/view_pairs.hpp"
#include "posefusion/core/depth_sensor.hpp"

namespace pf {

/// How a field is estimated.
struct FieldEstimateConfig {
  int columns = DepthField::kColumns, rows = DepthField::kRows;
  double node_sigma_per_m = 0.005;    ///< what an uncalibrated camera has (1/m)
  double smooth_sigma_per_m = 0.001;  ///< by which neighbouring nodes differ (1/m)
  /// That the depth of the views is corrected by already: what any camera has, it has of both
  /// together, so that an estimate that is repeated finds nothing more.
  DepthField known{};
  int most_steps = 12;  ///< Gauss-Newton, until a step is a part of what is known
  /// That are compared, of all views: the fewer the pairs, the more patches of each.
  std::size_t most_patches = 400000;
  std::size_t keep_out_every = 5;  ///< one pair in so many judges, and is not learned from
  PairModel model;
  PairLimits pairs;
};

/// Residuals of pairs that were kept out, each pair at the pose that fits it best.
struct KeptOut {
  std::size_t pairs = 0;
  double before_mm = 0, after_mm = 0;      ///< median distance of a patch to the other's plane
  double before_loss = 0, after_loss = 0;  ///< mean robust loss, 0..1
  /// Mean gain in loss over its standard error; the pairs of one view count as one. Of few views as
  /// the deviation of a normal variate that is as unlikely.
  double significance = 0;
};

/// What was found.
struct FieldEstimate {
  DepthField field;            ///< mean zero
  Eigen::MatrixXd covariance;  ///< of the nodes, (1/m)^2
  double sigma_per_m = 0;      ///< by that, of the field over the image (RMS, 1/m)
  std::size_t views = 0, pairs = 0, residuals = 0;  ///< learned from
  double rest_per_m = 0;                            ///< that the field leaves unexplained
  KeptOut kept_out;
  bool worth_taking = false;  ///< by a camera of which nothing was known
  std::string reason;         ///< why it is not worth taking, or why there is no estimate

  /// Why it is not worth taking as a step of a field that is in use and was learned from so many
  /// pairs (0: otherwise). That the camera is off is no question any more: pairs that were kept out
  /// agree better, or it comes from more pairs and they agree no worse. Empty: it is.
  std::string doubtOfStep(std::size_t known_from_pairs) const;

  /// Why it is not worth taking by a camera of which that is known (nothing: `reason`).
  std::string doubtBeside(const std::optional<DepthCalibration>& known) const;

  /// Whether it speaks for the camera, of which nothing is known: it found nothing, not even what
  /// one would bet on, and would have found what such a sensor is usually off by.
  bool clears(const DepthSensor& sensor) const;

  /// As one step of what is known of a camera, without its name and image.
  DepthCalibration asCalibration() const;

  /// What the field is off by itself (1/m), by all that is not said by its covariance too.
  double left_per_m() const;
};

/// Estimates the field of a camera from keyframes whose poses are roughly known: Gauss-Newton over
/// the residuals of all overlapping pairs, each pair with a pose of its own. The same bytes for any
/// order of the views and any number of threads. Where there is too little the field is zero, and
/// the reason says what is missing. Throws InputError for a view whose image and camera do not fit
/// together.
FieldEstimate estimateField(const std::vector<CalibrationView>& views,
                            const FieldEstimateConfig& config = {});

/// The same of surfaces that were found before, by rising id.
FieldEstimate estimateFieldFrom(const std::vector<ViewSurface>& surfaces,
                                const FieldEstimateConfig& config = {});

}  // namespace pf
