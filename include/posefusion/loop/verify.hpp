// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <string_view>
#include <vector>

#include "posefusion/frame/working_frame.hpp"
#include "posefusion/graph/expected_place.hpp"
#include "posefusion/loop/place_search.hpp"
#include "posefusion/map/render.hpp"
#include "posefusion/tracking/pose_evidence.hpp"
#include "posefusion/tracking/tracker.hpp"

namespace pf {

/// Why a place hypothesis is rejected: what speaks most against it.
enum class PlaceDoubt {
  none,            ///< accepted
  covered,         ///< people or a hand leave little of the view
  little_overlap,  ///< little of the frame is in the map
  not_converged,   ///< the alignment did not settle
  degenerate,      ///< the images leave directions free, or hardly determine them
  disagrees,       ///< few pixels are where the map has them
  seen_through,    ///< the frame sees through what the map shows
  other_picture,   ///< the grey levels do not fit
  ambiguous        ///< another place fits as well
};

constexpr std::size_t kPlaceDoubts = 9;
std::string_view name(PlaceDoubt doubt);

struct PlaceVerdict {
  PlaceDoubt doubt = PlaceDoubt::little_overlap;
  int fragment = kFirstFragment;  ///< of the map, that the place is in
  TrackingResult alignment;       ///< pose in it, and covariance
  ViewAgreement agreement;        ///< at that pose
  double log_odds = 0;            ///< see PoseEvidence

  bool accepted() const { return doubt == PlaceDoubt::none; }
  MapPose pose() const { return {fragment, alignment.T_map_camera}; }
};

/// The start of an alignment from nothing but a first pose.
TrackingStart freeStart(const Eigen::Isometry3d& T_map_camera);

/// Judges an alignment: the place is accepted where it is known, and its evidence as much as
/// `sure_to_return` asks.
void judgePlace(PlaceVerdict& verdict, const TrackingConfig& config);

/// Aligns frames with the map from a first guess and judges the result, see PoseEvidence. Keeps
/// buffers between calls. Not thread safe; the map must not change during a call.
class PlaceVerifier {
 public:
  explicit PlaceVerifier(const TrackingConfig& tracking) : tracking_(tracking) {}

  /// The frame against the map as it is seen from the pose.
  ViewAgreement compare(const SurfelMap& map, const WorkingFrame& frame, const MapPose& pose);

  PlaceVerdict verify(const SurfelMap& map, const WorkingFrame& frame, const MapPose& candidate);

  /// Verifies the first `most` candidates, best first; of the accepted ones the best. When they
  /// lead to different poses, or fragments, the one that dead reckoning expects, where it is given
  /// and separates them; else `ambiguous`. With none accepted, the verdict on the first.
  PlaceVerdict verifyBest(const SurfelMap& map, const WorkingFrame& frame,
                          const std::vector<PlaceCandidate>& candidates, std::size_t most = 6,
                          const ExpectedPlace* expected = nullptr);

 private:
  TrackingConfig tracking_;
  SurfelRenderer renderer_;
  ModelView view_;
  ModelPyramid model_;
};

}  // namespace pf
