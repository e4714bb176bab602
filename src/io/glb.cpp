// SPDX-License-Identifier: BSD-3-Clause
#include "glb.hpp"

#include <array>
#include <cmath>
#include <nlohmann/json.hpp>
#include <vector>

#include "posefusion/core/error.hpp"

namespace pf {
namespace {

using nlohmann::ordered_json;

// Numbers of the specification ("glTF 2.0", Khronos Group, 2017).
constexpr int kUnsignedShort = 5123, kUnsignedInt = 5125, kFloat = 5126;
constexpr int kVertices = 34962, kIndices = 34963, kTriangles = 4;
constexpr std::uint32_t kMagic = 0x46546C67, kVersion = 2, kJson = 0x4E4F534A, kBytes = 0x004E4942;
constexpr std::uint64_t kMostBytes = 0xffffffffU;

using Color16 = std::array<std::uint16_t, 4>;  // with opacity: its length must be 4's multiple

/// Of a byte as pictures have it (IEC 61966-2-1, sRGB) to the linear light of glTF.
std::uint16_t toLinear(unsigned char byte) {
  const double s = byte / 255.0;
  const double linear = s <= 0.04045 ? s / 12.92 : std::pow((s + 0.055) / 1.055, 2.4);
  return static_cast<std::uint16_t>(std::lround(65535 * linear));
}

std::vector<Color16> linearColors(const TriangleMesh& mesh) {
  std::array<std::uint16_t, 256> table{};
  for (std::size_t i = 0; i < table.size(); ++i) table[i] = toLinear(static_cast<unsigned char>(i));
  std::vector<Color16> colors;
  colors.reserve(mesh.size());
  for (const MeshColor& c : mesh.colors) {
    colors.push_back({table[c[0]], table[c[1]], table[c[2]], 65535});
  }
  return colors;
}

/// The arrays of the mesh one after the other, and how the JSON speaks of them.
struct Layout {
  ordered_json views = ordered_json::array(), accessors = ordered_json::array();
  std::uint64_t bytes = 0;

  /// Returns the accessor, to be filled further.
  ordered_json& add(std::uint64_t size, std::uint64_t count, int component, const char* type,
                    int target) {
    views.push_back(
        {{"buffer", 0}, {"byteOffset", bytes}, {"byteLength", size}, {"target", target}});
    accessors.push_back({{"bufferView", views.size() - 1},
                         {"componentType", component},
                         {"count", count},
                         {"type", type}});
    bytes += size;
    return accessors.back();
  }
};

Layout layoutOf(const TriangleMesh& mesh) {
  Eigen::Vector3f low = mesh.positions.front(), high = low;
  for (const Eigen::Vector3f& p : mesh.positions) {
    low = low.cwiseMin(p);
    high = high.cwiseMax(p);
  }
  const std::uint64_t n = mesh.size(), corners = 3 * mesh.triangles.size();
  Layout layout;
  ordered_json& positions = layout.add(12 * n, n, kFloat, "VEC3", kVertices);
  positions["min"] = {low.x(), low.y(), low.z()};
  positions["max"] = {high.x(), high.y(), high.z()};
  layout.add(12 * n, n, kFloat, "VEC3", kVertices);
  layout.add(8 * n, n, kUnsignedShort, "VEC4", kVertices)["normalized"] = true;
  layout.add(4 * corners, corners, kUnsignedInt, "SCALAR", kIndices);
  return layout;
}

std::string describe(const Layout& layout) {
  const double half = std::sqrt(0.5);  // a quarter turn about x: z up becomes y up
  const ordered_json primitive = {{"attributes", {{"POSITION", 0}, {"NORMAL", 1}, {"COLOR_0", 2}}},
                                  {"indices", 3},
                                  {"material", 0},
                                  {"mode", kTriangles}};
  const ordered_json surface = {
      {"baseColorFactor", {1, 1, 1, 1}}, {"metallicFactor", 0}, {"roughnessFactor", 1}};
  const ordered_json all = {
      {"asset", {{"version", "2.0"}, {"generator", "posefusion"}}},
      {"scene", 0},
      {"scenes", {{{"nodes", {0}}}}},
      {"nodes", {{{"mesh", 0}, {"rotation", {-half, 0, 0, half}}}}},
      {"meshes", {{{"primitives", {primitive}}}}},
      {"materials", {{{"pbrMetallicRoughness", surface}, {"doubleSided", true}}}},
      {"buffers", {{{"byteLength", layout.bytes}}}},
      {"bufferViews", layout.views},
      {"accessors", layout.accessors}};
  std::string text = all.dump();
  text.resize((text.size() + 3) / 4 * 4, ' ');
  return text;
}

template <typename T>
void writeAll(const std::vector<T>& values, std::ostream& out) {
  out.write(reinterpret_cast<const char*>(values.data()),
            static_cast<std::streamsize>(values.size() * sizeof(T)));
}

}  // namespace

void writeGlb(const TriangleMesh& mesh, std::ostream& out) {
  static_assert(sizeof(Eigen::Vector3f) == 12, "arrays of the mesh are written as they lie");
  if (mesh.positions.empty()) throw InputError("a mesh without vertices");
  const Layout layout = layoutOf(mesh);
  const std::string json = describe(layout);
  const std::uint64_t total = 12 + 8 + json.size() + 8 + layout.bytes;
  if (total > kMostBytes) {
    throw InputError("a mesh of " + std::to_string(mesh.triangles.size()) +
                     " triangles is too large for .glb (4 GB at most): expected .ply");
  }
  const auto word = [](std::uint64_t value) { return static_cast<std::uint32_t>(value); };
  writeAll<std::uint32_t>({kMagic, kVersion, word(total), word(json.size()), kJson}, out);
  out << json;
  writeAll<std::uint32_t>({word(layout.bytes), kBytes}, out);
  writeAll(mesh.positions, out);
  writeAll(mesh.normals, out);
  writeAll(linearColors(mesh), out);
  writeAll(mesh.triangles, out);
}

}  // namespace pf
