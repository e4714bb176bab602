// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <array>
#include <cstddef>
#include <optional>
#include <string>
#include <vector>

namespace pf {

/// The records of one kind in a PLY file.
struct PlyElement {
  std::string name;  ///< "vertex", "face"
  std::size_t count = 0;
  std::vector<std::string> properties;  ///< type and name, "float x", in the order of the bytes
};

/// A point with a normal and a colour: the first 27 bytes of each vertex that is written here.
struct PlyPoint {
  std::array<float, 3> position{};  ///< metres
  std::array<float, 3> normal{};
  std::array<unsigned char, 3> color{};  ///< R G B

  static constexpr std::size_t kBytes = 6 * sizeof(float) + 3;
  static std::vector<std::string> properties();
  void pack(char* out) const;
  static PlyPoint unpack(const char* in);
};

/// All that comes before the records of a binary little-endian PLY file (G. Turk, "The PLY Polygon
/// File Format", 1994). `comment` may be empty.
std::string plyHeader(const std::vector<PlyElement>& elements, const std::string& comment = "");

/// Where the records of a file with vertices alone begin, and how many there are.
struct PlyVertices {
  std::size_t begin = 0;
  std::size_t count = 0;
};

/// Nothing where `file` does not begin with a header of vertices with just these properties.
std::optional<PlyVertices> findPlyVertices(const std::string& file,
                                           const std::vector<std::string>& properties);

}  // namespace pf
