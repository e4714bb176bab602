// SPDX-License-Identifier: BSD-3-Clause
#include "simulator/person_cast.hpp"

#include <algorithm>
#include <cmath>

#include "simulator/actor.hpp"
#include "simulator/loose_posture.hpp"
#include "simulator/posture.hpp"

namespace pf::simulator {
namespace {

using Eigen::Isometry3f;
using Eigen::Vector2d;
using Eigen::Vector3f;

constexpr float kCoarseness = 2.0F;

/// The motion that moves the floor under `from` (place, direction) to `to`.
Isometry3f carriage(const Vector2d& from, double from_yaw, const Vector2d& to, double to_yaw) {
  const Eigen::Vector2f a = from.cast<float>(), b = to.cast<float>();
  return placed(b.x(), b.y(), 0.0F, static_cast<float>(to_yaw)) *
         placed(a.x(), a.y(), 0.0F, static_cast<float>(from_yaw)).inverse();
}

/// The state of a person some time into an action, somewhere.
ActorState play(const Build& build, const Action& action, const Walkway& walkway, int steps) {
  PersonSpec spec;
  spec.build = build;
  spec.script = {action};
  spec.start_m = action.kind == Action::Kind::walk
                     ? Vector2d(action.at_m.head<2>() - Vector2d(6.0, 0.0))
                     : Vector2d::Zero();
  Actor actor(spec, walkway);
  for (int i = 0; i < steps; ++i) actor.step({});
  return actor.state();
}

/// Upright people on an endless floor, at the origin facing +x.
Posture drawUpright(const Rig& rig, const Walkway& endless, Dice& dice) {
  Action action;
  action.for_s = 100.0;
  const double lot = dice.between(0.0, 1.0);
  if (lot < 0.45) action.kind = Action::Kind::walk;
  if (lot > 0.65) action.kind = Action::Kind::talk;
  if (lot > 0.80) action.kind = Action::Kind::reach;
  if (lot > 0.92) action.kind = Action::Kind::crouch;
  action.speed_m_s = dice.between(0.3, 1.6);
  action.carries = dice.chance(0.15);
  if (action.kind == Action::Kind::reach) {
    action.at_m.x() = dice.between(0.2, 0.8);
    action.at_m.y() = dice.between(-0.6, 0.6);
    action.at_m.z() = dice.between(0.3, 2.1);
  }
  const ActorState state = play(rig.build, action, endless, 30 + dice.below(90));
  Posture posture = poseBody(rig, state, dice.next());
  moveBody(carriage(state.at, state.yaw, Vector2d::Zero(), 0.0), posture);
  loosen(rig, posture, false, dice);
  return posture;
}

Posture seated(const Rig& rig, const Seat& seat, const Walkway& endless, Dice& dice) {
  Action action;
  action.kind = Action::Kind::sit;
  action.for_s = 100.0;
  action.seat_m = seat.height_m;
  action.gestures = dice.chance(0.5);
  const ActorState state = play(rig.build, action, endless, 20 + dice.below(60));
  Posture posture = poseBody(rig, state, dice.next());
  const double turn = dice.chance(0.2) ? dice.between(-1.2, 1.2) : dice.between(-0.3, 0.3);
  moveBody(carriage(Vector2d::Zero(), 0.0, seat.at, seat.yaw_rad + turn), posture);
  loosen(rig, posture, false, dice);
  return posture;
}

Posture lying(const Rig& rig, const PersonRoom& room, const Vector2d& at, const Walkway& endless,
              Dice& dice) {
  Posture posture = drawUpright(rig, endless, dice);
  loosen(rig, posture, true, dice);
  const bool bed = !room.beds.empty() && dice.chance(0.5);
  const Bed where =
      bed ? room.beds[static_cast<std::size_t>(dice.below(static_cast<int>(room.beds.size())))]
          : Bed{at, dice.between(0.0, 2.0 * M_PI), 0.0};
  layDown(rig, static_cast<float>(where.height_m), dice, posture);
  moveBody(carriage(Vector2d::Zero(), 0.0, where.at, where.yaw_rad), posture);
  return posture;
}

/// Places people one after another.
class Arranger {
 public:
  Arranger(const PersonRoom& room, const Walkway& walkway, const std::vector<Avatar>& cast,
           Dice& dice)
      : room_(room), walkway_(walkway), endless_(World(), 0.0), cast_(cast), dice_(dice) {}

  Arrangement arrange() {
    Arrangement out;
    for (std::size_t i = 0; i < cast_.size(); ++i) {
      const float apart = 3.0F * static_cast<float>(i);  // Embree wants boxes apart
      Posture away;
      away.fill(placed(apart, apart, -100.0F - apart));
      out.postures.push_back(away);
    }
    out.present.assign(cast_.size(), 0);
    middle_ = anywhere();
    spread_m_ = dice_.chance(0.35) ? dice_.between(0.4, 0.9) : dice_.between(0.9, 3.0);
    out.focus = {middle_.x(), middle_.y(), dice_.between(0.4, 1.5)};
    const double lot = dice_.between(0.0, 1.0);
    const int most = static_cast<int>(cast_.size());
    const int count = lot < 0.14   ? 0
                      : lot < 0.42 ? 1
                      : lot < 0.66 ? std::min(2, most)
                                   : std::min(most, 3 + dice_.below(most));
    const int first = dice_.below(most);
    for (int i = 0; i < count; ++i) {
      const auto person = static_cast<std::size_t>((first + i) % most);
      out.postures[person] = place(cast_[person].rig());
      out.present[person] = 1;
      if (i == 0) out.focus.head<2>() = places_.back();
    }
    if (count > 1) out.others.assign(places_.begin() + 1, places_.end());
    return out;
  }

 private:
  Vector2d anywhere() {
    Vector2d at;
    for (int i = 0; i < 8; ++i) {
      at.x() = dice_.between(0.2, room_.size_m.x() - 0.2);
      at.y() = dice_.between(0.2, room_.size_m.y() - 0.2);
      if (walkway_.isFree(at)) break;
    }
    return at;
  }

  /// Free floor near the middle and apart from others; anywhere when that cannot be found.
  Vector2d freePlace() {
    for (int i = 0; i < 12; ++i) {
      const double angle = dice_.between(0.0, 2.0 * M_PI);
      const double radius = spread_m_ * std::sqrt(dice_.between(0.0, 1.0));
      const Vector2d at = middle_ + radius * Vector2d(std::cos(angle), std::sin(angle));
      const bool apart = std::all_of(places_.begin(), places_.end(),
                                     [&](const auto& p) { return (p - at).norm() > 0.36; });
      if (apart && walkway_.isFree(at)) return at;
    }
    return anywhere();
  }

  /// A free seat, the nearer to the middle the likelier.
  const Seat* freeSeat() {
    const Seat* best = nullptr;
    double least = 1e9;
    for (const Seat& seat : room_.seats) {
      const bool taken = std::any_of(places_.begin(), places_.end(),
                                     [&](const auto& p) { return (p - seat.at).norm() < 0.45; });
      const double distance = (seat.at - middle_).norm() + dice_.between(0.0, 3.0);
      if (taken || distance > least) continue;
      best = &seat;
      least = distance;
    }
    return best;
  }

  Posture place(const Rig& rig) {
    const double lot = dice_.between(0.0, 1.0);
    const Seat* seat = lot < 0.25 ? freeSeat() : nullptr;
    if (seat != nullptr) {
      places_.push_back(seat->at);
      return seated(rig, *seat, endless_, dice_);
    }
    const Vector2d at = freePlace();
    places_.push_back(at);
    if (lot > 0.94) {
      Posture posture = lying(rig, room_, at, endless_, dice_);
      places_.back() =
          (posture[index(Bone::pelvis)] * rig.start[index(Bone::pelvis)]).head<2>().cast<double>();
      return posture;
    }
    Posture posture = drawUpright(rig, endless_, dice_);
    const double yaw = dice_.between(0.0, 2.0 * M_PI);
    const float lean = static_cast<float>(dice_.between(0.2, 1.1));
    if (lot > 0.90) topple(rig, lean, dice_, posture);
    moveBody(carriage(Vector2d::Zero(), 0.0, at, yaw), posture);
    return posture;
  }

  const PersonRoom& room_;
  const Walkway& walkway_;
  Walkway endless_;  ///< no walls, no furniture: ways are straight
  const std::vector<Avatar>& cast_;
  Dice& dice_;
  Vector2d middle_ = Vector2d::Zero();
  double spread_m_ = 1.0;
  std::vector<Vector2d> places_;
};

}  // namespace

std::vector<Avatar> drawCast(int count, Dice& dice) {
  std::vector<Avatar> cast;
  cast.reserve(static_cast<std::size_t>(count));
  for (int i = 0; i < count; ++i) {
    Build build;
    const bool child = dice.chance(0.1);
    build.height_m = child ? dice.between(1.05, 1.5) : dice.between(1.48, 2.0);
    build.stoutness = dice.between(0.8, dice.chance(0.25) ? 1.45 : 1.2);
    build.feminine = dice.chance(0.5);
    const std::uint32_t look = dice.next();
    Outfit outfit = drawOutfit(look, build.feminine);
    outfit.garments = drawGarments(look);
    cast.emplace_back(build, outfit, kCoarseness);
  }
  return cast;
}

Arrangement arrange(const PersonRoom& room, const Walkway& walkway, const std::vector<Avatar>& cast,
                    Dice& dice) {
  return Arranger(room, walkway, cast, dice).arrange();
}

}  // namespace pf::simulator
