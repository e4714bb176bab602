// SPDX-License-Identifier: BSD-3-Clause
#include "posefusion/io/cloud_file.hpp"

#include <algorithm>
#include <array>
#include <cmath>

#include "posefusion/core/error.hpp"
#include "posefusion/io/files.hpp"
#include "posefusion/io/map_file.hpp"

namespace pf {
namespace {

std::uint32_t colorByte(float value) {
  if (!std::isfinite(value)) return 128;
  return static_cast<std::uint32_t>(std::lround(std::clamp(value, 0.0F, 255.0F)));
}

void writePcd(const SurfelArrays& s, std::ostream& out) {
  const std::string count = std::to_string(s.size());
  out << "# .PCD v0.7 - Point Cloud Data file format\nVERSION 0.7\n"
         "FIELDS x y z normal_x normal_y normal_z rgb\nSIZE 4 4 4 4 4 4 4\n"
         "TYPE F F F F F F U\nCOUNT 1 1 1 1 1 1 1\nWIDTH "
      << count << "\nHEIGHT 1\nVIEWPOINT 0 0 0 1 0 0 0\nPOINTS " << count << "\nDATA binary\n";
  for (std::size_t i = 0; i < s.size(); ++i) {
    const std::array<float, 6> point = {s.x[i], s.y[i], s.z[i], s.nx[i], s.ny[i], s.nz[i]};
    const std::uint32_t rgb = colorByte(s.r[i]) << 16 | colorByte(s.g[i]) << 8 | colorByte(s.b[i]);
    out.write(reinterpret_cast<const char*>(point.data()), sizeof point);
    out.write(reinterpret_cast<const char*>(&rgb), sizeof rgb);
  }
}

}  // namespace

void requireCloudName(const std::string& path) { requireEnding(path, {".pcd", ".ply"}); }

void saveCloud(const std::string& path, const SurfelArrays& surfels) {
  requireCloudName(path);
  if (surfels.size() == 0) throw InputError(path + ": no points to write, expected some");
  if (endingOf(path) == ".ply") {
    saveSurfels(path, surfels);
    return;
  }
  AtomicFile file(path);
  writePcd(surfels, file.stream());
  file.commit();
}

}  // namespace pf
