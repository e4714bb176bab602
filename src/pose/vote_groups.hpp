// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <vector>

#include "posefusion/core/camera.hpp"
#include "posefusion/pose/depth_input.hpp"
#include "posefusion/pose/skeleton.hpp"

namespace pf {

/// Of a body's cells around its median depth.
constexpr float kBodyDepthReach_m = 0.70F;

/// The camera of the model's input.
struct InputCamera {
  DepthInputGrid grid;
  float fx = 1.0F, fy = 1.0F;  // pixels of the input

  explicit InputCamera(const PinholeCamera& camera)
      : grid(depthInputGrid({camera.width, camera.height})),
        fx(static_cast<float>(camera.fx / grid.step_px)),
        fy(static_cast<float>(camera.fy / grid.step_px)) {}
};

/// A cell of the mask: where in the input the centre of its body should be.
struct Vote {
  int cell = 0;
  float x = 0.0F, y = 0.0F;  // pixels of the input
  float z = 0.0F;            // metres, of the cell
  float weight = 0.0F;
  int group = -1;
};

struct Group {
  float x = 0.0F, y = 0.0F, z = 0.0F;
  float weight = 0.0F;
  float area_m2 = 0.0F;
  Person person;
};

/// Squared distance, metres, of a place of the input from a group's centre, across the view.
float across2(const InputCamera& camera, const Group& group, float x, float y);

/// Finds groups of votes that meet in space, the densest first, and marks the votes. A small group
/// beside a larger one is a part of the same body and is left with an area of 0.
std::vector<Group> groupVotes(const InputCamera& camera, std::vector<Vote>& votes);

}  // namespace pf
