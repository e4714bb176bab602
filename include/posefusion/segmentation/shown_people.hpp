// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <vector>

#include "posefusion/pose/skeleton.hpp"
#include "posefusion/segmentation/grid.hpp"

namespace pf {

/// A detector's mask on the cells of the grid. Both empty: it gave no mask.
struct ShownPeople {
  std::vector<float> probability;       ///< 0..1, of a person
  std::vector<std::int16_t> detection;  ///< index of the person in the detection, -1: no person

  bool empty() const { return probability.empty(); }

  /// Cells that show a person of the detection for sure, and have depth.
  std::vector<int> sureCells(int detection_index, const SceneGrid& grid) const;
};

/// Brings a detector's mask to the grid of a frame of size `image`.
void sampleMask(const PersonMask& mask, const cv::Size& image, const SceneGrid& grid,
                ShownPeople& shown);

/// Cost that a cell pays for being called background (> 0) or person (< 0) by what the mask says:
/// limited log-odds. `is_shown`: the mask shows the person in question; where it does not, that it
/// denies a cell counts little.
float shownTerm(const ShownPeople& shown, int cell, bool is_shown);

/// The mask surely shows a person in the cell.
bool isShown(const ShownPeople& shown, int cell);

/// The mask shows no person in the cell.
bool isDenied(const ShownPeople& shown, int cell);

}  // namespace pf
