// SPDX-License-Identifier: BSD-3-Clause
#include "posefusion/run/run_report.hpp"

#include <iomanip>
#include <sstream>
#include <utility>

#include "posefusion/evaluation/track_check.hpp"
#include "posefusion/io/files.hpp"
#include "posefusion/io/images.hpp"
#include "posefusion/io/map_file.hpp"
#include "posefusion/io/trajectory_file.hpp"
#include "posefusion/run/map_picture.hpp"
#include "summary_parts.hpp"

namespace pf {
namespace {

using nlohmann::ordered_json;

std::string fixed(double value, int decimals) {
  std::ostringstream out;
  out << std::fixed << std::setprecision(decimals) << value;
  return out.str();
}

}  // namespace

void RunReport::add(const ProcessedFrame& frame) {
  seconds_ += 1e-3 * watch_.lapMs();
  statistics_.add(frame);
  strip_.add(frame);
  if (frame.status.outcome != FrameOutcome::bad_input) {
    frames_ns_.push_back(frame.status.stamp_ns);
  }
  if (!frame.status.located) return;
  camera_ = frame.seen.frame.camera;
  trajectory_.push_back({frame.status.stamp_ns, frame.status.T_map_camera});
}

void RunReport::setBackEnd(const BackEnd& back_end, const LoopCounts& loops) {
  live_ = std::exchange(trajectory_, back_end.trajectory());
  loops_ = loops;
  corrections_ = back_end.counts();
}

void RunReport::setCorrected(const Trajectory& trajectory) {
  live_ = std::exchange(trajectory_, trajectory);
  ran_elsewhere_ = true;
}

double RunReport::framesPerSecond() const {
  return seconds_ > 0 ? static_cast<double>(statistics_.frames().read) / seconds_ : 0.0;
}

std::optional<RunErrors> RunReport::errors() const {
  const auto pairs = matchPoses(truth_, trajectory_);
  if (pairs.size() < 3) return std::nullopt;
  RunErrors errors;
  const Alignment alignment = align(pairs, false);
  errors.ate_m = absoluteError(pairs, alignment);
  errors.held_m = heldError(truth_, trajectory_, frames_ns_, alignment);
  errors.wrong = wrongPoses(truth_, trajectory_).size();
  errors.per_second = relativeErrorPerSecond(truth_, trajectory_);
  errors.false_count = placeErrors(truth_, trajectory_).false_count;
  return errors;
}

std::optional<LiveErrors> RunReport::liveErrors() const {
  const auto pairs = matchPoses(truth_, live_);
  if (pairs.size() < 3) return std::nullopt;
  return LiveErrors{absoluteError(pairs, align(pairs, false)), wrongPoses(truth_, live_).size(),
                    placeErrors(truth_, live_).false_count};
}

std::string RunReport::summary(std::size_t surfels) const {
  const MaskCounts masks = statistics_.masks();
  ordered_json out;
  out["version"] = POSEFUSION_VERSION;
  out["frames"] = framesJson(statistics_.frames());
  out["masks"] = {{"frames", masks.with_mask},
                  {"frames_over_1_percent", masks.over_1_percent},
                  {"mean_part", masks.mean_part}};
  out["surfels"] = surfels;
  if (color_) out["color"] = colorJson(*color_, config_.calibration.registersColor());
  if (!ran_elsewhere_) out["loops"] = loopsJson(loops_, corrections_);
  out["frames_per_second"] = framesPerSecond();
  if (!ran_elsewhere_) out["peak_memory_mb"] = peakMemoryMb();
  if (const auto e = errors()) {
    out["ate_rmse_m"] = e->ate_m.rmse;
    out["ate_held_rmse_m"] = e->held_m.rmse;
    out["wrong_poses"] = e->wrong;
    out["false_poses"] = e->false_count;
    if (e->per_second.translation_m.count > 0) {
      out["rpe_trans_m_per_s"] = e->per_second.translation_m.rmse;
      out["rpe_rot_deg_per_s"] = e->per_second.rotation_deg.rmse;
    }
  }
  if (const auto live = liveErrors()) {
    out["live"] = {{"ate_rmse_m", live->ate_m.rmse},
                   {"wrong_poses", live->wrong},
                   {"false_poses", live->false_count}};
  }
  if (depth_difference_m_) out["depth_median_difference_m"] = *depth_difference_m_;
  for (const auto& [name, time] : statistics_.stages()) {
    out["stages"][name] = timesJson(time);
  }
  out["by_minute"] = ordered_json::array();
  for (const StageTime& time : statistics_.minutes()) out["by_minute"].push_back(timesJson(time));
  out["configuration"] = configurationJson(config_);
  return out.dump(2) + "\n";
}

void RunReport::writeTrajectories(const std::string& folder,
                                  const Eigen::Isometry3d& T_world_map) const {
  saveTrajectory(
      folder + "/trajectory.txt", inWorld(T_world_map, trajectory_),
      "pose of the camera (optical frame: z forward, x right, y down) in the map (z up)");
  if (live_.empty()) return;
  saveTrajectory(folder + "/trajectory_live.txt", inWorld(T_world_map, live_),
                 "pose of the camera (optical frame: z forward, x right, y down) in the map (z "
                 "up), as reported when the frame came: loops found later do not correct it");
}

void RunReport::writeSummary(const std::string& folder, std::size_t surfels) const {
  AtomicFile file(folder + "/summary.json");
  file.stream() << summary(surfels);
  file.commit();
}

void RunReport::writePictures(const std::string& folder, const SurfelMap& map) const {
  const cv::Mat picture = drawMap(map, trajectory_, camera_);
  if (!picture.empty()) savePng(folder + "/map.png", picture);
  const cv::Mat strip = strip_.draw();
  if (!strip.empty()) savePng(folder + "/people.png", strip);
}

std::string RunReport::errorLines() const {
  const auto e = errors();
  if (!e) return {};
  std::ostringstream out;
  out << "ATE      " << fixed(e->ate_m.rmse, 4) << " m RMSE over " << e->ate_m.count << " poses, "
      << fixed(e->held_m.rmse, 4) << " m with the last pose held where there is none\n"
      << "wrong    " << e->wrong
      << " poses (motion over a second off by more than 0.10 m or 5 deg)\n"
      << "false    " << e->false_count << " poses (off by as much, aligned on the first second)\n";
  if (const auto live = liveErrors()) {
    out << "live     ATE " << fixed(live->ate_m.rmse, 4) << " m, " << live->wrong << " wrong, "
        << live->false_count
        << " false, as reported at the time; the above is as corrected in the end\n";
  }
  out << "RPE      " << fixed(e->per_second.translation_m.rmse, 4) << " m/s, "
      << fixed(e->per_second.rotation_deg.rmse, 3) << " deg/s RMSE\n";
  return out.str();
}

std::string RunReport::table() const {
  const FrameCounts& f = statistics_.frames();
  std::ostringstream out;
  out << "frames   " << f.read << " read, " << f.tracked << " tracked, " << f.lost << " lost, "
      << f.blurred << " blurred, " << f.bad << " bad";
  if (f.left_out > 0) out << ", " << f.left_out << " left out";
  out << "\n";
  out << "poses    " << fixed(100 * f.poseShare(), 2) << " % of the frames, "
      << fixed(100 * f.sharpPoseShare(), 2) << " % of those not blurred\n";
  out << "speed    " << fixed(framesPerSecond(), 1) << " frames per second\n";
  for (const auto& [name, time] : statistics_.stages()) {
    out << "         " << std::left << std::setw(20) << name << std::right << std::setw(7)
        << fixed(time.median_ms, 1) << " ms median" << std::setw(7) << fixed(time.p95_ms, 1)
        << " ms 95 %" << std::setw(8) << fixed(time.most_ms, 1) << " ms most\n";
  }
  if (color_) out << colorLine(*color_, config_.calibration.registersColor());
  if (loops_.keyframes > 0) {
    out << "loops    " << loops_.keyframes << " keyframes, " << loops_.accepted << " loops, "
        << corrections_.accepted << " corrections; " << loops_.found << " of " << loops_.searched
        << " lost frames found\n";
  }
  out << errorLines();
  if (depth_difference_m_) {
    out << "depth    " << fixed(1e3 * *depth_difference_m_, 2) << " mm median against the map\n";
  }
  return out.str();
}

}  // namespace pf
