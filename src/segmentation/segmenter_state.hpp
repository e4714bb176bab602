// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <vector>

#include "posefusion/core/pace.hpp"
#include "posefusion/segmentation/cut_grid.hpp"
#include "posefusion/segmentation/energy.hpp"
#include "posefusion/segmentation/expected_motion.hpp"
#include "posefusion/segmentation/moving_objects.hpp"
#include "posefusion/segmentation/paper_cut.hpp"
#include "posefusion/segmentation/people_in_map.hpp"
#include "posefusion/segmentation/planes.hpp"
#include "posefusion/segmentation/segmenter.hpp"

namespace pf {

/// What is kept from frame to frame, and the steps that make one frame's mask.
struct PeopleSegmenter::State {
  explicit State(const DepthSensor& sensor) : motion(sensor), objects(sensor) {}

  cv::Mat depth_m;
  std::vector<TrackedPerson> people;
  Evidence evidence;
  ExpectedMotion motion;
  PlaneFinder planes;
  Unary unary;
  GridCutter cutter;
  PaperCutter paper_cutter;
  std::vector<std::uint8_t> labels;  // 1: a person
  MovingObjects objects;
  PeopleInMap people_in_map;
  int last_id = 0;
  PaceMeter pace_meter;
  float worth = 1.0F;  // of the frame, see Pace

  MovingScene sceneOf(const RgbdFrame& frame, const ModelView& view,
                      const Eigen::Isometry3d& T_uncorrected_camera) const {
    return {evidence.grid,       frame.camera, view,          T_uncorrected_camera,
            evidence.background, labels,       frame.stamp_ns};
  }
  void takeGrid(const RgbdFrame& frame, int grid_width);
  void locate(double carry_s);
  void markCarriedMasks();
  void markShownPeople();
  void cut(const SegmentationConfig& config);
  void keepPeople(bool with_map);
  void takeOut(const RgbdFrame& frame, const std::vector<std::uint8_t>& taken, int margin_px,
               Segmentation& result) const;
};

}  // namespace pf
