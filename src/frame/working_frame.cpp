// SPDX-License-Identifier: BSD-3-Clause
#include "posefusion/frame/working_frame.hpp"

#include <algorithm>
#include <cmath>
#include <opencv2/imgproc.hpp>

#include "posefusion/frame/depth_filter.hpp"

namespace pf {
namespace {

// Depth past the largest used still shows that the space in front of it is empty, up to here: no
// sensor of a robot's measures farther indoors, and some report their largest number for "nothing".
constexpr double kFarthestBin_m = 15.0;
constexpr double kFocal_px = 262.5;  // of a Kinect at 320x240
constexpr int kMostShrink = 8;

/// 255 where no pixel of the block belongs to a person.
void shrinkStill(const cv::Mat& mask, const cv::Size& size, cv::Mat& still) {
  still.create(size, CV_8UC1);
  if (mask.empty()) {
    still.setTo(255);
    return;
  }
  cv::resize(mask, still, size, 0, 0, cv::INTER_AREA);
  cv::compare(still, 0, still, cv::CMP_EQ);
}

}  // namespace

int shrinkFor(const FrameConfig& config, double focal_px) {
  if (config.shrink > 0) return config.shrink;
  return std::clamp(static_cast<int>(std::lround(focal_px / kFocal_px)), 1, kMostShrink);
}

void WorkingFrame::assign(const RgbdFrame& frame, const cv::Mat& mask, const FrameConfig& config,
                          const DepthSensor& taken_by) {
  sensor = taken_by;
  sensor.min_depth_m = config.min_depth_m;
  sensor.max_depth_m = config.max_depth_m;
  full_camera = frame.camera;
  full_color = frame.color;
  const int shrink = shrinkFor(config, frame.camera.fx);
  camera = frame.camera.shrunk(shrink);
  const cv::Size size(camera.width, camera.height);
  depthInMetres(frame, config.min_depth_m, std::max(config.max_depth_m, kFarthestBin_m),
                full_depth_m);
  shrinkDepth(full_depth_m, shrink, sensor, depth_m);
  cv::threshold(full_depth_m, full_depth_m, config.max_depth_m, 0, cv::THRESH_TOZERO_INV);
  cv::threshold(depth_m, beyond_m, config.max_depth_m, 0, cv::THRESH_TOZERO);
  cv::threshold(depth_m, depth_m, config.max_depth_m, 0, cv::THRESH_TOZERO_INV);
  valid_pixels = cv::countNonZero(depth_m);
  cv::resize(frame.color, color, size, 0, 0, cv::INTER_AREA);

  FrameLevel& finest = levels[0];
  finest.camera = camera;
  smoothDepth(depth_m, sensor, smooth_m_);
  computeNormals(smooth_m_, camera, sensor, finest.normal_x, finest.normal_y, finest.normal_z);
  finest.depth_m = depth_m;
  shrinkToIntensity(frame.color, shrink, finest.intensity);
  shrinkStill(mask, size, finest.still);
  for (int i = 1; i < kLevels; ++i) {
    const FrameLevel& finer = levels[i - 1];
    levels[i].camera = finer.camera.shrunk(2);
    shrinkDepth(finer.depth_m, 2, sensor, levels[i].depth_m);
    halveIntensity(finer.intensity, levels[i].intensity);
    shrinkStill(mask, levels[i].intensity.size(), levels[i].still);
  }
  for (int i = 1; i < kLevels; ++i) {
    FrameLevel& level = levels[i];
    computeNormals(level.depth_m, level.camera, sensor, level.normal_x, level.normal_y,
                   level.normal_z);
  }
  const FrameLevel& coarsest = levels[kLevels - 1];
  const float from_m = noisyNormalsFrom(camera, sensor);
  for (int i = 0; i < kLevels - 1; ++i) {
    FrameLevel& level = levels[i];
    takeCoarseNormals(level.depth_m, from_m,
                      {coarsest.normal_x, coarsest.normal_y, coarsest.normal_z},
                      1 << (kLevels - 1 - i), {&level.normal_x, &level.normal_y, &level.normal_z});
  }
}

WorkingFrame WorkingFrame::clone() const {
  WorkingFrame copy = *this;
  copy.full_color = cv::Mat();
  for (cv::Mat* image :
       {&copy.depth_m, &copy.beyond_m, &copy.color, &copy.full_depth_m, &copy.smooth_m_}) {
    *image = image->clone();
  }
  for (FrameLevel& level : copy.levels) {
    for (cv::Mat* plane : {&level.depth_m, &level.normal_x, &level.normal_y, &level.normal_z,
                           &level.intensity, &level.still}) {
      *plane = plane->clone();
    }
  }
  return copy;
}

}  // namespace pf
