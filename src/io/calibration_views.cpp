// SPDX-License-Identifier: BSD-3-Clause
#include "posefusion/io/calibration_views.hpp"

#include <utility>

#include "posefusion/core/error.hpp"
#include "posefusion/io/map_database.hpp"
#include "posefusion/io/saved_map_file.hpp"

namespace pf {

CalibrationViews readCalibrationViews(const std::string& map_file) {
  const MapReader reader(map_file);
  const MapContent content = reader.content();
  CalibrationViews all;
  all.camera = content.camera;
  all.corrected_by = calibrationOf(content);
  const DepthSensor sensor = depthSensorOf(settingsOf(content, map_file));
  for (const Keyframe& keyframe : content.keyframes) {
    KeyframeImages images = reader.images(keyframe.id);
    if (images.depth_mm.empty()) continue;
    const int shrink = content.camera.width / images.depth_mm.cols;
    CalibrationView view;
    view.id = keyframe.id;
    view.T_map_camera = keyframe.T_map_camera;
    view.fragment = keyframe.fragment;
    view.sensor = sensor;
    if (shrink >= 1) view.camera = content.camera.shrunk(shrink);
    if (view.camera.width != images.depth_mm.cols || view.camera.height != images.depth_mm.rows) {
      throw InputError(map_file + ": the depth of keyframe " + std::to_string(keyframe.id) +
                       " is " + std::to_string(images.depth_mm.cols) + " x " +
                       std::to_string(images.depth_mm.rows) + ", expected a part of " +
                       std::to_string(content.camera.width) + " x " +
                       std::to_string(content.camera.height));
    }
    view.depth_mm = std::move(images.depth_mm);
    all.views.push_back(std::move(view));
  }
  return all;
}

}  // namespace pf
