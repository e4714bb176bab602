// SPDX-License-Identifier: BSD-3-Clause
#include "vertex_paint.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include "posefusion/core/parallel.hpp"

namespace pf {
namespace {

using Eigen::Vector3f;
using Eigen::Vector3i;

constexpr std::size_t kPaintedAtOnce = 4;
constexpr float kSameSide = 0.2F;  // 78 degrees

/// Sums of the surfels at one vertex.
struct VertexSums {
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

MeshColor toColor(const VertexSums& sums) {
  if (sums.color_weight <= 0) return MeshColor::Constant(128);
  const Vector3f mean = sums.color / sums.color_weight;
  return mean.cwiseMax(0.0F).cwiseMin(255.0F).array().round().cast<unsigned char>();
}

/// Paints the vertices of single blocks.
class Painter {
 public:
  Painter(const SurfelArrays& surfels, const DiscBlocks& blocks, const MeshConfig& config,
          SurfaceNet& net, PaintedVertices& out)
      : maker_(surfels, config),
        blocks_(blocks),
        net_(net),
        out_(out),
        most_m_(0.5F * blocks.lattice.cell_m()),
        bridge_m_(static_cast<float>(config.bridge_m)),
        least_surfels_(config.least_surfels) {}

  void paint(std::size_t i, std::vector<VertexSums>& sums) {
    const std::size_t first = net_.first[i];
    const std::size_t last = i + 1 < net_.first.size() ? net_.first[i + 1] : net_.positions.size();
    if (first == last) return;
    sums.assign(last - first, {});
    const auto pointAt = [&](std::size_t cell, const Vector3i&, Vector3f& point) {
      const std::uint32_t vertex = net_.vertex(i, cell);
      if (vertex == SurfaceNet::kNone) return false;
      point = net_.positions[vertex];
      return true;
    };
    forEachPointOf(maker_, blocks_, i, pointAt,
                   [&](std::size_t cell, const Disc& disc, const Disc::Place& where) {
                     const std::uint32_t vertex = net_.vertex(i, cell);
                     const float same = disc.normal.dot(out_.normals[vertex]);
                     if (same > kSameSide) sums[vertex - first].add(disc, where, same);
                   });
    for (std::size_t k = 0; k < sums.size(); ++k) finish(sums[k], first + k);
  }

 private:
  void finish(const VertexSums& sums, std::size_t vertex) {
    if (!(sums.weight > 0)) return;
    out_.normals[vertex] = sums.normal.normalized();
    const float step = std::clamp(sums.distance / sums.weight, -most_m_, most_m_);
    net_.positions[vertex] -= step * out_.normals[vertex];
    out_.colors[vertex] = toColor(sums);
    const bool near = sums.nearest <= bridge_m_ * bridge_m_;
    out_.seen[vertex] = near && sums.surfels >= least_surfels_ ? 1 : 0;
  }

  DiscMaker maker_;
  const DiscBlocks& blocks_;
  SurfaceNet& net_;
  PaintedVertices& out_;
  float most_m_, bridge_m_;
  int least_surfels_;
};

}  // namespace

PaintedVertices paint(const SurfelArrays& surfels, const DiscBlocks& blocks,
                      const MeshConfig& config, SurfaceNet& net) {
  PaintedVertices out;
  out.normals = facings(net);
  out.colors.resize(net.positions.size());
  out.seen.resize(net.positions.size());
  Painter painter(surfels, blocks, config, net, out);
  parallelFor(blocks.lattice.size(), kPaintedAtOnce, [&](std::size_t begin, std::size_t end) {
    std::vector<VertexSums> sums;
    for (std::size_t i = begin; i < end; ++i) painter.paint(i, sums);
  });
  return out;
}

}  // namespace pf
