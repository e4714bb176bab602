// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <ostream>

#include "posefusion/mesh/triangle_mesh.hpp"

namespace pf {

/// A mesh with normals and colours as binary glTF 2.0: one JSON chunk, one chunk of bytes. Throws
/// InputError where it has more bytes than the format's 32 bits count.
void writeGlb(const TriangleMesh& mesh, std::ostream& out);

}  // namespace pf
