// SPDX-License-Identifier: BSD-3-Clause
#include "posefusion/io/map_file.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstring>
#include <sstream>
#include <string_view>

#include "posefusion/core/error.hpp"
#include "posefusion/io/files.hpp"

namespace pf {
namespace {

// Six floats, three bytes, two floats, without gaps.
constexpr std::size_t kVertexBytes = 6 * 4 + 3 + 2 * 4;

constexpr std::string_view kProperties =
    "property float x\nproperty float y\nproperty float z\n"
    "property float nx\nproperty float ny\nproperty float nz\n"
    "property uchar red\nproperty uchar green\nproperty uchar blue\n"
    "property float radius\nproperty float confidence\nend_header\n";
constexpr std::string_view kFormat = "ply\nformat binary_little_endian 1.0\n";

unsigned char toByte(float value) {
  return static_cast<unsigned char>(std::lround(std::min(255.0F, std::max(0.0F, value))));
}

void pack(const SurfelArrays& s, std::size_t i, char* out) {
  const std::array<float, 6> geometry = {s.x[i], s.y[i], s.z[i], s.nx[i], s.ny[i], s.nz[i]};
  const std::array<unsigned char, 3> color = {toByte(s.r[i]), toByte(s.g[i]), toByte(s.b[i])};
  const std::array<float, 2> rest = {s.radius[i], s.confidence[i]};
  std::memcpy(out, geometry.data(), sizeof geometry);
  std::memcpy(out + sizeof geometry, color.data(), sizeof color);
  std::memcpy(out + sizeof geometry + sizeof color, rest.data(), sizeof rest);
}

void unpack(const char* in, std::size_t i, SurfelArrays& s) {
  std::array<float, 6> geometry{};
  std::array<unsigned char, 3> color{};
  std::array<float, 2> rest{};
  std::memcpy(geometry.data(), in, sizeof geometry);
  std::memcpy(color.data(), in + sizeof geometry, sizeof color);
  std::memcpy(rest.data(), in + sizeof geometry + sizeof color, sizeof rest);
  float* const places[] = {&s.x[i], &s.y[i], &s.z[i], &s.nx[i], &s.ny[i], &s.nz[i]};
  for (std::size_t k = 0; k < geometry.size(); ++k) *places[k] = geometry[k];
  s.r[i] = color[0];
  s.g[i] = color[1];
  s.b[i] = color[2];
  s.radius[i] = rest[0];
  s.weight[i] = s.confidence[i] = rest[1];
}

}  // namespace

std::size_t saveMap(const std::string& path, const SurfelMap& map) {
  const std::size_t count = map.stableCount();
  AtomicFile file(path);
  file.stream() << kFormat << "comment surfels of posefusion: map frame, metres\n"
                << "element vertex " << count << "\n"
                << kProperties;
  std::array<char, kVertexBytes> vertex{};
  map.forEachSurfel([&](const SurfelArrays& surfels, std::size_t i) {
    if (!map.isStable(surfels, i)) return;
    pack(surfels, i, vertex.data());
    file.stream().write(vertex.data(), vertex.size());
  });
  file.commit();
  return count;
}

SurfelArrays loadMap(const std::string& path) {
  const std::string text = readFile(path);
  const std::string element = "element vertex ";
  const auto at = text.find(element);
  const auto properties = text.find(kProperties);
  if (text.rfind(kFormat, 0) != 0 || at == std::string::npos || properties == std::string::npos) {
    throw InputError(path +
                     ": is no map of posefusion, expected binary little-endian PLY with its "
                     "properties");
  }
  std::size_t count = 0;
  std::istringstream(text.substr(at + element.size(), 20)) >> count;
  const std::size_t begin = properties + kProperties.size();
  if ((text.size() - begin) / kVertexBytes != count || (text.size() - begin) % kVertexBytes != 0) {
    throw InputError(path + ": is not whole, expected " + std::to_string(count) + " surfels");
  }
  SurfelArrays surfels;
  surfels.resize(count);
  for (std::size_t i = 0; i < count; ++i) unpack(&text[begin + i * kVertexBytes], i, surfels);
  return surfels;
}

}  // namespace pf
