// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <cstddef>
#include <map>
#include <string>
#include <utility>
#include <vector>

namespace pf {

/// One point of a coloured surface: position (m), unit normal, colour R G B.
struct SurfacePoint {
  Eigen::Vector3f position = Eigen::Vector3f::Zero();
  Eigen::Vector3f normal = Eigen::Vector3f::Zero();
  Eigen::Matrix<unsigned char, 3, 1> color = Eigen::Matrix<unsigned char, 3, 1>::Zero();
};

/// The records of one kind in a PLY file.
struct PlyElement {
  std::string name;  ///< "vertex", "face"
  std::size_t count = 0;
  std::vector<std::string> properties;  ///< type and name, "float x", in the order of the bytes
};

/// All that comes before the records of a binary little-endian PLY file (G. Turk, "The PLY Polygon
/// File Format", 1994). `comment` may be empty.
std::string plyHeader(const std::vector<PlyElement>& elements, const std::string& comment = "");

/// A vertex as everything here writes it begins with a point in `kPointBytes` bytes.
constexpr std::size_t kPointBytes = 6 * sizeof(float) + 3;
std::vector<std::string> pointProperties();
void packPoint(const SurfacePoint& point, char* out);

/// Where the vertices lie in a PLY file, and the properties in a vertex.
struct PlyVertices {
  std::size_t count = 0;
  std::size_t begin = 0;  ///< of the first, bytes into the file
  std::size_t bytes = 0;  ///< of each
  std::map<std::string, std::pair<std::string, std::size_t>> properties;  ///< type, offset

  /// Bytes into a vertex. Throws InputError where there is no such property of that type.
  std::size_t offset(const std::string& name, const std::string& type) const;
};

/// Reads the header of a binary little-endian PLY file whose first element are vertices. Throws
/// InputError saying what it has instead.
PlyVertices readPlyHeader(const std::string& file);

/// Points from vertices with x y z nx ny nz (float) and red green blue (uchar); other properties
/// are passed over. Throws InputError where one is missing or `file` is too short.
std::vector<SurfacePoint> readPoints(const std::string& file, const PlyVertices& vertices);

/// Reads the points of a file: map.ply of a run, scene_points.ply of a simulated sequence. Throws
/// InputError naming the file.
std::vector<SurfacePoint> loadPoints(const std::string& path);

}  // namespace pf
