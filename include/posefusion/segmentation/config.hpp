// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string>

#include "posefusion/config/fields.hpp"

namespace pf {

/// Settings of the min-cut segmenter.
struct SegmentationConfig {
  bool enabled = true;
  bool moving_objects = true;
  std::string energy = "improved";
  double paper_sigma_m = 0.25;
  double paper_radius_m = 0.20;
  int grid_width = 160;
  double sigma_m = 0.05;
  double smoothness = 6.0;
  double color_weight = 1.0;
  double model_weight = 2.5;
  double mask_weight = 1.0;
  double carry_s = 1.0;
  int margin_px = 3;
};

inline void visitFields(SegmentationConfig& c, FieldVisitor& v) {
  v.flag("enabled", c.enabled, "remove people, and what else moves, from the depth");
  v.flag("moving_objects", c.moving_objects,
         "remove what moves and was not detected as a person: doors, chairs, what is carried");
  v.choice("energy", c.energy, {"improved", "paper"}, "terms of the cut");
  v.number("paper_sigma_m", c.paper_sigma_m, 1e-3, 10.0,
           "energy paper: length scale of the smoothness cost");
  v.number("paper_radius_m", c.paper_radius_m, 1e-3, 10.0,
           "energy paper: length scale of the background penalty");
  v.number("sigma_m", c.sigma_m, 1e-3, 10.0, "length scale of the smoothness cost");
  v.number("smoothness", c.smoothness, 0.0, 1e3, "weight of the smoothness cost");
  v.number("color_weight", c.color_weight, 0.0, 1e3, "weight of the colour likelihood");
  v.number("model_weight", c.model_weight, 0.0, 1e3,
           "weight of the agreement with the rendered map");
  v.number("mask_weight", c.mask_weight, 0.0, 1e3,
           "weight of a detector's own mask, where it gives one");
  v.number("carry_s", c.carry_s, 0.0, 1000.0,
           "people are carried forward for so long after they were last detected");
  v.integer("margin_px", c.margin_px, 0, 50,
            "rim around the mask that is removed from the depth too, at 640 pixels width");
  v.atStart();
  v.integer("grid_width", c.grid_width, 16, 640, "columns of the grid that is cut");
}

}  // namespace pf
