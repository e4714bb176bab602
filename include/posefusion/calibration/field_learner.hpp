// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <optional>
#include <vector>

#include "posefusion/calibration/field_estimate.hpp"

namespace pf {

/// Estimates the field of a camera again and again while keyframes come in: each time that there
/// are a quarter more of them. What it keeps is bounded; of a long walk it knows old keyframes more
/// sparsely. The same keyframes and poses in the same order give the same bytes. Not thread safe.
class FieldLearner {
 public:
  /// Ids rise.
  void add(const CalibrationView& view);

  /// New poses after a correction: of keyframe i at place i. Throws std::out_of_range when there
  /// are fewer than the last id wants.
  void setPoses(const std::vector<MapPose>& poses);

  /// Nothing where it is not time yet. Seconds of work for a hundred keyframes. `known`: that their
  /// depth is corrected by already.
  std::optional<FieldEstimate> learn(const DepthField& known = {});

  /// The same whether it is time or not.
  FieldEstimate estimate(const DepthField& known = {});

 private:
  std::vector<ViewSurface> surfaces_;
  std::size_t keyframes_ = 0;     ///< that came
  std::size_t estimated_at_ = 0;  ///< so many keyframes
};

}  // namespace pf
