// SPDX-License-Identifier: BSD-3-Clause
#include "posefusion/grid/floor.hpp"

#include <algorithm>
#include <cmath>
#include <map>
#include <vector>

#include "posefusion/core/error.hpp"
#include "posefusion/core/symmetric.hpp"

namespace pf {
namespace {

using Eigen::Vector3d;

constexpr double kWide = 0.906, kNarrow = 0.985;  // 25 and 10 degrees
constexpr double kBin_m = 0.02, kThickness_m = 0.05;
constexpr double kShareOfLargest = 0.2;
constexpr std::size_t kLeastSurfels = 20;

struct FacingUp {
  std::vector<Vector3d> positions, normals;
};

FacingUp facing(const SurfelArrays& s, const Vector3d& up, double cosine) {
  FacingUp found;
  for (std::size_t i = 0; i < s.size(); ++i) {
    const Vector3d p(s.x[i], s.y[i], s.z[i]), n(s.nx[i], s.ny[i], s.nz[i]);
    if (!p.allFinite() || !n.allFinite() || n.dot(up) < cosine * n.norm()) continue;
    found.positions.push_back(p);
    found.normals.push_back(n);
  }
  if (found.positions.size() < kLeastSurfels) {
    throw InputError("the map has no floor: " + std::to_string(found.positions.size()) +
                     " stable surfels face up, expected at least " + std::to_string(kLeastSurfels));
  }
  return found;
}

/// Height of the lowest plane that is not small.
double lowestLevel(const FacingUp& found, const Vector3d& up) {
  std::map<long, std::size_t> bins;
  for (const Vector3d& p : found.positions) ++bins[std::lround(up.dot(p) / kBin_m)];
  const auto around = [&](long bin) {
    std::size_t sum = 0;
    for (long b = bin - 1; b <= bin + 1; ++b) {
      const auto at = bins.find(b);
      sum += at == bins.end() ? 0 : at->second;
    }
    return sum;
  };
  std::size_t most = 0;
  for (const auto& [bin, count] : bins) most = std::max(most, around(bin));
  for (auto at = bins.begin(); at != bins.end(); ++at) {
    const long bin = at->first;
    const bool is_peak = around(bin) >= around(bin + 1);
    if (is_peak && static_cast<double>(around(bin)) >= kShareOfLargest * static_cast<double>(most))
      return kBin_m * static_cast<double>(bin);
  }
  return 0;  // not reached: the largest is as large as itself
}

/// The plane through what lies around a level, as its normal and how high it is along that.
std::pair<Vector3d, double> fitted(const FacingUp& found, const Vector3d& up, double level) {
  Vector3d mean = Vector3d::Zero();
  std::vector<Vector3d> points;
  for (const Vector3d& p : found.positions) {
    if (std::abs(up.dot(p) - level) > kThickness_m) continue;
    points.push_back(p);
    mean += p;
  }
  mean /= static_cast<double>(points.size());
  Eigen::Matrix3d scatter = Eigen::Matrix3d::Zero();
  for (const Vector3d& p : points) scatter += (p - mean) * (p - mean).transpose();
  Vector3d normal = eigenOf(scatter).vectors.col(0);
  if (normal.dot(up) < 0) normal = -normal;
  // A floor of which little was seen does not give its tilt.
  if (normal.dot(up) < kNarrow) normal = up;
  return {normal, normal.dot(mean)};
}

}  // namespace

Eigen::Isometry3d floorFrame(const SurfelArrays& surfels) {
  Vector3d up = Vector3d::UnitZ();
  FacingUp found = facing(surfels, up, kWide);
  for (int round = 0; round < 3; ++round) {
    Vector3d sum = Vector3d::Zero();
    for (const Vector3d& n : found.normals) sum += n;
    up = sum.normalized();
    found = facing(surfels, up, kNarrow);
  }
  const auto [normal, height_m] = fitted(found, up, lowestLevel(found, up));
  Eigen::Isometry3d T_floor_map = Eigen::Isometry3d::Identity();
  T_floor_map.linear() =
      Eigen::Quaterniond::FromTwoVectors(normal, Vector3d::UnitZ()).toRotationMatrix();
  T_floor_map.translation().z() = -height_m;
  return T_floor_map;
}

}  // namespace pf
