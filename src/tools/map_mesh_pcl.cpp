// SPDX-License-Identifier: BSD-3-Clause
#include "map_mesh_pcl.hpp"

#include "posefusion/core/error.hpp"

#ifdef POSEFUSION_HAS_PCL_SURFACE

#include <pcl/conversions.h>
#include <pcl/search/kdtree.h>
#include <pcl/surface/gp3.h>
#include <pcl/surface/poisson.h>

#include <algorithm>
#include <cmath>

#include "posefusion/core/parallel.hpp"
#include "posefusion/core/point_grid.hpp"

namespace pf {
namespace {

using Eigen::Vector3f;
using Cloud = pcl::PointCloud<pcl::PointNormal>;

constexpr float kMostBridges = 1.4F;  // as surfelMesh()
constexpr int kLeastDepth = 6, kMostDepth = 12;
constexpr double kPoissonMargin = 1.1;  // its cube is so much larger than the surfels

Cloud::Ptr cloudOf(const SurfelArrays& s) {
  Cloud::Ptr cloud(new Cloud);
  for (std::size_t i = 0; i < s.size(); ++i) {
    pcl::PointNormal p;
    p.getVector3fMap() = Vector3f(s.x[i], s.y[i], s.z[i]);
    p.getNormalVector3fMap() = Vector3f(s.nx[i], s.ny[i], s.nz[i]);
    if (p.getVector3fMap().allFinite() && p.getNormalVector3fMap().allFinite()) {
      cloud->push_back(p);
    }
  }
  if (cloud->size() < 3) throw InputError("mesh: too few stable surfels, expected at least 3");
  return cloud;
}

unsigned char toByte(float value) {
  return static_cast<unsigned char>(std::isfinite(value) ? std::clamp(value, 0.0F, 255.0F) : 128);
}

/// Whether there is a surfel near a corner, and what it gives it.
bool paintCorner(const SurfelArrays& s, const PointGrid& grid, float reach, const Vector3f& at,
                 TriangleMesh& mesh, std::size_t corner) {
  float least = reach * reach;
  std::size_t nearest = s.size();
  const Vector3f half = Vector3f::Constant(reach);
  grid.visit({at - half, at + half}, [&](std::size_t k) {
    const float distance = (grid[k] - at).squaredNorm();
    if (distance >= least) return;
    least = distance;
    nearest = k;
  });
  if (nearest == s.size()) return false;
  mesh.normals[corner] = {s.nx[nearest], s.ny[nearest], s.nz[nearest]};
  mesh.colors[corner] = {toByte(s.r[nearest]), toByte(s.g[nearest]), toByte(s.b[nearest])};
  return true;
}

TriangleMesh painted(const pcl::PolygonMesh& polygons, const SurfelArrays& surfels, float reach) {
  pcl::PointCloud<pcl::PointXYZ> corners;
  pcl::fromPCLPointCloud2(polygons.cloud, corners);
  std::vector<Vector3f> centres;
  for (std::size_t i = 0; i < surfels.size(); ++i) {
    const Vector3f p(surfels.x[i], surfels.y[i], surfels.z[i]);
    centres.push_back(p.allFinite() ? p : Vector3f::Constant(9000));  // far from all others
  }
  const PointGrid grid(centres);
  TriangleMesh mesh;
  for (const auto& p : corners) mesh.positions.push_back(p.getVector3fMap());
  mesh.normals.resize(mesh.size());
  mesh.colors.resize(mesh.size());
  std::vector<char> near(mesh.size());
  parallelFor(mesh.size(), 1024, [&](std::size_t begin, std::size_t end) {
    for (std::size_t i = begin; i < end; ++i) {
      near[i] = paintCorner(surfels, grid, reach, mesh.positions[i], mesh, i) ? 1 : 0;
    }
  });
  std::vector<char> keep;
  for (const auto& polygon : polygons.polygons) {
    const auto& v = polygon.vertices;
    mesh.triangles.push_back({static_cast<std::uint32_t>(v[0]), static_cast<std::uint32_t>(v[1]),
                              static_cast<std::uint32_t>(v[2])});
    keep.push_back(near[v[0]] != 0 && near[v[1]] != 0 && near[v[2]] != 0 ? 1 : 0);
  }
  mesh = onlyKept(mesh, keep);
  if (mesh.triangles.empty()) throw InputError("mesh: PCL makes no triangle of these surfels");
  return mesh;
}

int depthFor(const Cloud& cloud, double cell_m) {
  Vector3f low = cloud.front().getVector3fMap(), high = low;
  for (const auto& p : cloud) {
    low = low.cwiseMin(p.getVector3fMap());
    high = high.cwiseMax(p.getVector3fMap());
  }
  const double cells = kPoissonMargin * (high - low).maxCoeff() / cell_m;
  return std::clamp(static_cast<int>(std::lround(std::log2(cells))), kLeastDepth, kMostDepth);
}

}  // namespace

TriangleMesh poissonMesh(const SurfelArrays& surfels, const MeshConfig& config) {
  const Cloud::Ptr cloud = cloudOf(surfels);
  pcl::Poisson<pcl::PointNormal> poisson;
  poisson.setDepth(depthFor(*cloud, config.cell_m));
  poisson.setInputCloud(cloud);
  pcl::PolygonMesh polygons;
  poisson.reconstruct(polygons);
  return painted(polygons, surfels, kMostBridges * static_cast<float>(config.bridge_m));
}

TriangleMesh greedyMesh(const SurfelArrays& surfels, const MeshConfig& config) {
  const Cloud::Ptr cloud = cloudOf(surfels);
  pcl::GreedyProjectionTriangulation<pcl::PointNormal> greedy;
  greedy.setSearchRadius(2 * config.bridge_m);
  greedy.setMu(2.5);
  greedy.setMaximumNearestNeighbors(100);
  greedy.setMaximumSurfaceAngle(M_PI / 4);
  greedy.setMinimumAngle(M_PI / 18);
  greedy.setMaximumAngle(2 * M_PI / 3);
  greedy.setNormalConsistency(true);
  greedy.setInputCloud(cloud);
  greedy.setSearchMethod(
      pcl::search::KdTree<pcl::PointNormal>::Ptr(new pcl::search::KdTree<pcl::PointNormal>));
  pcl::PolygonMesh polygons;
  greedy.reconstruct(polygons);
  return painted(polygons, surfels, kMostBridges * static_cast<float>(config.bridge_m));
}

}  // namespace pf

#else

namespace pf {
namespace {

[[noreturn]] void refuse() {
  throw InputError("--method: this was built without PCL (libpcl-dev), expected nets");
}

}  // namespace

TriangleMesh poissonMesh(const SurfelArrays&, const MeshConfig&) { refuse(); }
TriangleMesh greedyMesh(const SurfelArrays&, const MeshConfig&) { refuse(); }

}  // namespace pf

#endif
