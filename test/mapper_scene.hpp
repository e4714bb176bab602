// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <gtest/gtest.h>

#include "posefusion/slam/mapper.hpp"
#include "simulated_sequence.hpp"

namespace pf {

/// A room without errors of a sensor, for a mapper.
class MapperTest : public ::testing::Test {
 protected:
  static Config config() {
    Config c;
    c.frame.shrink = 1;  // the images are small already
    return c;
  }
  static double errorM(const FrameStatus& status, const TrueFrame& truth) {
    return (status.T_map_camera.translation() - truth.T_map_camera.translation()).norm();
  }
  static RgbdFrame withDepth(const TrueFrame& from, const cv::Mat& depth) {
    RgbdFrame frame = from.frame;
    frame.depth = depth;
    return frame;
  }

  static const SimulatedSequence& room() { return exactBox<60>(); }
};

}  // namespace pf
