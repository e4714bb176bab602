// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string>
#include <vector>

#include "posefusion/evaluation/metrics.hpp"

namespace pf {

/// Two trajectories as the tool evo compares them (M. Grupp, "evo: Python package for the
/// evaluation of odometry and SLAM", 2017): the same alignments, pairs and statistics.

/// What of the estimate is brought to the truth before their poses are compared.
enum class AlignBy {
  none,        ///< both are in one frame
  rigid,       ///< SE(3): the best fit of the positions
  similarity,  ///< Sim(3): with a scale, for systems without one
  origin       ///< the first pair's poses, laid on each other
};

/// The words for them: none, rigid, similarity, origin; evo's se3 and sim3 are known too.
const std::vector<std::string>& alignments();

/// By its word. Throws InputError for another one.
AlignBy alignByNamed(const std::string& name);

/// Throws InputError for too few pairs: three for a fit, else one.
Alignment alignmentOf(const std::vector<PosePair>& pairs, AlignBy by);

/// How far apart the poses of a motion are.
enum class StepUnit { frames, seconds, metres };

/// The words for them: frames, seconds, metres.
const std::vector<std::string>& stepUnits();

/// By its word. Throws InputError for another one.
StepUnit stepUnitNamed(const std::string& name);

struct Step {
  double length = 1;  ///< frames: a whole number
  StepUnit unit = StepUnit::frames;
  /// From each pose on, so that motions overlap; else from where the last one has ended.
  bool overlapping = false;
};

/// Errors of poses or of motions.
struct PoseErrors {
  ErrorStatistics translation_m;
  ErrorStatistics rotation_deg;
};

/// Of each pose, aligned: the distance of the positions, the angle between the directions.
PoseErrors absolutePoseErrors(const std::vector<PosePair>& pairs, const Alignment& alignment);

/// Of the motions between pairs: of Q^-1 P, where Q is the true and P the estimated motion. Metres
/// are measured along the estimate; motions of seconds end at the pose nearest to that time, as in
/// TUM's tool, and none at the last. Throws InputError for a step that is none.
PoseErrors relativePoseErrors(const std::vector<PosePair>& pairs, const Alignment& alignment,
                              const Step& step);

}  // namespace pf
