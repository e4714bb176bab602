// SPDX-License-Identifier: BSD-3-Clause
// Frames as a camera delivers them, an answer to each: frame_by_frame TUM_FOLDER
#include <cstdio>
#include <exception>
#include <functional>
#include <iostream>
#include <string>

#include "posefusion/io/frame_source.hpp"
#include "posefusion/run/slam.hpp"

namespace {

/// Takes the place of a camera's driver: calls back with each frame. A driver fills color (R G B),
/// depth, camera and stamp.
void playBack(const std::string& folder, const std::function<void(const pf::RgbdFrame&)>& call) {
  const auto recording = pf::openTumFolder(folder);
  while (const auto next = recording->next()) call(next->frame);
}

}  // namespace

int main(int argc, char** argv) {
  if (argc != 2) {
    std::cerr << "usage: frame_by_frame TUM_FOLDER\n";
    return 2;
  }
  try {
    pf::Slam slam;
    playBack(argv[1], [&slam](const pf::RgbdFrame& frame) {
      const pf::FrameAnswer answer = slam.process(frame);
      std::printf("%.3f ", 1e-9 * static_cast<double>(answer.stamp_ns));
      if (answer.located) {
        const auto at = answer.T_world_camera.translation();
        std::printf("camera at %.3f %.3f %.3f m", at.x(), at.y(), at.z());
      } else {
        std::printf("no pose");
      }
      std::printf(answer.reason.empty() ? "\n" : " (%s)\n", answer.reason.c_str());
    });
    std::printf("%zu surfels\n", slam.surfels().size());
  } catch (const std::exception& error) {
    std::cerr << "frame_by_frame: " << error.what() << "\n";
    return 1;
  }
  return 0;
}
