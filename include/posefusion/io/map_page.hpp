// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <iosfwd>
#include <string>

#include "posefusion/mesh/config.hpp"
#include "posefusion/mesh/page_fit.hpp"

namespace pf {

/// What a map is shown as.
enum class PageKind { mesh, surfels };

struct MapPageConfig {
  PageKind kind = PageKind::mesh;
  MeshConfig mesh;
  double size_limit_mb = 12;  ///< of the file: a large map is shown with larger triangles
};

/// Throws InputError naming the first value that cannot be.
void validate(const MapPageConfig& config);

/// Throws InputError naming a file whose name does not end in .html.
void requirePageName(const std::string& path);

/// Writes one HTML page that turns the map in a browser (WebGL 2): it needs no other file and asks
/// no network for anything. `surfels`: stable ones, z up. `title`: as plain text. Under its
/// name when whole. Returns what it shows. Throws InputError naming the file, and where there is
/// nothing to show.
PageGeometry saveMapPage(const std::string& path, const SurfelArrays& surfels,
                         const std::string& title, const MapPageConfig& config);

/// The page of what was made already.
void writeMapPage(std::ostream& out, const PageGeometry& geometry, const std::string& title);

}  // namespace pf
