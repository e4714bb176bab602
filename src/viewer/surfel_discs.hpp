// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Ogre.h>

#include <vector>

#include "posefusion_ros/surfel_cloud.hpp"

namespace posefusion_ros {

/// Surfels as flat discs: one triangle around each, of which a texture shows the disc. No shader is
/// needed, and half the vertices of squares.
class SurfelDiscs : public Ogre::SimpleRenderable {
 public:
  SurfelDiscs();
  ~SurfelDiscs() override;

  void set(const std::vector<SurfelPoint>& surfels);

  /// Leaves out discs that are seen from behind: a room is looked into from outside.
  void hideBacks(bool hide);

  Ogre::Real getBoundingRadius() const override { return radius_; }
  Ogre::Real getSquaredViewDepth(const Ogre::Camera* camera) const override;

 private:
  void reserve(std::size_t vertices);

  Ogre::HardwareVertexBufferSharedPtr buffer_;
  std::size_t capacity_ = 0;
  Ogre::Real radius_ = 0;
  Ogre::MaterialPtr own_material_;
  Ogre::TexturePtr disc_;
};

}  // namespace posefusion_ros
