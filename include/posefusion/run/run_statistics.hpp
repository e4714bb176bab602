// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "posefusion/slam/pipeline.hpp"

namespace pf {

/// Frames of a run. Each is counted once besides `read`.
struct FrameCounts {
  std::size_t read = 0;      ///< all frames that the input gave
  std::size_t bad = 0;       ///< unreadable, of another size, stamps going back
  std::size_t blurred = 0;   ///< dropped by the gate
  std::size_t tracked = 0;   ///< tracked and, unless too blurred for it, fused
  std::size_t lost = 0;      ///< offered to tracking, and not believed
  std::size_t left_out = 0;  ///< never processed: live, the chain fell behind
  std::size_t posed = 0;     ///< located: tracked, or doubtful with a pose of their own
  std::map<std::string, std::size_t> by_state, by_outcome;  ///< of all that were read, by name

  double poseShare() const;       ///< posed / read; 0 of none
  double sharpPoseShare() const;  ///< posed / (read - blurred); 0 of none
};

/// What the masks of a run cover.
struct MaskCounts {
  std::size_t frames = 0;          ///< sharp frames
  std::size_t with_mask = 0;       ///< of them with a pixel of a person
  std::size_t over_1_percent = 0;  ///< of them with more than 1 % of the pixels
  double mean_part = 0;            ///< mean part of the pixels masked, over the sharp frames
};

/// Times of one stage over a run.
struct StageTime {
  double median_ms = 0;
  double p95_ms = 0;
  double p99_ms = 0, p999_ms = 0;  ///< of the frames, 99 and 99.9 % take no longer
  double most_ms = 0;
};

/// Counts and times of a run, frame by frame.
class RunStatistics {
 public:
  /// Times that are NaN are not known.
  void add(const ProcessedFrame& frame);

  /// A frame that no stage looked at; `outcome` says why, as one word.
  void addLeftOut(const std::string& outcome);

  const FrameCounts& frames() const { return frames_; }
  MaskCounts masks() const;

  /// A time that belongs to no frame: work beside the chain.
  void addTime(const char* stage, double ms);

  /// By stage: gate, pose (frames that the detector looked at), segmentation, tracking, fusion,
  /// tracking_and_fusion, their sum, loop_closing (what loops cost the tracking thread),
  /// loop_waiting (for answers), and what addTime() added.
  std::map<std::string, StageTime> stages() const;

  /// Times that the chain took for a frame, with what loops cost its thread, in each minute of the
  /// recording.
  std::vector<StageTime> minutes() const;

 private:
  void addMask(const ProcessedFrame& frame);
  void addTimes(const ProcessedFrame& frame);

  FrameCounts frames_;
  MaskCounts masks_;
  double mask_part_sum_ = 0;
  std::map<std::string, std::vector<double>> times_ms_;
  std::optional<std::int64_t> first_stamp_ns_;
  std::map<std::int64_t, std::vector<double>> minutes_ms_;  // by their number
};

/// Largest memory the process has had, megabytes.
double peakMemoryMb();

}  // namespace pf
