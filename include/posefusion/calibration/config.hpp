// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "posefusion/config/fields.hpp"

namespace pf {

/// Settings of what is learned of the cameras.
struct CalibrationConfig {
  /// learn: depth is corrected by what is known, and mapping learns more; frozen: by what is known;
  /// none: it is taken as measured.
  std::string mode = "learn";
  /// Where colour does not lie over depth in the first seconds. tell: that is reported; learn: it
  /// is registered from then on; none: nothing is looked at.
  std::string color = "tell";

  bool learns() const { return mode == "learn"; }
  bool looksAtColor() const { return color != "none"; }
  bool registersColor() const { return color == "learn"; }
  bool corrects() const { return mode != "none"; }
};

inline void visitFields(CalibrationConfig& c, FieldVisitor& v) {
  v.choice("mode", c.mode, {"learn", "frozen", "none"},
           "learn: depth is corrected by what is known of the camera, and mapping learns more; "
           "frozen: by what is known; none: it is taken as measured");
  v.choice("color", c.color, {"tell", "learn", "none"},
           "where colour does not lie over depth in the first seconds: tell: that is reported; "
           "learn: it is registered from then on; none: nothing is looked at");
}

}  // namespace pf
