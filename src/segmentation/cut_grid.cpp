// SPDX-License-Identifier: BSD-3-Clause
#include "posefusion/segmentation/cut_grid.hpp"

#include <algorithm>
#include <array>
#include <cmath>

#include "posefusion/core/parallel.hpp"
#include "posefusion/segmentation/paper_cut.hpp"

namespace pf {
namespace {

struct Neighbour {
  int right, down;
  float factor;  // a diagonal edge represents less of the border's length
};
constexpr float kDiagonal = 0.707F;
constexpr std::array<Neighbour, 4> kNeighbours{
    {{1, 0, 1.0F}, {0, 1, 1.0F}, {1, 1, kDiagonal}, {-1, 1, kDiagonal}}};

constexpr float kHoleEdge = 0.15F;      // part of the smoothness across missing depth
constexpr float kColorSpread = 900.0F;  // square of a colour difference that makes an edge cheap
constexpr int kMostTabled = 8192;  // squares of colour differences; above, exp(-9.1) is nothing
constexpr float kColorlessEdge = 0.4F;  // part of the smoothness that colour does not touch
constexpr float kMinReach = 2.5F;       // of the length scale, in spacings of neighbours there

/// Cells that cannot be a person stay out of the graph: they only pull on their neighbours.
bool isInGraph(float unary) { return unary > -kCertain; }

int colorDifference2(const SceneGrid& grid, int a, int b) {
  const cv::Vec3b& p = grid.color.ptr<cv::Vec3b>()[a];
  const cv::Vec3b& q = grid.color.ptr<cv::Vec3b>()[b];
  int sum = 0;
  for (int k = 0; k < 3; ++k) sum += (p[k] - q[k]) * (p[k] - q[k]);
  return sum;
}

/// How alike two colours are, 1 for the same, by the square of their difference. From a table: it
/// is asked for every edge of the graph.
float likeness(int difference2) {
  static const std::vector<float> kLikeness = [] {
    std::vector<float> table(kMostTabled);
    for (int i = 0; i < kMostTabled; ++i)
      table[i] = std::exp(-static_cast<float>(i) / kColorSpread);
    return table;
  }();
  return difference2 < kMostTabled ? kLikeness[difference2] : 0.0F;
}

}  // namespace

/// What each cell of the graph pays for a border towards its neighbours.
template <typename Weight>
void GridCutter::weigh(const SceneGrid& grid, const Unary& unary, const Weight& weight) {
  borders_.resize(grid.size());
  parallelFor(grid.rows, kRowsAtOnce, [&](std::size_t begin, std::size_t end) {
    const int last = static_cast<int>(end) * grid.cols;
    for (int cell = static_cast<int>(begin) * grid.cols; cell < last; ++cell) {
      Borders& borders = borders_[cell];
      borders = Borders();
      if (!isInGraph(unary[cell])) continue;
      const int row = cell / grid.cols, col = cell % grid.cols;
      for (std::size_t k = 0; k < kNeighbours.size(); ++k) {
        const Neighbour& n = kNeighbours[k];
        for (int sign : {-1, 1}) {
          const int r = row + sign * n.down, c = col + sign * n.right;
          if (r < 0 || c < 0 || r >= grid.rows || c >= grid.cols) continue;
          const int other = r * grid.cols + c;
          if (!isInGraph(unary[other])) {
            borders.outside += n.factor * weight(cell, other);
          } else if (sign > 0) {
            borders.after[k] = n.factor * weight(cell, other);
          }
        }
      }
    }
  });
}

void GridCutter::addNodes(const Unary& unary) {
  node_.assign(unary.size(), -1);
  for (std::size_t cell = 0; cell < unary.size(); ++cell) {
    if (!isInGraph(unary[cell])) continue;
    node_[cell] = graph_.addNode(std::max(0.0F, unary[cell]),
                                 std::max(0.0F, -unary[cell]) + borders_[cell].outside);
  }
}

void GridCutter::addEdges(const SceneGrid& grid) {
  for (int cell = 0; cell < grid.size(); ++cell) {
    if (node_[cell] < 0) continue;
    for (std::size_t k = 0; k < kNeighbours.size(); ++k) {
      const float weight = borders_[cell].after[k];
      if (weight <= 0.0F) continue;
      const int other = cell + kNeighbours[k].down * grid.cols + kNeighbours[k].right;
      graph_.addEdge(node_[cell], node_[other], weight);
    }
  }
}

void GridCutter::cut(const SceneGrid& grid, const Unary& unary, const SegmentationConfig& config,
                     std::vector<std::uint8_t>& labels) {
  const float smoothness = static_cast<float>(config.smoothness);
  const float sigma_m = static_cast<float>(config.sigma_m);
  weigh(grid, unary, [&](int a, int b) {
    const float contrast = likeness(colorDifference2(grid, a, b));
    const float blended = smoothness * (kColorlessEdge + (1.0F - kColorlessEdge) * contrast);
    if (!grid.hasDepth(a) || !grid.hasDepth(b)) return kHoleEdge * blended;
    const float reach_m = std::max(sigma_m, kMinReach * grid.spacing * grid.z[a]);
    return blended * smoothnessCost((grid.point(a) - grid.point(b)).norm(), reach_m);
  });
  const auto nodes = std::count_if(unary.begin(), unary.end(), isInGraph);
  graph_.begin(static_cast<int>(nodes), static_cast<int>(kNeighbours.size() * nodes));
  addNodes(unary);
  addEdges(grid);
  graph_.solve();
  labels.assign(grid.size(), 0);
  for (int cell = 0; cell < grid.size(); ++cell) {
    labels[cell] = node_[cell] >= 0 && graph_.isPerson(node_[cell]);
  }
}

void keepAnchoredRegions(const SceneGrid& grid, const std::vector<TrackedPerson>& people,
                         std::vector<std::uint8_t>& labels) {
  std::vector<int> open;
  std::vector<std::uint8_t> reached(labels.size(), 0);
  for (const TrackedPerson& tracked : people) {
    for (int anchor : tracked.body.anchors) {
      if (labels[anchor] == 0 || reached[anchor] != 0) continue;
      reached[anchor] = 1;
      open.push_back(anchor);
    }
  }
  while (!open.empty()) {
    const int cell = open.back();
    open.pop_back();
    const int row = cell / grid.cols, col = cell % grid.cols;
    for (int r = std::max(0, row - 1); r <= std::min(grid.rows - 1, row + 1); ++r) {
      for (int c = std::max(0, col - 1); c <= std::min(grid.cols - 1, col + 1); ++c) {
        const int other = r * grid.cols + c;
        if (labels[other] == 0 || reached[other] != 0) continue;
        reached[other] = 1;
        open.push_back(other);
      }
    }
  }
  labels.swap(reached);
}

}  // namespace pf
