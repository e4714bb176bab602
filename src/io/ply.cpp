// SPDX-License-Identifier: BSD-3-Clause
#include "posefusion/io/ply.hpp"

#include <array>
#include <cstring>
#include <sstream>

#include "posefusion/core/error.hpp"
#include "posefusion/io/files.hpp"

namespace pf {
namespace {

std::size_t sizeOf(const std::string& type) {
  if (type == "uchar" || type == "char") return 1;
  if (type == "short" || type == "ushort") return 2;
  if (type == "float" || type == "int" || type == "uint") return 4;
  if (type == "double") return 8;
  throw InputError("a property of type '" + type + "'");
}

}  // namespace

std::string plyHeader(const std::vector<PlyElement>& elements, const std::string& comment) {
  std::string header = "ply\nformat binary_little_endian 1.0\n";
  if (!comment.empty()) header += "comment " + comment + "\n";
  for (const PlyElement& element : elements) {
    header += "element " + element.name + " " + std::to_string(element.count) + "\n";
    for (const auto& property : element.properties) header += "property " + property + "\n";
  }
  return header + "end_header\n";
}

std::vector<std::string> pointProperties() {
  return {"float x",  "float y",   "float z",     "float nx",  "float ny",
          "float nz", "uchar red", "uchar green", "uchar blue"};
}

void packPoint(const SurfacePoint& point, char* out) {
  constexpr std::size_t kSide = 3 * sizeof(float);
  std::memcpy(out, point.position.data(), kSide);
  std::memcpy(out + kSide, point.normal.data(), kSide);
  std::memcpy(out + 2 * kSide, point.color.data(), 3);
}

std::size_t PlyVertices::offset(const std::string& name, const std::string& type) const {
  const auto found = properties.find(name);
  if (found == properties.end() || found->second.first != type) {
    throw InputError("no property " + type + " " + name);
  }
  return found->second.second;
}

PlyVertices readPlyHeader(const std::string& text) {
  PlyVertices vertices;
  std::istringstream file(text.substr(0, 65536));
  std::string line, element;
  std::getline(file, line);
  if (line != "ply") throw InputError("no PLY");
  while (std::getline(file, line) && line != "end_header") {
    std::istringstream words(line);
    std::string word, type, name;
    words >> word >> type >> name;
    if (word == "format" && type != "binary_little_endian") throw InputError("format " + type);
    if (word == "element") {
      if (type == "vertex" && element.empty()) {
        if (!(std::istringstream(name) >> vertices.count))
          throw InputError("no number of vertices");
      }
      element = type;
    }
    if (word != "property" || element != "vertex") continue;
    vertices.properties[name] = {type, vertices.bytes};
    vertices.bytes += sizeOf(type);
  }
  if (line != "end_header" || file.eof()) throw InputError("a header without an end");
  vertices.begin = static_cast<std::size_t>(file.tellg());
  return vertices;
}

std::vector<SurfacePoint> readPoints(const std::string& text, const PlyVertices& vertices) {
  if (vertices.bytes == 0 || (text.size() - vertices.begin) / vertices.bytes < vertices.count) {
    throw InputError("a file that is not whole");
  }
  std::array<std::size_t, 6> floats{};
  std::array<std::size_t, 3> bytes{};
  const char* const float_names[] = {"x", "y", "z", "nx", "ny", "nz"};
  const char* const byte_names[] = {"red", "green", "blue"};
  for (std::size_t k = 0; k < 6; ++k) floats[k] = vertices.offset(float_names[k], "float");
  for (std::size_t k = 0; k < 3; ++k) bytes[k] = vertices.offset(byte_names[k], "uchar");
  std::vector<SurfacePoint> points(vertices.count);
  for (std::size_t i = 0; i < vertices.count; ++i) {
    const char* vertex = &text[vertices.begin + i * vertices.bytes];
    for (std::size_t k = 0; k < 3; ++k) {
      const auto axis = static_cast<Eigen::Index>(k);
      std::memcpy(&points[i].position[axis], vertex + floats[k], sizeof(float));
      std::memcpy(&points[i].normal[axis], vertex + floats[3 + k], sizeof(float));
      points[i].color[axis] = static_cast<unsigned char>(vertex[bytes[k]]);
    }
  }
  return points;
}

std::vector<SurfacePoint> loadPoints(const std::string& path) {
  const std::string text = readFile(path);
  try {
    return readPoints(text, readPlyHeader(text));
  } catch (const InputError& error) {
    throw InputError(path + ": has " + error.what() +
                     ", expected binary little-endian PLY with x y z nx ny nz red green blue");
  }
}

}  // namespace pf
