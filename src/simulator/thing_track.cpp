// SPDX-License-Identifier: BSD-3-Clause
#include "simulator/thing_track.hpp"

#include <algorithm>
#include <cmath>

#include "simulator/actor.hpp"

namespace pf::simulator {
namespace {

constexpr double kMoving_s = 0.1;  // a pose that changes within this time moves

}  // namespace

void ThingTrack::freeze() {
  for (Step& step : steps_) step = {steps_.front().pose, kAtRest};
}

ThingPose ThingTrack::at(double time_s) const {
  const double x = std::clamp(time_s / kActorStep_s, 0.0, static_cast<double>(steps_.size() - 2));
  const auto i = static_cast<std::size_t>(x);
  return interpolate(steps_[i].pose, steps_[i + 1].pose, x - static_cast<double>(i));
}

bool ThingTrack::changesAfter(std::size_t step) const {
  return steps_[step].mover != kAtRest ||
         (step + 1 < steps_.size() && !(steps_[step].pose == steps_[step + 1].pose));
}

bool ThingTrack::isMoving(double time_s) const {
  const auto last = static_cast<double>(steps_.size() - 1);
  const double from = std::clamp((time_s - kMoving_s) / kActorStep_s, 0.0, last);
  const double to = std::clamp((time_s + kMoving_s) / kActorStep_s, 0.0, last);
  for (auto i = static_cast<std::size_t>(from); i <= static_cast<std::size_t>(to); ++i) {
    if (changesAfter(i)) return true;
  }
  return false;
}

double ThingTrack::speed(double time_s) const {
  return (at(time_s + kActorStep_s).at_m - at(time_s).at_m).norm() / kActorStep_s;
}

std::vector<ThingChange> ThingTrack::changes(double from_s, double to_s) const {
  std::vector<ThingChange> changes;
  const auto first = static_cast<std::size_t>(std::max(0.0, from_s / kActorStep_s));
  const auto end = std::min(steps_.size(), static_cast<std::size_t>(to_s / kActorStep_s) + 1);
  for (std::size_t i = first; i < end; ++i) {
    if (!changesAfter(i)) continue;
    ThingChange change;
    change.begin_s = static_cast<double>(i) * kActorStep_s;
    change.from = steps_[i].pose;
    change.mover = kItself;
    for (; i < end && changesAfter(i); ++i) change.mover = std::max(change.mover, steps_[i].mover);
    change.is_over = i < end;
    i = std::min(i, end - 1);
    change.end_s = std::min(to_s, static_cast<double>(i) * kActorStep_s);
    change.to = at(change.end_s);
    changes.push_back(change);
  }
  return changes;
}

std::vector<double> ThingTrack::knots(double from_s, double to_s) const {
  std::vector<double> times{from_s};
  const auto first = static_cast<std::size_t>(std::max(0.0, from_s / kActorStep_s)) + 1;
  for (std::size_t i = first; i + 1 < steps_.size(); ++i) {
    const double time_s = static_cast<double>(i) * kActorStep_s;
    if (time_s >= to_s) break;
    const bool is_knot =
        !(steps_[i - 1].pose == steps_[i].pose) || !(steps_[i].pose == steps_[i + 1].pose);
    if (is_knot && time_s > from_s) times.push_back(time_s);
  }
  times.push_back(to_s);
  return times;
}

}  // namespace pf::simulator
