// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>

#include "posefusion_ros/mapping_session.hpp"
#include "posefusion_ros/stage_watch.hpp"

namespace posefusion_ros {

/// What /diagnostics reports of tracking, map and loops: state and, while lost, since when (by the
/// stamps); surfels and their memory; keyframes, loops and places; what depth is corrected by.
/// DOUBTFUL is WARN, LOST is ERROR.
class MappingWatch {
 public:
  /// After each frame that reached the mapper.
  void note(const pf::FrameStatus& status, const MappingSession& session, StageWatch& watch);

 private:
  std::int64_t found_ns_ = 0;  // the last frame that was not lost
};

}  // namespace posefusion_ros
