// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "posefusion/blur/config.hpp"
#include "posefusion/pose/config.hpp"
#include "posefusion/segmentation/config.hpp"
#include "posefusion/tracking/config.hpp"

namespace posefusion_ros {

// What may change while each nodelet runs: the lists that its parameters are read by too, less what
// they mark as atStart().

/// How often fusion publishes what people look at, in seconds by the stamps.
struct PublishingConfig {
  double path_period_s = 1.0;
  double surfels_period_s = 1.0;
  int surfels_max_points = 500000;
  double mesh_period_s = 2.0;
  double grid_period_s = 5.0;
};

inline void visitFields(PublishingConfig& c, pf::FieldVisitor& v) {
  v.number("path_period_s", c.path_period_s, 0.0, 3600.0, "how often the path is sent");
  v.number("surfels_period_s", c.surfels_period_s, 0.0, 3600.0, "how often the surfels are sent");
  v.integer("surfels_max_points", c.surfels_max_points, 0, 100000000,
            "more surfels than that: evenly many are left out; 0: all");
  v.number("mesh_period_s", c.mesh_period_s, 0.0, 3600.0,
           "how often what changed of the mesh is sent");
  v.number("grid_period_s", c.grid_period_s, 0.0, 3600.0, "how often the grid is sent");
}

/// The lists of one group of pf::Config.
template <typename Group>
void visitGroup(const char* name, Group& group, pf::FieldVisitor& visitor) {
  visitor.enter(name);
  visitFields(group, visitor);
  visitor.leave();
}

struct GateSettings {
  pf::BlurConfig blur;
};
inline void visitFields(GateSettings& s, pf::FieldVisitor& v) { visitGroup("blur", s.blur, v); }

struct DetectorSettings {
  pf::PoseConfig pose;
};
inline void visitFields(DetectorSettings& s, pf::FieldVisitor& v) { visitGroup("pose", s.pose, v); }

struct SegmenterSettings {
  pf::SegmentationConfig segmentation;
};
inline void visitFields(SegmenterSettings& s, pf::FieldVisitor& v) {
  visitGroup("segmentation", s.segmentation, v);
}

struct FusionSettings {
  pf::TrackingConfig tracking;
  PublishingConfig publishing;
};
inline void visitFields(FusionSettings& s, pf::FieldVisitor& v) {
  visitGroup("tracking", s.tracking, v);
  visitFields(s.publishing, v);
}

}  // namespace posefusion_ros
