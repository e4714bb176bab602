// SPDX-License-Identifier: BSD-3-Clause
#include "posefusion/io/ply.hpp"

#include <cstring>
#include <sstream>

namespace pf {
namespace {

constexpr char kFormat[] = "ply\nformat binary_little_endian 1.0\n";
constexpr char kEnd[] = "end_header\n";

std::string propertyLines(const std::vector<std::string>& properties) {
  std::string lines;
  for (const auto& property : properties) lines += "property " + property + "\n";
  return lines;
}

}  // namespace

std::vector<std::string> PlyPoint::properties() {
  return {"float x",  "float y",   "float z",     "float nx",  "float ny",
          "float nz", "uchar red", "uchar green", "uchar blue"};
}

void PlyPoint::pack(char* out) const {
  std::memcpy(out, position.data(), sizeof position);
  std::memcpy(out + sizeof position, normal.data(), sizeof normal);
  std::memcpy(out + sizeof position + sizeof normal, color.data(), sizeof color);
}

PlyPoint PlyPoint::unpack(const char* in) {
  PlyPoint point;
  std::memcpy(point.position.data(), in, sizeof position);
  std::memcpy(point.normal.data(), in + sizeof position, sizeof normal);
  std::memcpy(point.color.data(), in + sizeof position + sizeof normal, sizeof color);
  return point;
}

std::string plyHeader(const std::vector<PlyElement>& elements, const std::string& comment) {
  std::string header = kFormat;
  if (!comment.empty()) header += "comment " + comment + "\n";
  for (const PlyElement& element : elements) {
    header += "element " + element.name + " " + std::to_string(element.count) + "\n";
    header += propertyLines(element.properties);
  }
  return header + kEnd;
}

std::optional<PlyVertices> findPlyVertices(const std::string& file,
                                           const std::vector<std::string>& properties) {
  const std::string element = "element vertex ", tail = propertyLines(properties) + kEnd;
  const auto at = file.find(element);
  const auto end = file.find(tail);
  if (file.rfind(kFormat, 0) != 0 || at == std::string::npos || end == std::string::npos) {
    return std::nullopt;
  }
  PlyVertices vertices;
  std::istringstream(file.substr(at + element.size(), 20)) >> vertices.count;
  vertices.begin = end + tail.size();
  return vertices;
}

}  // namespace pf
