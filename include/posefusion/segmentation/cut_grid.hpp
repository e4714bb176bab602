// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <vector>

#include "posefusion/segmentation/config.hpp"
#include "posefusion/segmentation/energy.hpp"
#include "posefusion/segmentation/graph_cut.hpp"
#include "posefusion/segmentation/grid.hpp"
#include "posefusion/segmentation/tracked_people.hpp"

namespace pf {

/// Cuts the grid by the improved energy: each cell a vertex with edges to its eight neighbours.
/// Keeps its memory.
class GridCutter {
 public:
  /// Smoothness: distance in space and difference of colour, little across missing depth.
  /// `labels`: 1 = person.
  void cut(const SceneGrid& grid, const Unary& unary, const SegmentationConfig& config,
           std::vector<std::uint8_t>& labels);

 private:
  template <typename Weight>
  void addNodes(const SceneGrid& grid, const Unary& unary, const Weight& weight);
  template <typename Weight>
  void addEdges(const SceneGrid& grid, const Weight& weight);

  GraphCut graph_;
  std::vector<int> node_;  // of each cell, -1: none
};

/// Takes the label away from regions without an anchor of a person.
void keepAnchoredRegions(const SceneGrid& grid, const std::vector<TrackedPerson>& people,
                         std::vector<std::uint8_t>& labels);

}  // namespace pf
