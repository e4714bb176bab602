// SPDX-License-Identifier: BSD-3-Clause
#include "simulator/depth_sensor.hpp"

#include <vector>

#include "posefusion/core/parallel.hpp"

namespace pf::simulator {
namespace {

std::unique_ptr<DepthKind> makeKind(const DepthShot& shot) {
  if (shot.config.noise && shot.config.kind == "time_of_flight") return makeTimeOfFlight(shot);
  if (shot.config.noise && shot.config.kind == "active_stereo") return makeActiveStereo(shot);
  return makeStructuredLight(shot);
}

}  // namespace

void senseDepth(const DepthShot& shot, cv::Mat& depth_mm, cv::Mat& label) {
  depth_mm.create(shot.view.depth_m.size(), CV_16UC1);
  label.create(shot.view.depth_m.size(), CV_8UC1);
  const auto kind = makeKind(shot);
  const int width = shot.camera.width, height = shot.camera.height;
  parallelFor(static_cast<std::size_t>(height), 4, [&](std::size_t begin, std::size_t end) {
    std::vector<float> depth_m(static_cast<std::size_t>(width));
    for (int row = static_cast<int>(begin); row < static_cast<int>(end); ++row) {
      kind->sense(row, depth_m.data(), label.ptr<std::uint8_t>(row));
      for (int col = 0; col < width; ++col) {
        const float z = depth_m[static_cast<std::size_t>(col)];
        const bool seen = z > 0.0F && z >= shot.config.min_m && z <= shot.config.max_m;
        depth_mm.at<std::uint16_t>(row, col) =
            seen ? static_cast<std::uint16_t>(1000.0F * z + 0.5F) : 0;
      }
    }
  });
}

}  // namespace pf::simulator
