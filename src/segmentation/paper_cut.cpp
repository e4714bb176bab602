// SPDX-License-Identifier: BSD-3-Clause
#include "posefusion/segmentation/paper_cut.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

#include "posefusion/core/parallel.hpp"

namespace pf {
namespace {

// A longer edge would weigh less than half a step of GraphCut's weights: it is left out.
constexpr float kLongestEdge = 2.5F;  // in units of sigma

struct Candidate {
  float distance2_m2;
  int cell;
  bool operator<(const Candidate& other) const {
    return std::make_pair(distance2_m2, cell) < std::make_pair(other.distance2_m2, other.cell);
  }
};

/// Exact nearest neighbours in space among the points of an organised cloud. The rays of cells at
/// least r columns or rows away pass a point at depth z at a distance of at least z r s / n, where
/// s is the smaller spacing of the rays at depth 1 and n the greatest length of a ray there: so the
/// search goes outwards ring by ring until nothing nearer can come.
class NeighbourSearch {
 public:
  NeighbourSearch(const SceneGrid& grid, int count, float reach_m)
      : grid_(grid), count_(count), reach_m_(reach_m) {
    const float down = grid.rows > 1 ? grid.ray_y[grid.cols] - grid.ray_y[0] : grid.spacing;
    float longest2 = 0.0F;
    for (int cell : {0, grid.cols - 1, grid.size() - grid.cols, grid.size() - 1}) {
      const float x = grid.ray_x[cell], y = grid.ray_y[cell];
      longest2 = std::max(longest2, x * x + y * y + 1.0F);
    }
    ring_m_ = std::min(grid.spacing, down) / std::sqrt(longest2);
  }

  std::vector<int> find(int cell) const {
    std::vector<Candidate> nearest;  // a heap, the farthest first
    const int last_ring = std::max(grid_.cols, grid_.rows);
    for (int ring = 1; ring <= last_ring; ++ring) {
      const float least_m = grid_.z[cell] * ring_m_ * static_cast<float>(ring);
      if (least_m > reach_m_) break;
      const bool full = static_cast<int>(nearest.size()) == count_;
      if (full && least_m * least_m > nearest.front().distance2_m2) break;
      addRing(cell, ring, nearest);
    }
    std::vector<int> cells;
    for (const Candidate& candidate : nearest) cells.push_back(candidate.cell);
    return cells;
  }

 private:
  void addRing(int cell, int ring, std::vector<Candidate>& nearest) const {
    const int row = cell / grid_.cols, col = cell % grid_.cols;
    for (int r = std::max(0, row - ring); r <= std::min(grid_.rows - 1, row + ring); ++r) {
      const bool whole_row = std::abs(r - row) == ring;
      for (int c = col - ring; c <= col + ring; c += whole_row ? 1 : 2 * ring) {
        if (c >= 0 && c < grid_.cols) add(cell, r * grid_.cols + c, nearest);
      }
    }
  }

  void add(int cell, int other, std::vector<Candidate>& nearest) const {
    if (!grid_.hasDepth(other)) return;
    const Candidate candidate{(grid_.point(cell) - grid_.point(other)).squaredNorm(), other};
    if (candidate.distance2_m2 > reach_m_ * reach_m_) return;
    if (static_cast<int>(nearest.size()) == count_) {
      if (!(candidate < nearest.front())) return;
      std::pop_heap(nearest.begin(), nearest.end());
      nearest.pop_back();
    }
    nearest.push_back(candidate);
    std::push_heap(nearest.begin(), nearest.end());
  }

  const SceneGrid& grid_;
  int count_;
  float reach_m_;
  float ring_m_;  // least distance of the next ring's rays at depth 1
};

}  // namespace

float smoothnessCost(float length_m, float sigma_m) {
  const float relative = length_m / sigma_m;
  return std::exp(-relative * relative);
}

float backgroundPenalty(const Eigen::Vector3f& point, const std::vector<Eigen::Vector3f>& seeds,
                        const Eigen::Vector3f& up, float radius_m) {
  float nearest2 = std::numeric_limits<float>::max();
  for (const Eigen::Vector3f& seed : seeds) {
    const Eigen::Vector3f offset = point - seed;
    const float height = offset.dot(up);
    nearest2 = std::min(nearest2, offset.squaredNorm() - height * height);
  }
  return std::sqrt(std::max(0.0F, nearest2)) / radius_m;
}

std::vector<Eigen::Vector3f> liftJoints(const People& people, const SceneGrid& grid) {
  std::vector<Eigen::Vector3f> seeds;
  for (const Person& person : people.people) {
    for (const Keypoint& joint : person.joints) {
      const int cell = joint.p > 0.0F ? grid.cellAt(joint.u, joint.v) : -1;
      if (cell >= 0 && grid.hasDepth(cell)) seeds.push_back(grid.point(cell));
    }
  }
  return seeds;
}

double PaperCutter::cut(const SceneGrid& grid, const std::vector<Eigen::Vector3f>& seeds,
                        const PaperTerms& terms, std::vector<std::uint8_t>& labels) {
  labels.assign(grid.size(), 0);
  if (seeds.empty()) return 0.0;
  const NeighbourSearch search(grid, terms.neighbours - 1, kLongestEdge * terms.sigma_m);
  neighbours_.resize(grid.size());
  parallelFor(grid.rows, kRowsAtOnce, [&](std::size_t begin, std::size_t end) {
    const int last = static_cast<int>(end) * grid.cols;
    for (int cell = static_cast<int>(begin) * grid.cols; cell < last; ++cell) {
      neighbours_[cell] = grid.hasDepth(cell) ? search.find(cell) : std::vector<int>();
      std::sort(neighbours_[cell].begin(), neighbours_[cell].end());
    }
  });
  graph_.begin(grid.size(), terms.neighbours * grid.size());
  node_.assign(grid.size(), -1);
  for (int cell = 0; cell < grid.size(); ++cell) {
    if (!grid.hasDepth(cell)) continue;
    node_[cell] =
        graph_.addNode(terms.foreground_weight,
                       backgroundPenalty(grid.point(cell), seeds, terms.up, terms.radius_m));
  }
  for (int cell = 0; cell < grid.size(); ++cell) {
    for (int other : neighbours_[cell]) {
      const std::vector<int>& back = neighbours_[other];
      const bool mutual = std::binary_search(back.begin(), back.end(), cell);
      if (mutual && other < cell) continue;  // one edge for each pair
      const float length_m = (grid.point(cell) - grid.point(other)).norm();
      graph_.addEdge(node_[cell], node_[other], smoothnessCost(length_m, terms.sigma_m));
    }
  }
  const double cost = graph_.solve();
  for (int cell = 0; cell < grid.size(); ++cell) {
    labels[cell] = node_[cell] >= 0 && graph_.isPerson(node_[cell]);
  }
  return cost;
}

}  // namespace pf
