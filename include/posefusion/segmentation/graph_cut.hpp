// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <memory>

namespace pf {

/// Minimum cut of a graph between person and background (Boykov and Kolmogorov's algorithm as
/// OpenCV ships it, which is wrapped here and nowhere else).
class GraphCut {
 public:
  GraphCut();
  ~GraphCut();

  /// Starts a new graph; the numbers are only a hint for the memory.
  void begin(int nodes, int edges);
  /// Adds a node and returns its number, counted from 0. The costs, >= 0, are paid when it ends on
  /// the other side.
  int addNode(float person_weight, float background_weight);
  /// Adds an edge whose weight, >= 0, is paid when its ends are separated.
  void addEdge(int a, int b, float weight);
  /// Returns the cost of the cheapest cut.
  double solve();
  bool isPerson(int node) const;

 private:
  struct Graph;
  std::unique_ptr<Graph> graph_;
};

}  // namespace pf
