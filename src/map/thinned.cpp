// SPDX-License-Identifier: BSD-3-Clause
#include "posefusion/map/thinned.hpp"

#include <Eigen/Core>
#include <array>
#include <cmath>
#include <map>

namespace pf {
namespace {

using Values = std::array<std::vector<float> SurfelArrays::*, 10>;
constexpr Values kMeans = {&SurfelArrays::x,     &SurfelArrays::y,  &SurfelArrays::z,
                           &SurfelArrays::nx,    &SurfelArrays::ny, &SurfelArrays::nz,
                           &SurfelArrays::r,     &SurfelArrays::g,  &SurfelArrays::b,
                           &SurfelArrays::radius};

struct Sum {
  Eigen::Array<double, kMeans.size(), 1> values = decltype(values)::Zero();
  double weight = 0;
  std::size_t first = 0;
};

}  // namespace

SurfelArrays thinned(const SurfelArrays& surfels, float voxel_m) {
  std::map<std::array<long, 3>, std::size_t> places;
  std::vector<Sum> sums;
  for (std::size_t i = 0; i < surfels.size(); ++i) {
    Sum one;
    for (std::size_t k = 0; k < kMeans.size(); ++k) {
      one.values[static_cast<Eigen::Index>(k)] = (surfels.*kMeans[k])[i];
    }
    if (!one.values.allFinite()) continue;
    std::array<long, 3> cube{};
    for (std::size_t k = 0; k < 3; ++k) {
      cube[k] = std::lround(std::floor((surfels.*kMeans[k])[i] / voxel_m));
    }
    const auto [place, is_new] = places.try_emplace(cube, sums.size());
    if (is_new) sums.emplace_back().first = i;
    const double weight =
        std::isfinite(surfels.weight[i]) && surfels.weight[i] > 1 ? surfels.weight[i] : 1.0;
    sums[place->second].values += weight * one.values;
    sums[place->second].weight += weight;
  }
  SurfelArrays out;
  for (const Sum& sum : sums) {
    const double normal = sum.values.segment<3>(3).matrix().norm();
    if (normal < 1e-3 * sum.weight) continue;
    const auto index = static_cast<std::uint32_t>(sum.first);
    out.append(surfels, &index, 1);
    for (std::size_t k = 0; k < kMeans.size(); ++k) {
      const double by = k >= 3 && k < 6 ? normal : sum.weight;
      (out.*kMeans[k]).back() = static_cast<float>(sum.values[static_cast<Eigen::Index>(k)] / by);
    }
  }
  return out;
}

}  // namespace pf
