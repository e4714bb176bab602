// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <OpenNI.h>

#include <optional>
#include <string>
#include <vector>

#include "posefusion_openni2/settings.hpp"

namespace pf::openni2 {

/// The exposure of the colour stream. OpenNI2 has no property for the longest exposure that the
/// automatic may choose: where the device reports its exposure, this class watches it and holds it
/// at the limit; where it does not, `apply` says so.
class ExposureControl {
 public:
  explicit ExposureControl(openni::VideoStream& color) : color_(color) {}

  /// Returns what the device could not do, one sentence each.
  std::vector<std::string> apply(const ExposureSettings& settings);
  std::optional<int> exposure() const;
  /// True when the automatic went above the limit and was switched off.
  bool limit();

 private:
  bool set(int property, int value) const;
  void setFixed(const ExposureSettings& settings, std::vector<std::string>& failures);

  openni::VideoStream& color_;
  ExposureSettings settings_;
};

}  // namespace pf::openni2
