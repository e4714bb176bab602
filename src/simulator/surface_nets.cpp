// SPDX-License-Identifier: BSD-3-Clause
#include "simulator/surface_nets.hpp"

#include <cmath>

#include "posefusion/core/parallel.hpp"

namespace pf::simulator {
namespace {

using Eigen::Vector3f;
using Eigen::Vector3i;

constexpr int kBlock = 4;
using Distance = std::function<float(const Vector3f&)>;

/// Distances at the corners of all cells.
struct Grid {
  Vector3i size;
  Vector3f low;
  float cell_m;
  std::vector<float> value;

  std::size_t at(int x, int y, int z) const {
    return static_cast<std::size_t>(x + size.x() * (y + size.y() * z));
  }
  Vector3f point(int x, int y, int z) const {
    return low +
           cell_m * Vector3f(static_cast<float>(x), static_cast<float>(y), static_cast<float>(z));
  }
};

/// Samples blocks of corners; one sample tells whether the surface can be in a block at all.
void sampleLayer(const Distance& distance, int z0, Grid& grid) {
  const float reach = 1.3F * kBlock * grid.cell_m;
  const Vector3f half = Vector3f::Constant(0.5F * (kBlock - 1) * grid.cell_m);
  for (int y0 = 0; y0 < grid.size.y(); y0 += kBlock) {
    for (int x0 = 0; x0 < grid.size.x(); x0 += kBlock) {
      const float middle = distance(grid.point(x0, y0, z0) + half);
      const bool far = std::abs(middle) > reach;
      for (int i = 0; i < kBlock * kBlock * kBlock; ++i) {
        const int x = x0 + i % kBlock, y = y0 + i / kBlock % kBlock, z = z0 + i / (kBlock * kBlock);
        grid.value[grid.at(x, y, z)] = far ? middle : distance(grid.point(x, y, z));
      }
    }
  }
}

Grid sample(const Distance& distance, const Eigen::AlignedBox3f& box, float cell_m) {
  Grid grid;
  grid.low = box.min();
  grid.cell_m = cell_m;
  for (int i = 0; i < 3; ++i) {
    const int cells = static_cast<int>(std::ceil(box.sizes()[i] / cell_m)) + 2;
    grid.size[i] = (cells + kBlock - 1) / kBlock * kBlock;
  }
  grid.value.resize(static_cast<std::size_t>(grid.size.prod()));
  parallelFor(static_cast<std::size_t>(grid.size.z() / kBlock), 1,
              [&](std::size_t begin, std::size_t end) {
                for (std::size_t b = begin; b < end; ++b)
                  sampleLayer(distance, static_cast<int>(b) * kBlock, grid);
              });
  return grid;
}
/// The mean of the crossings of a cell's edges, if there are any.
bool cellPoint(const Grid& grid, const Vector3i& cell, Vector3f& point) {
  float corner[8];
  for (int i = 0; i < 8; ++i) {
    corner[i] =
        grid.value[grid.at(cell.x() + (i & 1), cell.y() + (i >> 1 & 1), cell.z() + (i >> 2))];
  }
  Vector3f sum = Vector3f::Zero();
  int count = 0;
  for (int i = 0; i < 8; ++i) {
    for (int axis = 0; axis < 3; ++axis) {
      const int j = i | 1 << axis;
      if (j == i || (corner[i] < 0.0F) == (corner[j] < 0.0F)) continue;
      Vector3f p(static_cast<float>(i & 1), static_cast<float>(i >> 1 & 1),
                 static_cast<float>(i >> 2));
      p[axis] = corner[i] / (corner[i] - corner[j]);
      sum += p;
      ++count;
    }
  }
  if (count == 0) return false;
  point = grid.point(cell.x(), cell.y(), cell.z()) + grid.cell_m * sum / static_cast<float>(count);
  return true;
}

Vector3f gradient(const Distance& distance, const Vector3f& p, float step) {
  Vector3f g;
  for (int i = 0; i < 3; ++i) {
    const Vector3f d = step * Vector3f::Unit(i);
    g[i] = distance(p + d) - distance(p - d);
  }
  const float norm = g.norm();
  return norm > 0.0F ? Vector3f(g / norm) : Vector3f::UnitZ();
}

/// A quad across every edge of the grid that crosses the surface.
void connect(const Grid& grid, const std::vector<int>& vertex, Polygonised& out) {
  for (int z = 1; z + 1 < grid.size.z(); ++z) {
    for (int y = 1; y + 1 < grid.size.y(); ++y) {
      for (int x = 1; x + 1 < grid.size.x(); ++x) {
        const bool inside = grid.value[grid.at(x, y, z)] < 0.0F;
        for (int axis = 0; axis < 3; ++axis) {
          Vector3i next(x, y, z);
          ++next[axis];
          if (inside == (grid.value[grid.at(next.x(), next.y(), next.z())] < 0.0F)) continue;
          const Vector3i u = Vector3i::Unit((axis + 1) % 3), v = Vector3i::Unit((axis + 2) % 3);
          const Vector3i c(x, y, z);
          std::uint32_t q[4];
          const Vector3i cells[4] = {c, c - u, c - u - v, c - v};
          for (int i = 0; i < 4; ++i) {
            q[i] = static_cast<std::uint32_t>(
                vertex[grid.at(cells[i].x(), cells[i].y(), cells[i].z())]);
          }
          if (!inside) std::swap(q[1], q[3]);
          out.triangles.push_back({q[0], q[1], q[2]});
          out.triangles.push_back({q[0], q[2], q[3]});
        }
      }
    }
  }
}

}  // namespace

Polygonised polygonise(const Distance& distance, const Eigen::AlignedBox3f& box, float cell_m) {
  const Grid grid = sample(distance, box, cell_m);
  Polygonised out;
  std::vector<int> vertex(grid.value.size(), -1);
  for (int z = 0; z + 1 < grid.size.z(); ++z) {
    for (int y = 0; y + 1 < grid.size.y(); ++y) {
      for (int x = 0; x + 1 < grid.size.x(); ++x) {
        Vector3f point;
        if (!cellPoint(grid, {x, y, z}, point)) continue;
        vertex[grid.at(x, y, z)] = static_cast<int>(out.positions.size());
        out.positions.push_back(point);
      }
    }
  }
  connect(grid, vertex, out);
  out.normals.resize(out.positions.size());
  parallelFor(out.positions.size(), 512, [&](std::size_t begin, std::size_t end) {
    for (std::size_t i = begin; i < end; ++i) {
      out.normals[i] = gradient(distance, out.positions[i], 0.4F * cell_m);
    }
  });
  return out;
}

}  // namespace pf::simulator
