// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <vector>

#include "posefusion/segmentation/body.hpp"
#include "posefusion/segmentation/config.hpp"
#include "posefusion/segmentation/energy.hpp"
#include "posefusion/segmentation/graph_cut.hpp"
#include "posefusion/segmentation/grid.hpp"

namespace pf {

/// Cuts the grid: each cell a vertex with edges to its eight neighbours. Keeps its memory.
class GridCutter {
 public:
  /// The improved smoothness: distance in space and difference of colour, little across missing
  /// depth. `labels`: 1 = person.
  void cut(const SceneGrid& grid, const Unary& unary, const SegmentationConfig& config,
           std::vector<std::uint8_t>& labels);

  /// The paper's terms over all cells with depth; `up` as in paperUnary().
  void cutPaper(const SceneGrid& grid, const std::vector<Body>& bodies, const Eigen::Vector3f& up,
                const SegmentationConfig& config, std::vector<std::uint8_t>& labels);

 private:
  template <typename Weight>
  void solve(const SceneGrid& grid, const Unary& unary, const Weight& weight,
             std::vector<std::uint8_t>& labels);

  GraphCut graph_;
  std::vector<int> node_;
  Unary paper_unary_;
};

/// Takes the label away from regions without an anchor.
void keepAnchoredRegions(const SceneGrid& grid, const std::vector<Body>& bodies,
                         std::vector<std::uint8_t>& labels);

}  // namespace pf
