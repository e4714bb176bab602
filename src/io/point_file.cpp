// SPDX-License-Identifier: BSD-3-Clause
#include "posefusion/io/point_file.hpp"

#include <array>
#include <cstring>
#include <map>
#include <sstream>
#include <utility>

#include "posefusion/core/error.hpp"
#include "posefusion/io/files.hpp"

namespace pf {
namespace {

/// Where the vertices lie in the file, and the properties in a vertex.
struct Layout {
  std::size_t count = 0, begin = 0, bytes = 0;
  std::map<std::string, std::pair<std::string, std::size_t>> properties;  ///< type, offset

  std::size_t offset(const std::string& name, const std::string& type) const {
    const auto found = properties.find(name);
    if (found == properties.end() || found->second.first != type) {
      throw InputError("no property " + type + " " + name);
    }
    return found->second.second;
  }
};

std::size_t sizeOf(const std::string& type) {
  if (type == "uchar" || type == "char") return 1;
  if (type == "short" || type == "ushort") return 2;
  if (type == "float" || type == "int" || type == "uint") return 4;
  if (type == "double") return 8;
  throw InputError("a property of type '" + type + "'");
}

Layout readHeader(const std::string& text) {
  Layout layout;
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
        if (!(std::istringstream(name) >> layout.count)) throw InputError("no number of vertices");
      }
      element = type;
    }
    if (word != "property" || element != "vertex") continue;
    layout.properties[name] = {type, layout.bytes};
    layout.bytes += sizeOf(type);
  }
  if (line != "end_header") throw InputError("a header without an end");
  layout.begin = static_cast<std::size_t>(file.tellg());
  if (layout.bytes == 0 || (text.size() - layout.begin) / layout.bytes < layout.count) {
    throw InputError("a file that is not whole");
  }
  return layout;
}

std::vector<SurfacePoint> readPoints(const std::string& text) {
  const Layout layout = readHeader(text);
  std::array<std::size_t, 6> floats{};
  std::array<std::size_t, 3> bytes{};
  const char* const float_names[] = {"x", "y", "z", "nx", "ny", "nz"};
  const char* const byte_names[] = {"red", "green", "blue"};
  for (std::size_t k = 0; k < 6; ++k) floats[k] = layout.offset(float_names[k], "float");
  for (std::size_t k = 0; k < 3; ++k) bytes[k] = layout.offset(byte_names[k], "uchar");
  std::vector<SurfacePoint> points(layout.count);
  for (std::size_t i = 0; i < layout.count; ++i) {
    const char* vertex = &text[layout.begin + i * layout.bytes];
    for (std::size_t k = 0; k < 3; ++k) {
      const auto axis = static_cast<Eigen::Index>(k);
      std::memcpy(&points[i].position[axis], vertex + floats[k], sizeof(float));
      std::memcpy(&points[i].normal[axis], vertex + floats[3 + k], sizeof(float));
      points[i].color[axis] = static_cast<unsigned char>(vertex[bytes[k]]);
    }
  }
  return points;
}

}  // namespace

std::vector<SurfacePoint> loadPoints(const std::string& path) {
  const std::string text = readFile(path);
  try {
    return readPoints(text);
  } catch (const InputError& error) {
    throw InputError(path + ": has " + error.what() +
                     ", expected binary little-endian PLY with x y z nx ny nz red green blue");
  }
}

}  // namespace pf
