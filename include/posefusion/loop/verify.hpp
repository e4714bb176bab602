// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <string_view>
#include <vector>

#include "posefusion/frame/working_frame.hpp"
#include "posefusion/graph/expected_place.hpp"
#include "posefusion/loop/place_search.hpp"
#include "posefusion/map/render.hpp"
#include "posefusion/tracking/tracker.hpp"

namespace pf {

/// Why a place hypothesis is rejected.
enum class PlaceDoubt {
  none,            ///< accepted
  covered,         ///< people or a hand leave too little of the view
  little_overlap,  ///< too little of the frame is in the map
  not_converged,   ///< the alignment did not settle
  degenerate,      ///< the images leave directions free, or hardly determine them
  moved_away,      ///< the alignment went far from the candidate
  disagrees,       ///< too few pixels are where the map has them
  seen_through,    ///< the frame sees through what the map shows
  other_picture,   ///< the grey levels do not fit
  ambiguous        ///< another place fits as well
};

constexpr std::size_t kPlaceDoubts = 10;
std::string_view name(PlaceDoubt doubt);

/// How a frame and the map, seen from one pose, agree.
struct PlaceAgreement {
  double overlap = 0;       ///< part of the frame's pixels with depth where the map shows something
  double agreeing = 0;      ///< part of those at the same depth, facing the same way
  double seen_through = 0;  ///< part of those where the frame sees beyond the map's surface
  double hidden = 0;        ///< part of those where the frame has something before it
  double correlation = 0;   ///< of the grey levels where the depths agree, in small windows
  /// How much the normals of what agrees vary: the least eigenvalue of their mean outer product, 0
  /// for one or two walls, 1/3 at most. Where it is small the pose may have slid.
  double spread = 0;
  double view = 1;  ///< part of the frame's pixels with depth
};

struct PlaceVerdict {
  PlaceDoubt doubt = PlaceDoubt::little_overlap;
  int fragment = kFirstFragment;  ///< of the map, that the place is in
  TrackingResult alignment;       ///< pose in it, and covariance
  PlaceAgreement agreement;       ///< at that pose

  bool accepted() const { return doubt == PlaceDoubt::none; }
  /// Higher is better, for choosing among candidates.
  double score() const { return agreement.overlap * agreement.agreeing; }
  MapPose pose() const { return {fragment, alignment.T_map_camera}; }
};

/// Limits that an accepted place must meet.
struct VerifyLimits {
  double min_view = 0.15;  ///< seen through a gap, a wall may slide freely
  double min_overlap = 0.25;
  double min_agreeing = 0.85;  ///< of what is not hidden
  /// Enough where shape and picture agree: a map that drift has bent agrees less.
  double min_agreeing_of_both = 0.75, shape_of_both = 0.1, correlation_of_both = 0.75;
  double max_hidden = 0.4;
  double max_seen_through = 0.1;
  double min_correlation = 0.68;
  /// Enough where the shape alone is distinctive: on real cameras colour and depth fit badly.
  double min_correlation_of_shape = 0.3;
  double shape_overlap = 0.75, shape_spread = 0.05;
  double max_shift_m = 0.4, max_turn_rad = 0.35;
  double max_sigma_m = 0.033;  ///< of the position: 3 of it are 0.1 m, beyond which a pose is wrong
};

/// Compares a frame with the map drawn from its pose.
PlaceAgreement compareViews(const WorkingFrame& frame, const ModelView& view);

/// The start of an alignment from nothing but a first pose.
TrackingStart freeStart(const Eigen::Isometry3d& T_map_camera);

/// Standard deviation (m) of the camera's position in the direction that is known worst.
double positionSigma(const Matrix6d& covariance);

/// Whether the shape alone determines the pose: much of the frame is in the map, facing many ways.
bool hasShape(const PlaceAgreement& agreement, const VerifyLimits& limits = {});

/// Why an alignment that began at `T_map_candidate` is rejected, if it is.
PlaceDoubt judgePlace(const PlaceVerdict& verdict, const Eigen::Isometry3d& T_map_candidate,
                      const VerifyLimits& limits);

/// Aligns frames with the map from a first guess and judges the result: geometry both ways (what
/// the map shows must be in the frame too, not be seen through), grey levels, conditioning. Keeps
/// buffers between calls. Not thread safe; the map must not change during a call.
class PlaceVerifier {
 public:
  explicit PlaceVerifier(const TrackingConfig& tracking, const VerifyLimits& limits = {})
      : tracking_(tracking), limits_(limits) {}

  /// The frame against the map as it is seen from the pose.
  PlaceAgreement compare(const SurfelMap& map, const WorkingFrame& frame, const MapPose& pose);

  PlaceVerdict verify(const SurfelMap& map, const WorkingFrame& frame, const MapPose& candidate);

  /// Verifies the first `most` candidates, best first; of the accepted ones the best. When they
  /// lead to different poses, or fragments, the one that dead reckoning expects, where it is given
  /// and separates them; else `ambiguous`. With none accepted, the verdict on the first.
  PlaceVerdict verifyBest(const SurfelMap& map, const WorkingFrame& frame,
                          const std::vector<PlaceCandidate>& candidates, std::size_t most = 6,
                          const ExpectedPlace* expected = nullptr);

 private:
  TrackingConfig tracking_;
  VerifyLimits limits_;
  SurfelRenderer renderer_;
  ModelView view_;
  ModelPyramid model_;
};

}  // namespace pf
