// SPDX-License-Identifier: BSD-3-Clause
// A small room that is mapped, saved and continued: mapper, loop closer and file together.
#pragma once

#include <gtest/gtest.h>

#include <string>
#include <vector>

#include "posefusion/io/saved_map_file.hpp"
#include "posefusion/slam/loop_thread.hpp"
#include "simulated_sequence.hpp"

namespace pf::saved_map_scene {

constexpr int kMapped = 40, kElsewhere = 75, kFrames = 120;

inline Config config() {
  Config c;
  c.frame.shrink = 1;                  // the images are small already
  c.graph.keyframe_distance_m = 0.05;  // so that there are some
  return c;
}

inline const SimulatedSequence& room() { return exactBox<kFrames>(); }

inline bool equal(const std::vector<FragmentSurfels>& a, const std::vector<FragmentSurfels>& b) {
  bool same = a.size() == b.size();
  for (std::size_t i = 0; i < a.size() && same; ++i) {
    same = a[i].fragment == b[i].fragment;
    SurfelArrays own = a[i].surfels;
    own.forEachArray(b[i].surfels, [&](const auto& x, const auto& y) { same = same && x == y; });
  }
  return same;
}

/// A mapper with its loop closer.
struct Session {
  Mapper mapper{config()};
  LoopThread closer{config(), AnswerTime::after_lag};

  FrameStatus process(int index) {
    const FrameStatus status = mapper.process({room().frame(index).frame, {}, {}});
    closer.serve(mapper);
    return status;
  }
  /// Runs frames and returns how many poses are right (2 cm); a pose that is wrong fails.
  int follow(int begin, int end) {
    int right = 0;
    for (int i = begin; i < end; ++i) {
      const FrameStatus status = process(i);
      if (!status.located) continue;
      const double error =
          (status.T_map_camera.translation() - room().pose(i).translation()).norm();
      EXPECT_LT(error, 0.02) << "frame " << i;
      ++right;
    }
    closer.finish(mapper);
    return right;
  }
  void save(const std::string& path, MapWriter::Mode mode = MapWriter::Mode::create) {
    MapRecording recording(path, mode, toYaml(config()), mapper);
    EXPECT_EQ(recording.update(room().frame(0).frame.camera, mapper), "");
    EXPECT_TRUE(recording.finish(mapper));
  }
};

}  // namespace pf::saved_map_scene
