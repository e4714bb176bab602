// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Geometry>
#include <cstdint>
#include <vector>

namespace pf {

/// One accepted correction of the graph, as it moves all that was made at any time. In place of the
/// nodes nearest in space it blends the two nearest in time (Whelan et al., "ElasticFusion", RSS
/// 2015, section V, after Sumner et al., "Embedded deformation for shape manipulation", SIGGRAPH
/// 2007), so that a corridor passed twice is not sewn together by nearness alone.
class Deformation {
 public:
  /// The correction at one keyframe.
  struct Node {
    std::int32_t map_frame = 0;
    Eigen::Isometry3d correction = Eigen::Isometry3d::Identity();  ///< T_new_old, map frame
    bool leads_on = false;  ///< tracked on to the next node: frames between the two are blended
  };

  /// Changes nothing.
  Deformation() = default;

  /// `version` is the number of the correction, from 1, rising with each.
  Deformation(int version, std::vector<Node> nodes);

  /// Moves points of the map (p_new = at(f) * p_old) made when frame `map_frame` was fused: the
  /// geodesic of SE(3) between the nodes before and after, or the node before where it does not
  /// lead on. Frames before the first node go with the first, those after the last with the last.
  Eigen::Isometry3d at(std::int32_t map_frame) const;

  bool isIdentity() const { return identity_; }
  int version() const { return version_; }
  const std::vector<Node>& nodes() const { return nodes_; }  ///< ascending by map_frame

 private:
  int version_ = 0;
  bool identity_ = true;
  std::vector<Node> nodes_;
};

}  // namespace pf
