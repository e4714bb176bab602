// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "posefusion/config/fields.hpp"

namespace pf {

/// Settings of the depth camera's calibration.
struct CalibrationConfig {
  /// learn: depth is corrected by what is known, and mapping learns more; frozen: by what is known;
  /// none: it is taken as measured.
  std::string mode = "learn";

  bool learns() const { return mode == "learn"; }
  bool corrects() const { return mode != "none"; }
};

inline void visitFields(CalibrationConfig& c, FieldVisitor& v) {
  v.choice("mode", c.mode, {"learn", "frozen", "none"},
           "learn: depth is corrected by what is known of the camera, and mapping learns more; "
           "frozen: by what is known; none: it is taken as measured");
}

}  // namespace pf
