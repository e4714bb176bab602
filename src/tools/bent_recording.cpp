// SPDX-License-Identifier: BSD-3-Clause
#include "bent_recording.hpp"

#include <cmath>
#include <filesystem>
#include <opencv2/imgcodecs.hpp>

#include "posefusion/core/error.hpp"
#include "posefusion/core/se3.hpp"
#include "posefusion/core/stamps.hpp"
#include "posefusion/evaluation/metrics.hpp"
#include "posefusion/io/frame_source.hpp"

namespace pf {
namespace {

constexpr double kElsewhere_m = 0.7, kElsewhere_rad = 0.7;
constexpr double kLeastGap = 0.06, kMostGap = 0.5;  // part of the picture's width
constexpr double kMasked = 0.6;  // part of the frames in which people are taken out

}  // namespace

Bend::Bend(const BendOptions& options, std::mt19937& chance) : options_(options) {
  std::uniform_real_distribution<double> phase(0.0, 2 * M_PI);
  for (double& p : phases_) p = phase(chance);
}

Eigen::Isometry3d Bend::at(double seconds) const {
  Vector6d twist;
  for (int i = 0; i < 6; ++i) {
    const double size = i < 3 ? options_.shift_m : options_.turn_rad;
    const double slower = 1.0 + 0.2 * i;
    twist[i] = size / std::sqrt(3.0) *
               std::sin(2 * M_PI * seconds / (slower * options_.period_s) +
                        phases_[static_cast<std::size_t>(i)]);
  }
  return expSe3(twist);
}

BentRecording::BentRecording(const std::string& sequence, const BendOptions& bend,
                             std::mt19937& chance)
    : sequence_(sequence),
      chance_(chance),
      bend_(bend, chance),
      truth_(openTumFolder(sequence)->truth()),
      frames_(listTumFrames(sequence).size()) {
  if (truth_.empty()) throw InputError(sequence + ": has no true poses");
}

void BentRecording::forEach(const std::function<bool(std::size_t)>& isWanted,
                            const std::function<void(std::size_t, const TrueFrame&)>& use) {
  const auto source = openTumFolder(sequence_);
  TrueFrame out;
  for (std::size_t index = 0; auto read = source->next(); ++index) {
    const std::int64_t stamp_ns = read->frame.stamp_ns;
    const auto pose = poseAt(truth_, stamp_ns);
    if (!isWanted(index) || !read->defect.empty() || !pose) continue;
    out.T_map_camera = *pose * bend_.at(secondsBetween(truth_.front().stamp_ns, stamp_ns));
    prepare(read->frame, out);
    use(index, out);
  }
}

void BentRecording::prepare(RgbdFrame& frame, TrueFrame& out) {
  const cv::Mat mask = maskOf(frame.stamp_ns, out.is_masked);
  if (!mask.empty()) frame.depth.setTo(0, mask > 0);
  out.frame.assign(frame, mask, FrameConfig{});
  RgbdFrame changed = frame;
  changed.depth = frame.depth.clone();
  leaveGap(changed.depth);
  out.through_gap.assign(changed, mask, FrameConfig{});
  repaint(frame, out.T_map_camera);
  out.repainted.assign(frame, mask, FrameConfig{});
}

cv::Mat BentRecording::maskOf(std::int64_t stamp_ns, bool& is_masked) {
  const auto path = std::filesystem::path(sequence_) / "mask" / (formatStamp(stamp_ns) + ".png");
  is_masked = all_masked_ || std::uniform_real_distribution<double>()(chance_) < kMasked;
  if (!is_masked || !std::filesystem::exists(path)) return {};
  return cv::imread(path.string(), cv::IMREAD_GRAYSCALE);
}

/// Covers all but an upright gap.
void BentRecording::leaveGap(cv::Mat& depth) {
  std::uniform_real_distribution<double> width(kLeastGap, kMostGap), place;
  const int open = static_cast<int>(width(chance_) * depth.cols);
  const int from = static_cast<int>(place(chance_) * (depth.cols - open));
  depth.colRange(0, from).setTo(0);
  depth.colRange(from + open, depth.cols).setTo(0);
}

void BentRecording::repaint(RgbdFrame& frame, const Eigen::Isometry3d& T_map_camera) {
  const bool is_elsewhere =
      !isWithin(T_seen_.inverse() * T_map_camera, kElsewhere_m, kElsewhere_rad);
  if (color_.empty() || is_elsewhere) {
    other_color_ = color_.empty() ? frame.color : color_;
    color_ = frame.color;
    T_seen_ = T_map_camera;
  }
  frame.color = other_color_;
}

}  // namespace pf
