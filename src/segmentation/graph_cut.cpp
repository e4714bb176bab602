// SPDX-License-Identifier: BSD-3-Clause
#include "posefusion/segmentation/graph_cut.hpp"

#include <opencv2/core.hpp>
#include <vector>
// Not self-contained: needs the two above.
#include <opencv2/imgproc/detail/gcgraph.hpp>

namespace pf {

namespace {

// Weights in whole steps: the cut is exact and does not depend on the order of float additions.
constexpr float kSteps = 256.0F;

int toSteps(float weight) { return static_cast<int>(weight * kSteps + 0.5F); }

}  // namespace

struct GraphCut::Graph {
  cv::detail::GCGraph<int> solver;
};

GraphCut::GraphCut() : graph_(std::make_unique<Graph>()) {}
GraphCut::~GraphCut() = default;

void GraphCut::begin(int nodes, int edges) {
  // create() only reserves memory: a used solver would keep its old vertices.
  graph_->solver = cv::detail::GCGraph<int>();
  // It keeps two directed edges for each of ours.
  graph_->solver.create(static_cast<unsigned>(nodes), static_cast<unsigned>(2 * edges + 2));
}

int GraphCut::addNode(float person_weight, float background_weight) {
  const int node = graph_->solver.addVtx();
  graph_->solver.addTermWeights(node, toSteps(person_weight), toSteps(background_weight));
  return node;
}

void GraphCut::addEdge(int a, int b, float weight) {
  const int steps = toSteps(weight);
  if (steps > 0) graph_->solver.addEdges(a, b, steps, steps);
}

double GraphCut::solve() { return graph_->solver.maxFlow() / kSteps; }

bool GraphCut::isPerson(int node) const { return graph_->solver.inSourceSegment(node); }

}  // namespace pf
