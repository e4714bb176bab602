// SPDX-License-Identifier: BSD-3-Clause
#include "posefusion/io/map_file.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstring>

#include "posefusion/core/error.hpp"
#include "posefusion/io/files.hpp"
#include "posefusion/io/ply.hpp"

namespace pf {
namespace {

// A point, then radius and confidence.
constexpr std::size_t kVertexBytes = PlyPoint::kBytes + 2 * sizeof(float);

std::vector<std::string> vertexProperties() {
  std::vector<std::string> properties = PlyPoint::properties();
  properties.insert(properties.end(), {"float radius", "float confidence"});
  return properties;
}

unsigned char toByte(float value) {
  return static_cast<unsigned char>(std::lround(std::min(255.0F, std::max(0.0F, value))));
}

void pack(const SurfelArrays& s, std::size_t i, char* out) {
  const PlyPoint point{{s.x[i], s.y[i], s.z[i]},
                       {s.nx[i], s.ny[i], s.nz[i]},
                       {toByte(s.r[i]), toByte(s.g[i]), toByte(s.b[i])}};
  point.pack(out);
  const std::array<float, 2> rest = {s.radius[i], s.confidence[i]};
  std::memcpy(out + PlyPoint::kBytes, rest.data(), sizeof rest);
}

void unpack(const char* in, std::size_t i, SurfelArrays& s) {
  const PlyPoint point = PlyPoint::unpack(in);
  std::array<float, 2> rest{};
  std::memcpy(rest.data(), in + PlyPoint::kBytes, sizeof rest);
  s.x[i] = point.position[0];
  s.y[i] = point.position[1];
  s.z[i] = point.position[2];
  s.nx[i] = point.normal[0];
  s.ny[i] = point.normal[1];
  s.nz[i] = point.normal[2];
  s.r[i] = point.color[0];
  s.g[i] = point.color[1];
  s.b[i] = point.color[2];
  s.radius[i] = rest[0];
  s.weight[i] = s.confidence[i] = rest[1];
}

}  // namespace

std::size_t saveMap(const std::string& path, const SurfelMap& map) {
  const SurfelArrays& surfels = map.surfels();
  const std::size_t count = map.stableCount();
  AtomicFile file(path);
  file.stream() << plyHeader({{"vertex", count, vertexProperties()}},
                             "surfels of posefusion: map frame, metres");
  std::array<char, kVertexBytes> vertex{};
  for (std::size_t i = 0; i < surfels.size(); ++i) {
    if (!map.isStable(i)) continue;
    pack(surfels, i, vertex.data());
    file.stream().write(vertex.data(), vertex.size());
  }
  file.commit();
  return count;
}

SurfelArrays loadMap(const std::string& path) {
  const std::string text = readFile(path);
  const auto vertices = findPlyVertices(text, vertexProperties());
  if (!vertices) {
    throw InputError(path +
                     ": is no map of posefusion, expected binary little-endian PLY with its "
                     "properties");
  }
  const std::size_t count = vertices->count, bytes = text.size() - vertices->begin;
  if (bytes / kVertexBytes != count || bytes % kVertexBytes != 0) {
    throw InputError(path + ": is not whole, expected " + std::to_string(count) + " surfels");
  }
  SurfelArrays surfels;
  surfels.forEachArray([&](auto& array) { array.resize(count); });
  for (std::size_t i = 0; i < count; ++i) {
    unpack(&text[vertices->begin + i * kVertexBytes], i, surfels);
  }
  return surfels;
}

}  // namespace pf
