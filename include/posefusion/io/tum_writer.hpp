// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <memory>
#include <opencv2/core.hpp>
#include <string>

#include "posefusion/core/frame.hpp"
#include "posefusion/core/trajectory.hpp"
#include "posefusion/pose/skeleton.hpp"

namespace pf {

/// Writes a sequence as a TUM folder, frame by frame: rgb/ depth/ [mask/] and, at finish(), rgb.txt
/// depth.txt associations.txt groundtruth.txt camera.yaml [people.json]. openTumFolder() reads it.
class TumWriter {
 public:
  /// Makes the folder. Depth is stored as 16-bit PNG, `depth_factor` steps in a metre. Throws
  /// InputError when something of that name is there that is not an empty folder.
  TumWriter(const std::string& folder, const PinholeCamera& camera, double depth_factor = 1000.0);
  ~TumWriter();

  /// Colour as PNG. Depth in metres (CV_32FC1) or CV_16UC1 in the frame's unit. The frame's camera
  /// has to be the writer's. Throws InputError naming the file that cannot be written.
  void add(const RgbdFrame& frame);
  /// The depth was taken at another moment than the colour.
  void add(const RgbdFrame& frame, std::int64_t depth_stamp_ns);

  /// True pose, mask (CV_8UC1, 255 = person) and people of a frame: call those that there are.
  void addTruth(const StampedPose& pose);
  void addMask(std::int64_t stamp_ns, const cv::Mat& mask);
  void addPeople(const People& people);

  /// Writes the lists. The frames so far are readable after each call.
  void finish();

 private:
  struct State;
  std::unique_ptr<State> state_;
};

}  // namespace pf
