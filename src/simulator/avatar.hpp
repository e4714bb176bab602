// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <array>
#include <vector>

#include "posefusion/mesh/surface_nets.hpp"
#include "simulator/body_shape.hpp"
#include "simulator/outfit.hpp"
#include "simulator/rig.hpp"

namespace pf::simulator {

/// A skinned person: one closed surface each for the clothed body, the head and the hands, with up
/// to four bones for each vertex.
class Avatar {
 public:
  /// `coarseness` times the usual length of a triangle: 1 for pictures, 2 for depth at 160x120.
  Avatar(const Build& build, const Outfit& outfit, float coarseness = 1.0F);

  struct Influence {
    std::array<std::uint8_t, 4> bone{};
    std::array<float, 4> weight{};
  };

  const Rig& rig() const { return rig_; }
  const Appearance& appearance() const { return appearance_; }
  std::size_t vertexCount() const { return rest_.size(); }
  const std::vector<std::array<std::uint32_t, 3>>& triangles() const { return triangles_; }
  const std::vector<Eigen::Vector3f>& rest() const { return rest_; }
  const std::vector<Eigen::Vector3f>& restNormals() const { return normals_; }
  const std::vector<float>& openness() const { return openness_; }  ///< 0 in folds .. 1
  BodyPart partOf(std::uint32_t triangle) const;

  /// The point of the surface with barycentric coordinates u, v in a triangle.
  SurfacePoint surfacePoint(std::uint32_t triangle, float u, float v) const;

  /// Linear blend skinning of all vertices: x y z into `positions`.
  void skin(const Posture& posture, float* positions) const;
  void skinNormals(const Posture& posture, std::vector<Eigen::Vector3f>& normals) const;

 private:
  void add(const TriangleMesh& part, const std::vector<Blob>& blobs,
           const std::function<float(const Eigen::Vector3f&)>& distance);
  void addHead(const Outfit& outfit, float cell_m);
  void addHands(float cell_m);
  void addBurden();
  static void bind(const Eigen::Vector3f& p, const std::vector<Blob>& blobs, Influence& influence);

  Rig rig_;
  Appearance appearance_;
  std::vector<Eigen::Vector3f> rest_, normals_;
  std::vector<float> openness_, hair_tag_;
  std::vector<Influence> influences_;
  std::vector<std::array<std::uint32_t, 3>> triangles_;
  std::uint32_t first_head_ = 0, first_hand_ = 0, first_burden_ = 0;  ///< triangles
};

}  // namespace pf::simulator
