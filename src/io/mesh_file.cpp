// SPDX-License-Identifier: BSD-3-Clause
#include "posefusion/io/mesh_file.hpp"

#include <array>
#include <cstdio>
#include <cstring>

#include "glb.hpp"
#include "posefusion/core/error.hpp"
#include "posefusion/io/files.hpp"
#include "posefusion/io/ply.hpp"

namespace pf {
namespace {

using Triangle = std::array<std::uint32_t, 3>;

constexpr std::size_t kFaceBytes = 1 + sizeof(Triangle);  // how many corners, then they

void writePly(const TriangleMesh& mesh, std::ostream& out) {
  out << plyHeader({{"vertex", mesh.size(), pointProperties()},
                    {"face", mesh.triangles.size(), {"list uchar int vertex_indices"}}},
                   "mesh of posefusion: map frame, metres");
  std::array<char, kPointBytes> vertex{};
  for (std::size_t i = 0; i < mesh.size(); ++i) {
    packPoint({mesh.positions[i], mesh.normals[i], mesh.colors[i]}, vertex.data());
    out.write(vertex.data(), vertex.size());
  }
  std::array<char, kFaceBytes> face{3};
  for (const Triangle& triangle : mesh.triangles) {
    std::memcpy(face.data() + 1, triangle.data(), sizeof triangle);
    out.write(face.data(), face.size());
  }
}

void writeObj(const TriangleMesh& mesh, std::ostream& out) {
  std::array<char, 160> line{};
  const auto write = [&](int length) { out.write(line.data(), length); };
  out << "# mesh of posefusion: map frame, metres\n";
  for (std::size_t i = 0; i < mesh.size(); ++i) {
    const Eigen::Vector3f &p = mesh.positions[i], &n = mesh.normals[i];
    const Eigen::Vector3f c = mesh.colors[i].cast<float>() / 255.0F;
    write(std::snprintf(line.data(), line.size(), "v %.4f %.4f %.4f %.3f %.3f %.3f\n", p.x(), p.y(),
                        p.z(), c.x(), c.y(), c.z()));
    write(std::snprintf(line.data(), line.size(), "vn %.3f %.3f %.3f\n", n.x(), n.y(), n.z()));
  }
  for (const Triangle& t : mesh.triangles) {
    const unsigned a = t[0] + 1, b = t[1] + 1, c = t[2] + 1;
    write(std::snprintf(line.data(), line.size(), "f %u//%u %u//%u %u//%u\n", a, a, b, b, c, c));
  }
}

/// Where the faces begin. Throws where the header describes other faces than saveMesh() writes.
std::size_t facesBegin(const std::string& text, const PlyVertices& vertices, std::size_t& count) {
  const std::string header = text.substr(0, vertices.begin);
  const std::size_t element = header.find("\nelement face ");
  const std::string lists = "\nproperty list uchar int vertex_indices\nend_header\n";
  if (element == std::string::npos || header.find(lists) == std::string::npos ||
      std::sscanf(header.c_str() + element, "\nelement face %zu", &count) != 1) {
    throw InputError("no faces of three corners");
  }
  return vertices.begin + vertices.count * vertices.bytes;
}

TriangleMesh readMesh(const std::string& text) {
  const PlyVertices vertices = readPlyHeader(text);
  TriangleMesh mesh;
  for (const SurfacePoint& point : readPoints(text, vertices)) {
    mesh.positions.push_back(point.position);
    mesh.normals.push_back(point.normal);
    mesh.colors.push_back(point.color);
  }
  std::size_t count = 0;
  const std::size_t begin = facesBegin(text, vertices, count);
  if ((text.size() - begin) / kFaceBytes < count) throw InputError("a file that is not whole");
  mesh.triangles.resize(count);
  for (std::size_t i = 0; i < count; ++i) {
    const char* face = &text[begin + i * kFaceBytes];
    std::memcpy(mesh.triangles[i].data(), face + 1, sizeof(Triangle));
    for (const std::uint32_t corner : mesh.triangles[i]) {
      if (face[0] != 3 || corner >= mesh.size()) throw InputError("a face that cannot be");
    }
  }
  return mesh;
}

}  // namespace

void requireMeshName(const std::string& path) { requireEnding(path, {".ply", ".obj", ".glb"}); }

void saveMesh(const std::string& path, const TriangleMesh& mesh) {
  requireMeshName(path);
  AtomicFile file(path);
  const std::string ending = endingOf(path);
  if (ending == ".ply") {
    writePly(mesh, file.stream());
  } else if (ending == ".obj") {
    writeObj(mesh, file.stream());
  } else {
    writeGlb(mesh, file.stream());
  }
  file.commit();
}

TriangleMesh loadMesh(const std::string& path) {
  const std::string text = readFile(path);
  try {
    return readMesh(text);
  } catch (const InputError& error) {
    throw InputError(path + ": has " + error.what() +
                     ", expected a mesh as binary little-endian PLY (posefusion_map mesh)");
  }
}

}  // namespace pf
