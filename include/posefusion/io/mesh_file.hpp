// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string>

#include "posefusion/mesh/triangle_mesh.hpp"

namespace pf {

/// Throws InputError naming a file whose name does not end in .ply, .obj or .glb.
void requireMeshName(const std::string& path);

/// Writes a mesh with normals and colours (metres, z up), in the format that the name ends in:
/// `.ply`: binary little-endian, vertices as a run's map.ply has them, faces of three. `.obj`:
/// Wavefront with colours behind the positions, as MeshLab and Blender read them. `.glb`: binary
/// glTF 2.0 (Khronos, 2017), whose node turns z up to its y up; colours are linear there. Under
/// its name when whole. Throws InputError naming the file.
void saveMesh(const std::string& path, const TriangleMesh& mesh);

/// Reads what saveMesh() writes as `.ply`. Throws InputError naming the file.
TriangleMesh loadMesh(const std::string& path);

}  // namespace pf
