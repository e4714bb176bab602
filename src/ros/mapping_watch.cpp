// SPDX-License-Identifier: BSD-3-Clause
#include "posefusion_ros/mapping_watch.hpp"

#include <cstdio>
#include <numeric>
#include <string>

#include "posefusion/map/surfel_map.hpp"
#include "posefusion_ros/calibration_store.hpp"

namespace posefusion_ros {
namespace {

using diagnostic_msgs::DiagnosticStatus;
using pf::TrackingState;

constexpr double kMegabyte = 1024.0 * 1024.0;

std::string secondsText(std::int64_t ns) {
  const std::string text = std::to_string(static_cast<double>(ns) * 1e-9);
  return text.substr(0, text.find('.') + 2);
}

void noteMap(const pf::FrameStatus& status, const MappingSession& session, StageWatch& watch) {
  const auto count = [&watch](const char* key, std::size_t value) {
    watch.set(key, std::to_string(value));
  };
  const pf::Mapper& mapper = session.mapper();
  const pf::LoopCounts& loops = session.loops().counts();
  count("surfels", status.surfels);
  count("surfel memory (MB)",
        static_cast<std::size_t>(static_cast<double>(mapper.map().memory()) / kMegabyte));
  count("inliers", static_cast<std::size_t>(std::max(0, status.tracking.inliers)));
  count("keyframes", mapper.backEnd().graph().keyframes().size());
  count("loops closed", mapper.backEnd().counts().accepted);
  count("loops refused", mapper.backEnd().counts().refused + loops.allRefused());
  count("loop questions waiting", session.loops().waiting());
  watch.set("oldest of them waits (s)",
            secondsText(static_cast<std::int64_t>(1e9 * session.loops().oldestWaitsS())));
  count("places searched", loops.searched);
  count("places found", loops.found);
}

void noteDepth(const MappingSession& session, StageWatch& watch) {
  const auto& calibration = session.mapper().calibration();
  const std::string by = session.correctedBy();
  char amount_mm[32] = "0.0";
  if (calibration) std::snprintf(amount_mm, sizeof amount_mm, "%.1f", errorAt2mMm(*calibration));
  watch.set("depth corrected by", by.empty() ? "nothing" : by);
  watch.set("depth learned anew", std::to_string(session.mapper().depthVersion()));
  watch.set("depth correction at 2 m (mm)", amount_mm);
}

void noteRobot(const char* name, const pf::MotionSourceReport& report, StageWatch& watch) {
  if (report.received == 0) return;
  const std::string prefix = std::string(name) + " ";
  watch.set(prefix + "believed", report.is_believed ? "yes" : "no");
  watch.set(prefix + "received", std::to_string(report.received));
  watch.set(prefix + "left out", std::to_string(report.left_out));
  if (report.left_out > 0) watch.set(prefix + "left out, why", report.why_left_out);
  watch.set(prefix + "motions told", std::to_string(report.told));
  watch.set(prefix + "motions missing", std::to_string(report.missing));
}

}  // namespace

void MappingWatch::note(const pf::FrameStatus& status, const MappingSession& session,
                        StageWatch& watch) {
  const bool is_lost = status.state == TrackingState::lost;
  if (!is_lost || found_ns_ > status.stamp_ns || found_ns_ == 0) found_ns_ = status.stamp_ns;
  const std::string lost_s = secondsText(status.stamp_ns - found_ns_);
  const std::string reason = reasonOf(status);
  if (status.is_other_camera) {
    watch.tell(DiagnosticStatus::ERROR,
               "lost for " + lost_s + " s: " + reason +
                   "; ~reset begins a new map with this camera; where that of the map comes back, "
                   "it is looked for in the map");
  } else if (is_lost) {
    watch.tell(DiagnosticStatus::ERROR, "lost for " + lost_s + " s: " + reason);
  } else if (status.state == TrackingState::doubtful) {
    watch.tell(DiagnosticStatus::WARN, "doubtful: " + reason);
  } else if (status.map_full) {
    watch.tell(DiagnosticStatus::WARN, "the map is full (map/memory_limit_mb)");
  } else {
    watch.tell(DiagnosticStatus::OK, "");
  }
  watch.set("state", std::string(name(status.state)));
  watch.set("lost for (s)", lost_s);
  noteMap(status, session, watch);
  noteDepth(session, watch);
  noteRobot("odometry", session.mapper().robot().odometry(), watch);
  noteRobot("imu", session.mapper().robot().imu(), watch);
}

}  // namespace posefusion_ros
