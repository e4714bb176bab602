// SPDX-License-Identifier: BSD-3-Clause
#include "simulator/thing.hpp"

#include <utility>

namespace pf::simulator {

Eigen::Isometry3d ThingPose::matrix() const {
  Eigen::Isometry3d T = Eigen::Isometry3d::Identity();
  T.translation() = at_m;
  T.linear() = Eigen::AngleAxisd(yaw_rad, Eigen::Vector3d::UnitZ()).toRotationMatrix();
  return T;
}

ThingPose interpolate(const ThingPose& a, const ThingPose& b, double t) {
  return {a.at_m + t * (b.at_m - a.at_m), a.yaw_rad + t * (b.yaw_rad - a.yaw_rad)};
}

ThingShape makeThing(World& world, const ObjectSpec& spec) {
  ObjectSpec at_origin = spec;
  at_origin.at_m.setZero();
  at_origin.yaw_rad = 0.0;
  ThingShape shape;
  const std::size_t footprints = world.footprints.size();
  std::swap(world.mesh, shape.mesh);
  addObject(world, at_origin);
  std::swap(world.mesh, shape.mesh);
  world.footprints.resize(footprints);
  for (const auto& p : shape.mesh.positions) shape.box.extend(p.cast<double>());
  return shape;
}

void append(const Mesh& thing, const ThingPose& pose, Mesh& mesh) {
  const Eigen::Isometry3f T = pose.matrix().cast<float>();
  const auto first = static_cast<std::uint32_t>(mesh.positions.size());
  for (const auto& p : thing.positions) mesh.positions.push_back(T * p);
  for (const auto& n : thing.normals) mesh.normals.push_back(T.linear() * n);
  for (const auto& t : thing.triangles) {
    mesh.triangles.push_back({first + t[0], first + t[1], first + t[2]});
  }
  mesh.uv.insert(mesh.uv.end(), thing.uv.begin(), thing.uv.end());
  mesh.materials.insert(mesh.materials.end(), thing.materials.begin(), thing.materials.end());
}

}  // namespace pf::simulator
