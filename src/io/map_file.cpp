// SPDX-License-Identifier: BSD-3-Clause
#include "posefusion/io/map_file.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstring>

#include "posefusion/core/error.hpp"
#include "posefusion/core/rigid_motion.hpp"
#include "posefusion/core/static_odds.hpp"
#include "posefusion/io/files.hpp"
#include "posefusion/io/ply.hpp"

namespace pf {
namespace {

// A point, then radius and confidence.
constexpr std::size_t kVertexBytes = kPointBytes + 2 * sizeof(float);

std::vector<std::string> vertexProperties() {
  std::vector<std::string> properties = pointProperties();
  properties.insert(properties.end(), {"float radius", "float confidence"});
  return properties;
}

unsigned char toByte(float value) {
  return static_cast<unsigned char>(std::lround(std::min(255.0F, std::max(0.0F, value))));
}

void pack(const SurfelArrays& s, std::size_t i, const RigidMotion& motion, char* out) {
  SurfacePoint point;
  Eigen::Vector3f& p = point.position;
  Eigen::Vector3f& n = point.normal;
  motion.point(s.x[i], s.y[i], s.z[i], p.x(), p.y(), p.z());
  motion.direction(s.nx[i], s.ny[i], s.nz[i], n.x(), n.y(), n.z());
  point.color = {toByte(s.r[i]), toByte(s.g[i]), toByte(s.b[i])};
  packPoint(point, out);
  const std::array<float, 2> rest = {s.radius[i], static_odds::probability(s.odds[i])};
  std::memcpy(out + kPointBytes, rest.data(), sizeof rest);
}

/// `addAll(add)` calls add(surfels, i, motion) `count` times.
template <typename AddAll>
void writePoints(const std::string& path, std::size_t count, const AddAll& addAll) {
  AtomicFile file(path);
  file.stream() << plyHeader({{"vertex", count, vertexProperties()}},
                             "surfels of posefusion: map frame, metres");
  std::array<char, kVertexBytes> vertex{};
  addAll([&](const SurfelArrays& surfels, std::size_t i, const RigidMotion& motion) {
    pack(surfels, i, motion, vertex.data());
    file.stream().write(vertex.data(), vertex.size());
  });
  file.commit();
}

/// Throws where the file has other vertices than saveMap() writes.
PlyVertices findVertices(const std::string& file) {
  PlyVertices vertices = readPlyHeader(file);
  const bool same = vertices.bytes == kVertexBytes &&
                    vertices.offset("radius", "float") == kPointBytes &&
                    vertices.offset("confidence", "float") == kPointBytes + sizeof(float);
  if (!same) throw InputError("other properties");
  return vertices;
}

void unpack(const SurfacePoint& point, const char* vertex, std::size_t i, SurfelArrays& s) {
  std::array<float, 2> rest{};
  std::memcpy(rest.data(), vertex + kPointBytes, sizeof rest);
  s.x[i] = point.position.x();
  s.y[i] = point.position.y();
  s.z[i] = point.position.z();
  s.nx[i] = point.normal.x();
  s.ny[i] = point.normal.y();
  s.nz[i] = point.normal.z();
  s.r[i] = point.color[0];
  s.g[i] = point.color[1];
  s.b[i] = point.color[2];
  s.radius[i] = rest[0];
  s.weight[i] = 1.0F;
  // Files of older versions have frames here: 1 and more.
  s.odds[i] = std::min(static_odds::kMost, static_odds::of(std::clamp(rest[1], 0.0F, 1.0F)));
}

}  // namespace

std::size_t savedSurfels(const SurfelMap& map) {
  std::size_t count = 0;
  map.forEachSurfelOf(kFirstFragment, [&](const SurfelArrays& s, std::size_t i) {
    count += map.isStable(s, i) ? 1 : 0;
  });
  return count;
}

std::size_t saveMap(const std::string& path, const SurfelMap& map,
                    const Eigen::Isometry3d& T_file_map) {
  const RigidMotion motion(T_file_map);
  const std::size_t count = savedSurfels(map);
  writePoints(path, count, [&](const auto& add) {
    map.forEachSurfelOf(kFirstFragment, [&](const SurfelArrays& surfels, std::size_t i) {
      if (map.isStable(surfels, i)) add(surfels, i, motion);
    });
  });
  return count;
}

void saveSurfels(const std::string& path, const SurfelArrays& surfels) {
  const RigidMotion none(Eigen::Isometry3d::Identity());
  writePoints(path, surfels.size(), [&](const auto& add) {
    for (std::size_t i = 0; i < surfels.size(); ++i) add(surfels, i, none);
  });
}

SurfelArrays loadMap(const std::string& path) {
  const std::string text = readFile(path);
  PlyVertices vertices;
  try {
    vertices = findVertices(text);
  } catch (const InputError&) {
    throw InputError(path +
                     ": is no map of posefusion, expected binary little-endian PLY with its "
                     "properties");
  }
  const std::size_t count = vertices.count, bytes = text.size() - vertices.begin;
  if (bytes / kVertexBytes != count || bytes % kVertexBytes != 0) {
    throw InputError(path + ": is not whole, expected " + std::to_string(count) + " surfels");
  }
  const std::vector<SurfacePoint> points = readPoints(text, vertices);
  SurfelArrays surfels;
  surfels.resize(count);
  for (std::size_t i = 0; i < count; ++i) {
    unpack(points[i], &text[vertices.begin + i * kVertexBytes], i, surfels);
  }
  return surfels;
}

}  // namespace pf
