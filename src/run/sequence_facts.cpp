// SPDX-License-Identifier: BSD-3-Clause
#include "posefusion/run/sequence_facts.hpp"

#include <algorithm>
#include <filesystem>

#include "posefusion/core/error.hpp"
#include "posefusion/io/events_file.hpp"
#include "posefusion/io/frame_source.hpp"
#include "posefusion/io/trajectory_file.hpp"

namespace pf {

namespace fs = std::filesystem;

SequenceTruth loadSequenceTruth(const std::string& path) {
  SequenceTruth truth;
  if (!fs::is_directory(path)) {
    truth.trajectory = loadTrajectory(path);
    return truth;
  }
  const fs::path folder(path);
  if (!fs::exists(folder / "groundtruth.txt")) {
    throw InputError(path + ": has no groundtruth.txt, expected a sequence with true poses");
  }
  truth.trajectory = loadTrajectory(folder / "groundtruth.txt");
  truth.facts.frames_ns = listTumFrames(path);
  std::sort(truth.facts.frames_ns.begin(), truth.facts.frames_ns.end());
  if (!fs::exists(folder / "events.json")) return truth;
  truth.facts.blurred_ns = loadEvents(folder / "events.json").blurred_ns;
  return truth;
}

}  // namespace pf
