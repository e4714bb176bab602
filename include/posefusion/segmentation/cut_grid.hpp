// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <array>
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
  /// Of one cell: what it pays towards neighbours outside of the graph, and for the border to each
  /// of the four that come after it.
  struct Borders {
    float outside = 0;
    std::array<float, 4> after{};
  };
  template <typename Weight>
  void weigh(const SceneGrid& grid, const Unary& unary, const Weight& weight);
  void addNodes(const Unary& unary);
  void addEdges(const SceneGrid& grid);

  GraphCut graph_;
  std::vector<Borders> borders_;  // of each cell
  std::vector<int> node_;         // of each cell, -1: none
};

/// Takes the label away from regions without an anchor of a person.
void keepAnchoredRegions(const SceneGrid& grid, const std::vector<TrackedPerson>& people,
                         std::vector<std::uint8_t>& labels);

}  // namespace pf
