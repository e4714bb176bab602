// SPDX-License-Identifier: BSD-3-Clause
#include <algorithm>
#include <map>
#include <utility>

#include "posefusion/grid/floor_plan.hpp"

namespace pf {
namespace {

using Edge = std::pair<std::uint32_t, std::uint32_t>;  // its corners, the smaller first

/// Edges that the plane crosses, and those across a triangle from each.
struct Crossings {
  std::map<Edge, std::vector<Edge>> next;

  void join(const Edge& a, const Edge& b) {
    next[a].push_back(b);
    next[b].push_back(a);
  }
};

Crossings crossingsOf(const TriangleMesh& mesh, float height_m) {
  Crossings crossings;
  for (const auto& t : mesh.triangles) {
    std::vector<Edge> crossed;
    for (std::size_t k = 0; k < 3; ++k) {
      const std::uint32_t a = t[k], b = t[(k + 1) % 3];
      const bool above = mesh.positions[a].z() > height_m;
      if (above != (mesh.positions[b].z() > height_m)) crossed.push_back(std::minmax(a, b));
    }
    if (crossed.size() == 2) crossings.join(crossed[0], crossed[1]);
  }
  return crossings;
}

Eigen::Vector2f pointOn(const TriangleMesh& mesh, const Edge& edge, float height_m) {
  const Eigen::Vector3f &a = mesh.positions[edge.first], &b = mesh.positions[edge.second];
  return (a + (height_m - a.z()) / (b.z() - a.z()) * (b - a)).head<2>();
}

}  // namespace

std::vector<Outline> cutLevel(const TriangleMesh& mesh, float height_m) {
  Crossings crossings = crossingsOf(mesh, height_m);
  std::vector<Outline> outlines;
  // Open lines from their ends first, then what is closed.
  for (const bool from_ends : {true, false}) {
    for (const auto& [start, neighbours] : crossings.next) {
      if (neighbours.empty() || (from_ends && neighbours.size() != 1)) continue;
      Outline outline = {pointOn(mesh, start, height_m)};
      for (Edge at = start; !crossings.next[at].empty();) {
        const Edge to = crossings.next[at].front();
        auto& back = crossings.next[to];
        crossings.next[at].erase(crossings.next[at].begin());
        back.erase(std::find(back.begin(), back.end(), at));
        outline.push_back(pointOn(mesh, to, height_m));
        at = to;
      }
      outlines.push_back(std::move(outline));
    }
  }
  return outlines;
}

}  // namespace pf
