// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <cstdint>

#include "simulator/rig.hpp"

namespace pf::simulator {

enum class HairStyle { bald, cropped, full, longer };
enum class Pattern { plain, stripes, checks, logo, jacket };
enum class BodyPart : std::uint8_t { body, head, hand, burden };

/// What widens the outline of a body. Lengths at a height of 1.75 m.
struct Garments {
  float hem = 0.0F;          ///< part of the leg that a skirt or long coat covers, 0..1; 0: none
  float flare_m = 0.0F;      ///< by which the hem is wider than the hips
  float thickness_m = 0.0F;  ///< of a jacket or coat over torso and arms, beyond a shirt's
  bool rucksack = false;
  bool bag = false;  ///< on a strap, at the hip
};

/// What a person wears and looks like. Colours are linear reflectances.
struct Outfit {
  Eigen::Vector3f skin{0.55F, 0.36F, 0.27F};
  Eigen::Vector3f hair{0.06F, 0.04F, 0.03F};
  HairStyle hair_style = HairStyle::cropped;
  bool beard = false;
  bool glasses = false;
  Eigen::Vector3f shirt{0.15F, 0.2F, 0.4F};
  Eigen::Vector3f second{0.7F, 0.7F, 0.7F};  ///< stripes, logo, what is under the jacket
  Pattern pattern = Pattern::plain;
  float sleeve = 0.25F;  ///< covered part of the arm, 0..1 (wrist)
  Eigen::Vector3f trousers{0.05F, 0.07F, 0.13F};
  float trouser_leg = 1.0F;  ///< covered part of the leg, 0..1 (ankle)
  Eigen::Vector3f shoes{0.05F, 0.05F, 0.05F};
  Garments garments;
  std::uint32_t seed = 0;
};

/// Clothes, hair and skin drawn by seed.
Outfit drawOutfit(std::uint32_t seed, bool feminine);

/// Wide clothes and things that are worn, of about half of all people.
Garments drawGarments(std::uint32_t seed);

/// A point of a person's surface at rest: where, facing where, and the head's hair tag (negative:
/// hair).
struct SurfacePoint {
  BodyPart part;
  Eigen::Vector3f rest;
  Eigen::Vector3f normal;
  float hair_tag;
};

/// Colour (linear) and infrared reflectance of people.
class Appearance {
 public:
  Appearance(const Rig& rig, const Outfit& outfit);
  Eigen::Vector3f color(const SurfacePoint& point) const;
  float infrared(const SurfacePoint& point) const;

 private:
  enum class Stuff { skin, shirt, trousers, shoe, hair, belt, carton };
  Stuff stuffAt(const SurfacePoint& point) const;
  Eigen::Vector3f shirtColor(const SurfacePoint& point) const;
  Eigen::Vector3f faceColor(const Eigen::Vector3f& p) const;
  Eigen::Vector3f handColor(const Eigen::Vector3f& p) const;

  Rig rig_;
  Outfit outfit_;
};

}  // namespace pf::simulator
