// SPDX-License-Identifier: BSD-3-Clause
#include "graph_checks.hpp"

#include <cmath>
#include <stdexcept>
#include <string>

#include "posefusion/core/error.hpp"
#include "posefusion/core/se3.hpp"
#include "posefusion/core/symmetric.hpp"

namespace pf {
namespace {

/// A retired keyframe follows one in use, of its fragment.
void throwUnlessCarried(const Keyframe& k, const std::vector<Keyframe>& keyframes) {
  if (!k.isRetired()) return;
  const auto carrier = static_cast<std::size_t>(k.follows);
  if (carrier < keyframes.size() && !keyframes[carrier].isRetired() &&
      keyframes[carrier].fragment == k.fragment) {
    return;
  }
  throw std::invalid_argument("keyframe " + std::to_string(k.id) + ": follows " +
                              std::to_string(k.follows) +
                              ", expected a keyframe in use of the same fragment");
}

}  // namespace

void throwUnlessUsable(const Keyframe& keyframe) {
  const std::string name = "keyframe " + std::to_string(keyframe.id);
  if (!isRigid(keyframe.T_map_camera)) {
    throw std::invalid_argument(name + ": the pose is no rigid motion");
  }
  if (keyframe.fragment < 0) {
    throw std::invalid_argument(name + ": fragment is " + std::to_string(keyframe.fragment) +
                                ", expected 0 or more");
  }
}

void throwUnlessUsable(const PoseConstraint& c) {
  const std::string name = "constraint " + std::to_string(c.from) + " -> " + std::to_string(c.to);
  if (!isRigid(c.T_from_to)) throw std::invalid_argument(name + ": no rigid motion");
  if (!isPositiveDefinite(c.covariance)) {
    throw std::invalid_argument(name + ": the covariance is not positive definite");
  }
}

void throwUnlessBetween(const PoseConstraint& c, std::size_t keyframes) {
  const auto known = [&](int id) { return id >= 0 && static_cast<std::size_t>(id) < keyframes; };
  if (known(c.from) && known(c.to) && c.from != c.to) return;
  throw std::invalid_argument("constraint " + std::to_string(c.from) + " -> " +
                              std::to_string(c.to) + ": expected two different ones of " +
                              std::to_string(keyframes) + " keyframes");
}

void checkGraph(const std::vector<Keyframe>& keyframes,
                const std::vector<PoseConstraint>& constraints, int version) {
  try {
    for (std::size_t i = 0; i < keyframes.size(); ++i) {
      if (keyframes[i].id != static_cast<int>(i)) {
        throw std::invalid_argument("keyframe " + std::to_string(i) + ": its id is " +
                                    std::to_string(keyframes[i].id));
      }
      throwUnlessUsable(keyframes[i]);
      if (keyframes[i].fragment >= static_cast<int>(keyframes.size())) {
        throw std::invalid_argument("keyframe " + std::to_string(i) + ": fragment is " +
                                    std::to_string(keyframes[i].fragment) +
                                    ", expected less than the number of keyframes");
      }
    }
    for (const Keyframe& k : keyframes) throwUnlessCarried(k, keyframes);
    for (const PoseConstraint& c : constraints) {
      throwUnlessBetween(c, keyframes.size());
      throwUnlessUsable(c);
      for (const int end : {c.from, c.to}) {
        if (!keyframes[static_cast<std::size_t>(end)].isRetired()) continue;
        throw std::invalid_argument("constraint " + std::to_string(c.from) + " -> " +
                                    std::to_string(c.to) + ": ends at a retired keyframe");
      }
    }
  } catch (const std::invalid_argument& error) {
    throw InputError(error.what());
  }
  if (version < 0) {
    throw InputError("version of the graph is " + std::to_string(version) + ", expected 0 or more");
  }
}

}  // namespace pf
