// SPDX-License-Identifier: BSD-3-Clause
#include "posefusion/mesh/page_chunks.hpp"

#include <algorithm>
#include <cmath>
#include <functional>
#include <numeric>

namespace pf {
namespace {

using Eigen::Vector3f;
using Numbers = std::vector<std::uint32_t>;

constexpr float kSteps = 65535, kNormalSteps = 127;
constexpr unsigned char kGrey = 128;

/// Cuts the numbered points at the middle of their box's longer side until `isSmall(begin, end)`,
/// and gives each part to `take`, its numbers ascending.
class Cutter {
 public:
  using Part = std::function<void(const std::uint32_t* begin, const std::uint32_t* end)>;
  using Test = std::function<bool(const std::uint32_t* begin, const std::uint32_t* end)>;

  Cutter(const std::vector<Vector3f>& points, Test isSmall, Part take)
      : points_(points), isSmall_(std::move(isSmall)), take_(std::move(take)) {}

  void cut() {
    Numbers all(points_.size());
    std::iota(all.begin(), all.end(), 0U);
    if (!all.empty()) cut(all.data(), all.data() + all.size());
  }

 private:
  void cut(std::uint32_t* begin, std::uint32_t* end) {
    if (isSmall_(begin, end)) {
      std::sort(begin, end);
      return take_(begin, end);
    }
    Vector3f low = points_[*begin], high = low;
    for (const std::uint32_t* i = begin; i != end; ++i) {
      low = low.cwiseMin(points_[*i]);
      high = high.cwiseMax(points_[*i]);
    }
    int axis = 0;
    (high - low).maxCoeff(&axis);
    std::uint32_t* const middle = begin + (end - begin) / 2;
    std::nth_element(begin, middle, end, [&](std::uint32_t a, std::uint32_t b) {
      const float at_a = points_[a][axis], at_b = points_[b][axis];
      return at_a < at_b || (at_a == at_b && a < b);
    });
    cut(begin, middle);
    cut(middle, end);
  }

  const std::vector<Vector3f>& points_;
  Test isSmall_;
  Part take_;
};

template <typename T>
T rounded(float value, float low, float high) {
  return static_cast<T>(std::lround(std::clamp(value, low, high)));
}

/// On an octahedron that is folded into a square (Meyer et al., "On floating-point normal
/// vectors", 2010).
std::array<std::int8_t, 2> packNormal(const Vector3f& normal) {
  const float sum = normal.cwiseAbs().sum();
  if (!(sum > 0) || !std::isfinite(sum)) return {0, 0};
  const Vector3f n = normal / sum;
  float u = n.x(), v = n.y();
  if (n.z() < 0) {
    u = std::copysign(1 - std::abs(n.y()), n.x());
    v = std::copysign(1 - std::abs(n.x()), n.y());
  }
  const auto pack = [](float value) {
    return rounded<std::int8_t>(kNormalSteps * value, -kNormalSteps, kNormalSteps);
  };
  return {pack(u), pack(v)};
}

/// Fits the box of a chunk to `points`, and puts its vertices there.
void putVertices(PageChunk& chunk, const std::vector<Vector3f>& points) {
  Vector3f low = points.front(), high = low;
  for (const Vector3f& p : points) {
    low = low.cwiseMin(p);
    high = high.cwiseMax(p);
  }
  chunk.low = low;
  chunk.side = high - low;
  for (std::size_t i = 0; i < points.size(); ++i) {
    for (int axis = 0; axis < 3; ++axis) {
      const float side = chunk.side[axis];
      const float share = side > 0 ? (points[i][axis] - low[axis]) / side : 0;
      chunk.vertices[i].place[static_cast<std::size_t>(axis)] =
          rounded<std::uint16_t>(kSteps * share, 0, kSteps);
    }
  }
}

/// Makes chunks of triangles of one mesh.
class ChunkMaker {
 public:
  explicit ChunkMaker(const TriangleMesh& mesh) : mesh_(mesh), places_(mesh.size()) {}

  bool isSmall(const std::uint32_t* begin, const std::uint32_t* end) {
    ++round_;
    std::size_t count = 0;
    for (; begin != end && count <= PageChunk::kMostVertices; ++begin) {
      for (const std::uint32_t corner : mesh_.triangles[*begin]) {
        if (places_[corner].round == round_) continue;
        places_[corner].round = round_;
        ++count;
      }
    }
    return count <= PageChunk::kMostVertices;
  }

  PageChunk take(const std::uint32_t* begin, const std::uint32_t* end) {
    ++round_;
    PageChunk chunk;
    std::vector<Vector3f> points;
    for (; begin != end; ++begin) {
      for (const std::uint32_t corner : mesh_.triangles[*begin]) {
        Place& place = places_[corner];
        if (place.round != round_) {
          place = {round_, static_cast<std::uint16_t>(points.size())};
          points.push_back(mesh_.positions[corner]);
          chunk.vertices.push_back(vertex(corner));
        }
        chunk.indices.push_back(place.number);
      }
    }
    putVertices(chunk, points);
    return chunk;
  }

 private:
  struct Place {
    std::uint32_t round = 0;
    std::uint16_t number = 0;
  };

  PageVertex vertex(std::uint32_t corner) const {
    PageVertex vertex;
    vertex.normal = packNormal(mesh_.normals[corner]);
    const MeshColor& color = mesh_.colors[corner];
    vertex.color = {color[0], color[1], color[2]};
    return vertex;
  }

  const TriangleMesh& mesh_;
  std::vector<Place> places_;  // of each corner in the chunk of that round
  std::uint32_t round_ = 0;
};

Vector3f pointOf(const SurfelArrays& s, std::size_t i) { return {s.x[i], s.y[i], s.z[i]}; }

bool isFinite(const SurfelArrays& s, std::size_t i) {
  return pointOf(s, i).allFinite() && std::isfinite(s.nx[i] + s.ny[i] + s.nz[i]) &&
         std::isfinite(s.radius[i]) && s.radius[i] > 0;
}

PageVertex vertexOf(const SurfelArrays& s, std::size_t i, float largest_radius_m) {
  PageVertex vertex;
  vertex.normal = packNormal({s.nx[i], s.ny[i], s.nz[i]});
  const bool has_color = std::isfinite(s.r[i] + s.g[i] + s.b[i]);
  const auto byte = [&](float value) {
    return has_color ? rounded<std::uint8_t>(value, 0, 255) : kGrey;
  };
  vertex.color = {byte(s.r[i]), byte(s.g[i]), byte(s.b[i])};
  // The smallest is seen too.
  vertex.radius = rounded<std::uint8_t>(255 * s.radius[i] / largest_radius_m, 1, 255);
  return vertex;
}

}  // namespace

std::vector<PageChunk> pageChunks(const TriangleMesh& mesh) {
  std::vector<Vector3f> centers;
  centers.reserve(mesh.triangles.size());
  for (const auto& t : mesh.triangles) {
    centers.push_back((mesh.positions[t[0]] + mesh.positions[t[1]] + mesh.positions[t[2]]) / 3);
  }
  ChunkMaker pieces(mesh);
  std::vector<PageChunk> chunks;
  Cutter(
      centers, [&](const auto* begin, const auto* end) { return pieces.isSmall(begin, end); },
      [&](const auto* begin, const auto* end) { chunks.push_back(pieces.take(begin, end)); })
      .cut();
  return chunks;
}

std::vector<PageChunk> pageChunks(const SurfelArrays& surfels) {
  Numbers shown;
  std::vector<Vector3f> points;
  for (std::size_t i = 0; i < surfels.size(); ++i) {
    if (!isFinite(surfels, i)) continue;
    shown.push_back(static_cast<std::uint32_t>(i));
    points.push_back(pointOf(surfels, i));
  }
  std::vector<PageChunk> chunks;
  const auto take = [&](const std::uint32_t* begin, const std::uint32_t* end) {
    PageChunk chunk;
    std::vector<Vector3f> here;
    for (const auto* i = begin; i != end; ++i) {
      chunk.largest_radius_m = std::max(chunk.largest_radius_m, surfels.radius[shown[*i]]);
      here.push_back(points[*i]);
    }
    for (const auto* i = begin; i != end; ++i) {
      chunk.vertices.push_back(vertexOf(surfels, shown[*i], chunk.largest_radius_m));
    }
    putVertices(chunk, here);
    chunks.push_back(std::move(chunk));
  };
  const auto isSmall = [](const std::uint32_t* begin, const std::uint32_t* end) {
    return static_cast<std::size_t>(end - begin) <= PageChunk::kMostVertices;
  };
  Cutter(points, isSmall, take).cut();
  return chunks;
}

Vector3f positionOf(const PageChunk& chunk, const PageVertex& vertex) {
  const Vector3f place(vertex.place[0], vertex.place[1], vertex.place[2]);
  return chunk.low + chunk.side.cwiseProduct(place) / kSteps;
}

Vector3f normalOf(const PageVertex& vertex) {
  const float u = static_cast<float>(vertex.normal[0]) / kNormalSteps;
  const float v = static_cast<float>(vertex.normal[1]) / kNormalSteps;
  Vector3f n(u, v, 1 - std::abs(u) - std::abs(v));
  const float below = std::max(-n.z(), 0.0F);
  n.x() -= std::copysign(below, n.x());
  n.y() -= std::copysign(below, n.y());
  return n.normalized();
}

}  // namespace pf
