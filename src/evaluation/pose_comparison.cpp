// SPDX-License-Identifier: BSD-3-Clause
#include "posefusion/evaluation/pose_comparison.hpp"

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <utility>

#include "posefusion/core/error.hpp"
#include "posefusion/core/se3.hpp"

namespace pf {
namespace {

constexpr double kPathTolerance = 0.1;  ///< of a step's length: evo's, for motions that overlap

using IndexPairs = std::vector<std::pair<std::size_t, std::size_t>>;

std::size_t placeOf(const std::string& name, const std::vector<std::string>& words,
                    const char* what) {
  const auto found = std::find(words.begin(), words.end(), name);
  if (found != words.end()) return static_cast<std::size_t>(found - words.begin());
  std::string expected;
  for (const auto& word : words) expected += (expected.empty() ? "" : ", ") + word;
  throw InputError(std::string(what) + " is '" + name + "', expected one of " + expected);
}

/// The way of each estimated pose from the first one: frames, seconds, or metres.
std::vector<double> waysOf(const std::vector<PosePair>& pairs, const Alignment& alignment,
                           StepUnit unit) {
  std::vector<double> ways;
  for (std::size_t i = 0; i < pairs.size(); ++i) {
    if (unit == StepUnit::frames) {
      ways.push_back(static_cast<double>(i));
    } else if (unit == StepUnit::seconds) {
      ways.push_back(1e-9 *
                     static_cast<double>(pairs[i].estimate.stamp_ns - pairs[0].estimate.stamp_ns));
    } else {
      const Eigen::Vector3d before = pairs[i > 0 ? i - 1 : 0].estimate.T_world_camera.translation();
      const Eigen::Vector3d here = pairs[i].estimate.T_world_camera.translation();
      ways.push_back((ways.empty() ? 0 : ways.back()) + alignment.scale * (here - before).norm());
    }
  }
  return ways;
}

/// Each motion begins where the last one has ended: at the first pose that is far enough from
/// there.
IndexPairs consecutive(const std::vector<double>& ways, const Step& step) {
  IndexPairs motions;
  // evo's first motion of metres begins at the first pose that is that far from the start.
  std::size_t from = 0;
  bool begun = step.unit != StepUnit::metres;
  for (std::size_t i = 1; i < ways.size(); ++i) {
    if (ways[i] - ways[from] < step.length) continue;
    if (begun) motions.emplace_back(from, i);
    begun = true;
    from = i;
  }
  return motions;
}

/// From each pose to that whose way is nearest to the step's length farther.
IndexPairs overlapping(const std::vector<double>& ways, const Step& step) {
  IndexPairs motions;
  const bool is_metres = step.unit == StepUnit::metres;
  for (std::size_t i = 0; i + 1 < ways.size(); ++i) {
    const double wanted = ways[i] + step.length;
    const auto begin = ways.begin() + static_cast<std::ptrdiff_t>(i) + 1;
    auto at = std::lower_bound(begin, ways.end(), wanted);
    if (at == ways.end() || (at != begin && wanted - *(at - 1) <= *at - wanted)) --at;
    const auto j = static_cast<std::size_t>(at - ways.begin());
    if (j <= i) continue;
    const double off = std::abs(ways[j] - wanted);
    if (is_metres && off > kPathTolerance * step.length) continue;
    if (step.unit == StepUnit::frames && off > 0) continue;
    // The last pose is nearest to every time after the end.
    if (step.unit == StepUnit::seconds && j + 1 >= ways.size()) continue;
    motions.emplace_back(i, j);
  }
  return motions;
}

void requireStep(const Step& step) {
  const bool is_whole = step.unit != StepUnit::frames || step.length == std::floor(step.length);
  require(
      std::isfinite(step.length) && step.length > 0 && is_whole, "step", step.length,
      step.unit == StepUnit::frames ? "a whole number of frames, 1 or more" : "a length above 0");
}

PoseErrors sizesOf(const std::vector<Eigen::Isometry3d>& errors) {
  std::vector<double> distances, angles;
  for (const Eigen::Isometry3d& error : errors) {
    distances.push_back(error.translation().norm());
    angles.push_back(logSo3(error.linear()).norm() * kDegreesPerRadian);
  }
  return {statisticsOf(std::move(distances)), statisticsOf(std::move(angles))};
}

}  // namespace

const std::vector<std::string>& alignments() {
  static const std::vector<std::string> words = {"none",   "rigid", "similarity",
                                                 "origin", "se3",   "sim3"};
  return words;
}

AlignBy alignByNamed(const std::string& name) {
  const std::size_t place = placeOf(name, alignments(), "alignment");
  // evo's words are for the second and third.
  return static_cast<AlignBy>(place < 4 ? place : place - 3);
}

Alignment alignmentOf(const std::vector<PosePair>& pairs, AlignBy by) {
  if (by == AlignBy::rigid || by == AlignBy::similarity) {
    return align(pairs, by == AlignBy::similarity);
  }
  if (pairs.empty()) throw InputError("no estimated pose has a true one of its time");
  Alignment alignment;
  if (by == AlignBy::none) return alignment;
  const Eigen::Isometry3d T =
      pairs[0].truth.T_world_camera * pairs[0].estimate.T_world_camera.inverse();
  alignment.rotation = T.linear();
  alignment.translation = T.translation();
  return alignment;
}

const std::vector<std::string>& stepUnits() {
  static const std::vector<std::string> words = {"frames", "seconds", "metres"};
  return words;
}

StepUnit stepUnitNamed(const std::string& name) {
  return static_cast<StepUnit>(placeOf(name, stepUnits(), "unit"));
}

PoseErrors absolutePoseErrors(const std::vector<PosePair>& pairs, const Alignment& alignment) {
  std::vector<Eigen::Isometry3d> errors;
  for (const auto& [truth, estimate] : pairs) {
    const Eigen::Isometry3d found = alignment * estimate.T_world_camera;
    errors.push_back(truth.T_world_camera.inverse() * found);
  }
  return sizesOf(errors);
}

PoseErrors relativePoseErrors(const std::vector<PosePair>& pairs, const Alignment& alignment,
                              const Step& step) {
  requireStep(step);
  const std::vector<double> ways = waysOf(pairs, alignment, step.unit);
  std::vector<Eigen::Isometry3d> errors;
  for (const auto& [i, j] : step.overlapping ? overlapping(ways, step) : consecutive(ways, step)) {
    const Eigen::Isometry3d truth =
        pairs[i].truth.T_world_camera.inverse() * pairs[j].truth.T_world_camera;
    Eigen::Isometry3d moved =
        pairs[i].estimate.T_world_camera.inverse() * pairs[j].estimate.T_world_camera;
    moved.translation() *= alignment.scale;
    errors.push_back(truth.inverse() * moved);
  }
  return sizesOf(errors);
}

}  // namespace pf
