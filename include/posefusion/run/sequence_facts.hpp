// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string>

#include "posefusion/core/trajectory.hpp"
#include "posefusion/evaluation/track_check.hpp"

namespace pf {

/// The truth of a recording, as far as there is one.
struct SequenceTruth {
  Trajectory trajectory;
  TrackFacts facts;
};

/// Reads a TUM folder without its images (groundtruth.txt, the lists, and events.json where there
/// is one), or a trajectory alone (`path` is a file): then nothing is known of frames and events.
/// Throws InputError naming what is missing.
SequenceTruth loadSequenceTruth(const std::string& path);

}  // namespace pf
