// SPDX-License-Identifier: BSD-3-Clause
#pragma once

namespace pf {

/// How a map becomes a plan from above. Heights are over the floor.
struct GridConfig {
  double cell_m = 0.05;
  double lowest_m = 0.10;   ///< what is lower is floor
  double highest_m = 1.80;  ///< what is higher is no obstacle
  double clear_m = 0.40;    ///< free is what rays pass lower than this, and higher
  double largest_m = 500;   ///< side of the largest grid
};

/// Throws InputError naming the first value that cannot be.
void validate(const GridConfig& config);

}  // namespace pf
