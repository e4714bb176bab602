// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Geometry>
#include <cstdint>
#include <optional>
#include <vector>

#include "posefusion/core/map_pose.hpp"

namespace pf {

/// One accepted correction of the graph, as it moves all that was made at any time, each fragment
/// by its own keyframes; it may make one fragment part of another. In place of the
/// nodes nearest in space it blends the two nearest in time (Whelan et al., "ElasticFusion", RSS
/// 2015, section V, after Sumner et al., "Embedded deformation for shape manipulation", SIGGRAPH
/// 2007), so that a corridor passed twice is not sewn together by nearness alone.
class Deformation {
 public:
  /// The correction at one keyframe.
  struct Node {
    std::int32_t map_frame = 0;
    /// T_new_old, from the map frame of its fragment to that of the fragment it is in afterwards
    Eigen::Isometry3d correction = Eigen::Isometry3d::Identity();
    bool leads_on = false;  ///< tracked on to the next node of its fragment: frames between the two
                            ///< are blended
    int fragment = kFirstFragment;  ///< before the correction
  };

  /// A fragment that becomes part of another.
  struct Join {
    int fragment = kFirstFragment, into = kFirstFragment;
  };

  /// Changes nothing.
  Deformation() = default;

  /// `version` is the number of the correction, from 1, rising with each.
  Deformation(int version, std::vector<Node> nodes, std::optional<Join> join = std::nullopt);

  /// Moves points of a fragment (p_new = at(f) * p_old) made when frame `map_frame` was fused: the
  /// geodesic of SE(3) between the nodes of the fragment before and after, or the node before where
  /// it does not lead on. Frames before the first node go with the first, those after the last with
  /// the last; a fragment without nodes stays.
  Eigen::Isometry3d at(std::int32_t map_frame, int fragment = kFirstFragment) const;

  /// What was made in a fragment before this frame stays where it is.
  std::int32_t firstMoved(int fragment) const;

  /// The fragment that what was in `fragment` is part of afterwards.
  int fragmentAfter(int fragment) const {
    return join_ && join_->fragment == fragment ? join_->into : fragment;
  }

  /// The same with further nodes.
  Deformation with(const std::vector<Node>& more) const;

  /// No point moves, and no fragment becomes part of another.
  bool isIdentity() const { return identity_; }
  bool joins() const { return join_.has_value(); }
  int version() const { return version_; }
  const std::vector<Node>& nodes() const { return nodes_; }  ///< by fragment and map_frame

 private:
  int version_ = 0;
  bool identity_ = true;
  std::vector<Node> nodes_;
  std::optional<Join> join_;
};

}  // namespace pf
