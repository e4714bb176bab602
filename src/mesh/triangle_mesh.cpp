// SPDX-License-Identifier: BSD-3-Clause
#include "posefusion/mesh/triangle_mesh.hpp"

namespace pf {

TriangleMesh onlyKept(const TriangleMesh& mesh, const std::vector<char>& keep) {
  constexpr std::uint32_t kUnused = ~std::uint32_t{0};
  std::vector<std::uint32_t> place(mesh.size(), kUnused);
  for (std::size_t t = 0; t < mesh.triangles.size(); ++t) {
    if (keep[t] == 0) continue;
    for (const std::uint32_t corner : mesh.triangles[t]) place[corner] = 0;
  }
  TriangleMesh kept;
  for (std::size_t v = 0; v < mesh.size(); ++v) {
    if (place[v] == kUnused) continue;
    place[v] = static_cast<std::uint32_t>(kept.size());
    kept.positions.push_back(mesh.positions[v]);
    if (!mesh.normals.empty()) kept.normals.push_back(mesh.normals[v]);
    if (!mesh.colors.empty()) kept.colors.push_back(mesh.colors[v]);
  }
  for (std::size_t t = 0; t < mesh.triangles.size(); ++t) {
    if (keep[t] == 0) continue;
    const auto& corners = mesh.triangles[t];
    kept.triangles.push_back({place[corners[0]], place[corners[1]], place[corners[2]]});
  }
  return kept;
}

}  // namespace pf
