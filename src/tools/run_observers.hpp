// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string>
#include <vector>

#include "posefusion/evaluation/map_check.hpp"
#include "posefusion/slam/pipeline.hpp"

namespace pf {

/// Writes mask/ (a PNG per frame, named by its stamp, 255 = person) and people.json, the people as
/// the detector found them.
class MaskWriter {
 public:
  explicit MaskWriter(const std::string& folder);

  void add(const ProcessedFrame& frame);
  void finish() const;

 private:
  std::string folder_;
  std::vector<People> people_;
};

/// Compares the depth of the fused frames, from the fiftieth on, with the map as it is just then.
class LiveDepthCheck {
 public:
  explicit LiveDepthCheck(const SurfelMap& map) : check_(map) {}

  void add(const ProcessedFrame& frame);
  const DepthCheck& check() const { return check_; }

 private:
  DepthCheck check_;
  int index_ = 0;
};

}  // namespace pf
