// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "posefusion/config/fields.hpp"

namespace pf::simulator {

/// The body under the camera, and how its legs count their way.
struct LegsConfig {
  double rate_hz = 50.0;
  double neck_m = 0.60;             ///< the neck's joints above base_link
  double eye_m = 0.07;              ///< the camera before them
  int encoder_counts = 4096;        ///< of a turn of a joint of the neck; 0: exact
  double scale_percent = 2.0;       ///< most that all ways are reported too long or too short
  double turn_percent = 2.0;        ///< most that all turns are
  double drift_m_per_m = 0.015;     ///< sigma after one metre; grows with the root of the way
  double drift_deg_per_m = 0.4;     ///< the same of the heading
  double drift_deg_per_turn = 2.5;  ///< sigma after one whole turn; grows with its root
  double slip_every_s = 25.0;       ///< about so often a foot slips; 0: never
  double slip_m = 0.06;             ///< most that the legs then go and the body does not
  double slip_deg = 3.0;
  bool falls_confuse = true;  ///< in a fall legs report anything; otherwise the truth
  double fall_m_s = 0.7;      ///< how fast thrashing legs believe to go
  double fall_deg_s = 60.0;
  double fall_jump_m = 0.6;  ///< how far a body is put elsewhere
  double fall_jump_deg = 50.0;
};

inline void visitFields(LegsConfig& c, FieldVisitor& v) {
  v.number("rate_hz", c.rate_hz, 1.0, 1000.0, "poses a second");
  v.number("neck_m", c.neck_m, 0.0, 2.0, "the joints of the neck above base_link");
  v.number("eye_m", c.eye_m, -0.5, 0.5, "the camera before them");
  v.integer("encoder_counts", c.encoder_counts, 0, 1 << 24,
            "steps of a turn of a joint of the neck; 0 = exact");
  v.number("scale_percent", c.scale_percent, 0.0, 50.0,
           "most that all ways are reported too long or too short");
  v.number("turn_percent", c.turn_percent, 0.0, 50.0, "most that all turns are");
  v.number("drift_m_per_m", c.drift_m_per_m, 0.0, 1.0,
           "sigma of the place after a metre; grows with the root of the way");
  v.number("drift_deg_per_m", c.drift_deg_per_m, 0.0, 90.0, "sigma of the heading after a metre");
  v.number("drift_deg_per_turn", c.drift_deg_per_turn, 0.0, 90.0,
           "sigma of the heading after a whole turn");
  v.number("slip_every_s", c.slip_every_s, 0.0, 1e4, "a foot slips about so often; 0 = never");
  v.number("slip_m", c.slip_m, 0.0, 1.0, "most that legs then go and the body does not");
  v.number("slip_deg", c.slip_deg, 0.0, 90.0, "most that they then turn");
  v.flag("falls_confuse", c.falls_confuse, "in a fall legs report anything; off: the truth");
  v.number("fall_m_s", c.fall_m_s, 0.0, 10.0, "how fast thrashing legs believe to go");
  v.number("fall_deg_s", c.fall_deg_s, 0.0, 1000.0, "how fast they believe to turn");
  v.number("fall_jump_m", c.fall_jump_m, 0.0, 100.0, "how far a fall may put the body elsewhere");
  v.number("fall_jump_deg", c.fall_jump_deg, 0.0, 180.0, "how far it may turn it");
}

}  // namespace pf::simulator
