// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <vector>

#include "panorama.hpp"
#include "posefusion/loop/place_search.hpp"

namespace pf {

/// A query's pixels as directions of one tilt, for heading 0.
struct QueryRays {
  std::vector<int> row, column;  ///< of a panorama
  std::vector<float> range;      ///< m
  std::vector<float> inverse_tolerance;
  std::vector<float> intensity;

  std::size_t size() const { return row.size(); }
};

/// Pixels that show something, as directions of a camera with orientation `R` in the grid, of which
/// positions are `step_m` apart; rows count from elevation 0 until the lowest is known. Of every so
/// many pixels (`every`) along a row and a column one.
QueryRays raysOf(const PlaceQuery& query, const Eigen::Matrix3d& R, const PanoramaShape& shape,
                 double step_m, int every);

/// How the query fits at each heading from one position. As long as there are headings.
struct HeadingScores {
  std::vector<float> known, agreeing, difference, score, correlation;

  void compute(const Panorama& panorama, const QueryRays& rays, int headings);

 private:
  std::vector<float> m_, mm_, q_, qq_, mq_;  ///< sums for the correlation
};

}  // namespace pf
