// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string>
#include <string_view>

#include "posefusion/frame/working_frame.hpp"
#include "posefusion/map/render.hpp"
#include "posefusion/tracking/tracker.hpp"

namespace pf {

/// Why a place is not believed.
enum class PlaceDoubt {
  none,            ///< believed
  little_overlap,  ///< too little of the frame is in the map
  not_converged,   ///< the alignment did not settle
  degenerate,      ///< the images leave directions free
  moved_away,      ///< the alignment went far from the candidate
  disagrees,       ///< too few pixels are where the map has them
  seen_through,    ///< the frame sees through what the map shows
  other_picture    ///< the grey levels do not fit
};

std::string_view name(PlaceDoubt doubt);

/// How a frame and the map, seen from one pose, agree.
struct PlaceAgreement {
  double overlap = 0;       ///< part of the frame's pixels with depth where the map shows something
  double agreeing = 0;      ///< part of those at the same depth, facing the same way
  double seen_through = 0;  ///< part of those where the frame sees beyond the map's surface
  double hidden = 0;        ///< part of those where the frame has something before it
  double correlation = 0;   ///< of the grey levels where the depths agree, in small windows
};

struct PlaceVerdict {
  PlaceDoubt doubt = PlaceDoubt::little_overlap;
  TrackingResult alignment;  ///< pose and covariance
  PlaceAgreement agreement;  ///< at that pose

  bool accepted() const { return doubt == PlaceDoubt::none; }
  /// Higher is better, for choosing among candidates.
  double score() const { return agreement.overlap * agreement.agreeing; }
};

/// What is asked of a place that is believed.
struct VerifyLimits {
  double min_overlap = 0.25;
  double min_agreeing = 0.8;
  double max_seen_through = 0.1;
  double min_correlation = 0.5;
  double max_shift_m = 0.4, max_turn_rad = 0.35;
};

/// Compares a frame with the map drawn from its pose.
PlaceAgreement compareViews(const WorkingFrame& frame, const ModelView& view);

/// Aligns frames with the map from a first guess and judges the result: geometry both ways (what
/// the map shows must be in the frame too, not be seen through), grey levels, conditioning. Keeps
/// buffers between calls. Not thread safe; the map must not change during a call.
class PlaceVerifier {
 public:
  explicit PlaceVerifier(const TrackingConfig& tracking, const VerifyLimits& limits = {})
      : tracking_(tracking), limits_(limits) {}

  PlaceVerdict verify(const SurfelMap& map, const WorkingFrame& frame,
                      const Eigen::Isometry3d& T_map_candidate);

 private:
  PlaceDoubt judge(const PlaceVerdict& verdict, const Eigen::Isometry3d& T_map_candidate) const;

  TrackingConfig tracking_;
  VerifyLimits limits_;
  SurfelRenderer renderer_;
  ModelView view_;
  ModelPyramid model_;
};

}  // namespace pf
