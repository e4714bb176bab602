// SPDX-License-Identifier: BSD-3-Clause
#include "vertex_paint.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

#include "posefusion/core/parallel.hpp"

namespace pf {
namespace {

using Eigen::Vector3f;
using Eigen::Vector3i;

constexpr std::size_t kGrain = 4;
constexpr float kSameSide = 0.2F;  // 78 degrees

/// Sums of what one vertex is told.
struct Told {
  Vector3f normal = Vector3f::Zero(), color = Vector3f::Zero();
  float weight = 0, distance = 0, color_weight = 0;
  float nearest = std::numeric_limits<float>::max();
  int surfels = 0;

  void add(const Disc& disc, const Disc::Place& where, float same_side) {
    const float weight_here = disc.weight * same_side * disc.closeness(where);
    weight += weight_here;
    distance += weight_here * where.above;
    normal += weight_here * disc.normal;
    nearest = std::min(nearest, where.toDisc(disc.radius));
    ++surfels;
    if (!disc.color.allFinite()) return;
    // Colours change faster along a surface than its shape: the nearest say most.
    const float colored = weight_here * disc.closeness(where);
    color += colored * disc.color;
    color_weight += colored;
  }
};

/// Normals of the net itself, by the area of the triangles around.
std::vector<Vector3f> facings(const SurfaceNet& net) {
  std::vector<Vector3f> normals(net.positions.size(), Vector3f::Zero());
  for (const auto& t : net.triangles) {
    const Vector3f a = net.positions[t[0]];
    const Vector3f twice_area = (net.positions[t[1]] - a).cross(net.positions[t[2]] - a);
    for (const std::uint32_t corner : t) normals[corner] += twice_area;
  }
  for (Vector3f& normal : normals) normal.normalize();
  return normals;
}

MeshColor toColor(const Told& told) {
  if (told.color_weight <= 0) return MeshColor::Constant(128);
  const Vector3f mean = told.color / told.color_weight;
  return mean.cwiseMax(0.0F).cwiseMin(255.0F).array().round().cast<unsigned char>();
}

}  // namespace

PaintedVertices paint(const SurfelArrays& surfels, const DiscBlocks& blocks,
                      const MeshConfig& config, SurfaceNet& net) {
  const DiscMaker maker(surfels, config);
  const float most_m = 0.5F * blocks.lattice.cell_m(), bridge = static_cast<float>(config.bridge_m);
  PaintedVertices out;
  out.normals = facings(net);
  out.colors.resize(net.positions.size());
  out.seen.resize(net.positions.size());
  parallelFor(blocks.lattice.size(), kGrain, [&](std::size_t begin, std::size_t end) {
    std::array<Told, BlockLattice::kCorners> told;
    for (std::size_t i = begin; i < end; ++i) {
      const std::uint32_t* vertex = &net.vertex[i * BlockLattice::kCorners];
      const auto pointAt = [&](std::size_t place, const Vector3i&, Vector3f& point) {
        if (vertex[place] == SurfaceNet::kNone) return false;
        point = net.positions[vertex[place]];
        return true;
      };
      told.fill({});
      forEachPointOf(maker, blocks, i, pointAt,
                     [&](std::size_t place, const Disc& disc, const auto& where) {
                       const float same = disc.normal.dot(out.normals[vertex[place]]);
                       if (same > kSameSide) told[place].add(disc, where, same);
                     });
      for (std::size_t place = 0; place < BlockLattice::kCorners; ++place) {
        const Told& t = told[place];
        if (vertex[place] == SurfaceNet::kNone || !(t.weight > 0)) continue;
        Vector3f& normal = out.normals[vertex[place]];
        normal = t.normal.normalized();
        const float step = std::clamp(t.distance / t.weight, -most_m, most_m);
        net.positions[vertex[place]] -= step * normal;
        out.colors[vertex[place]] = toColor(t);
        out.seen[vertex[place]] =
            t.surfels >= config.least_surfels && t.nearest <= bridge * bridge ? 1 : 0;
      }
    }
  });
  return out;
}

}  // namespace pf
