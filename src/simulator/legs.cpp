// SPDX-License-Identifier: BSD-3-Clause
#include "simulator/legs.hpp"

#include <cmath>
#include <optional>

#include "simulator/random.hpp"

namespace pf::simulator {
namespace {

using Eigen::AngleAxisd;
using Eigen::Isometry3d;
using Eigen::Vector3d;

// Uses of the seed.
enum LegPurpose : std::uint32_t { kScale = 1, kTurn, kDrift, kHeading, kSlip, kSlipTurn, kFall };

constexpr double kSlip_s = 0.25;
constexpr double kStepping_m_s = 0.05;  // slower is balance
constexpr double kRadians = M_PI / 180.0;

double square(double x) { return x * x; }

Vector3d turned(double yaw_rad, const Vector3d& v) {
  return AngleAxisd(yaw_rad, Vector3d::UnitZ()) * v;
}

/// A motion of the body: of its place in the world, and of its heading.
struct Motion {
  Vector3d way_m = Vector3d::Zero();
  double turn_rad = 0.0;
};

/// A motion between two samples.
struct Step {
  Motion truth;  ///< in the frame that the body believes to be the world
  double end_s = 0.0;
  double length_s = 0.0;
  double walked_m = 0.0;  ///< of it, so much is no balance
  std::uint32_t index = 0;
};

/// Of what is drawn anew with every step.
LegVariance driftOf(const LegsConfig& c, double way_m, double turned_rad) {
  return {square(c.drift_m_per_m) * way_m,
          square(c.drift_deg_per_m * kRadians) * way_m +
              square(c.drift_deg_per_turn * kRadians) * turned_rad / (2.0 * M_PI)};
}

/// What legs believe of each motion.
class Belief {
 public:
  Belief(const CameraPath& path, const LegsConfig& config, std::uint32_t seed)
      : c_(config), seed_(seed), falls_(path.events()) {
    scale_ = 1.0 + 0.01 * c_.scale_percent * between(hash(seed_, kScale), -1.0, 1.0);
    turn_scale_ = 1.0 + 0.01 * c_.turn_percent * between(hash(seed_, kTurn), -1.0, 1.0);
  }

  Motion of(const Step& step) const {
    for (std::size_t i = 0; c_.falls_confuse && i < falls_.size(); ++i) {
      if (step.end_s <= falls_[i].start_s || step.end_s > falls_[i].end_s) continue;
      return inFall(step, falls_[i], hash(seed_, kFall, static_cast<std::uint32_t>(i)));
    }
    Motion sensed = step.truth;
    sensed.way_m.head<2>() *= scale_;
    sensed.turn_rad *= turn_scale_;
    const LegVariance spread = driftOf(c_, step.walked_m, std::abs(step.truth.turn_rad));
    for (std::uint32_t k = 0; k < 3; ++k) {
      sensed.way_m[k] += std::sqrt(spread.place_m2) * gaussian(hash(seed_, kDrift, step.index, k));
    }
    sensed.turn_rad += std::sqrt(spread.heading_rad2) * gaussian(hash(seed_, kHeading, step.index));
    return sensed;
  }

  /// A step that is not there: ahead of the body, and about it.
  Motion slipIn(const Step& step) const {
    const double t = step.end_s;
    if (c_.slip_every_s <= 0.0 || step.walked_m <= 0.0) return {};
    const auto window = static_cast<std::uint32_t>(std::max(0.0, t) / c_.slip_every_s);
    const double longest = std::max(0.0, c_.slip_every_s - kSlip_s);
    const double begin =
        window * c_.slip_every_s + between(hash(seed_, kSlip, window), 0.0, longest);
    if (t < begin || t >= begin + kSlip_s) return {};
    const double part = step.length_s / kSlip_s;
    const double length = between(hash(seed_, kSlip, window, 1U), 0.3, 1.0) * c_.slip_m;
    const double angle =
        between(hash(seed_, kSlipTurn, window), -1.0, 1.0) * c_.slip_deg * kRadians;
    return {part * length * Vector3d::UnitX(), part * angle};
  }

 private:
  Motion inFall(const Step& step, const Event& fall, std::uint32_t luck) const {
    switch (luck % 3U) {
      case 0: {  // the legs thrash about
        const auto shake = [&](std::uint32_t salt) {
          return step.length_s * tremble(step.end_s, 0.3, 3.0, hash(luck, salt));
        };
        return {c_.fall_m_s * Vector3d(shake(1U), shake(2U), 0.0),
                c_.fall_deg_s * kRadians * shake(3U)};
      }
      case 1:  // they stand
        return {};
      default: {  // the body is suddenly elsewhere
        const double when = between(hash(luck, 4U), fall.start_s + 0.3, fall.end_s - 0.1);
        if (when <= step.end_s - step.length_s || when > step.end_s) return {};
        const double direction = between(hash(luck, 5U), 0.0, 2.0 * M_PI);
        const double part = between(hash(luck, 6U), 0.5, 1.0);
        return {part * c_.fall_jump_m * Vector3d(std::cos(direction), std::sin(direction), 0.0),
                between(hash(luck, 7U), -1.0, 1.0) * c_.fall_jump_deg * kRadians};
      }
    }
  }

  const LegsConfig& c_;
  std::uint32_t seed_;
  std::vector<Event> falls_;
  double scale_ = 1.0, turn_scale_ = 1.0;
};

/// Puts what is believed together.
class Counter {
 public:
  Counter(const CameraPath& path, const LegsConfig& config, std::uint32_t seed)
      : belief_(path, config, seed) {}

  LegSample add(double t, const Isometry3d& T_world_base, std::uint32_t index) {
    const double heading = headingOf(T_world_base.linear());
    if (!before_) off_rad_ = -heading;
    if (before_) advance(t, T_world_base, heading, index);
    before_ = {t, T_world_base};
    sample_.time_s = t;
    sample_.T_odom_base.linear() =
        AngleAxisd(off_rad_, Vector3d::UnitZ()).toRotationMatrix() * T_world_base.linear();
    return sample_;
  }

 private:
  struct Moment {
    double time_s = 0.0;
    Isometry3d T_world_base = Isometry3d::Identity();
  };

  void advance(double t, const Isometry3d& T_world_base, double heading, std::uint32_t index) {
    const Vector3d way_m = T_world_base.translation() - before_->T_world_base.translation();
    const double turn_rad =
        std::remainder(heading - headingOf(before_->T_world_base.linear()), 2.0 * M_PI);
    Step step{{turned(off_rad_, way_m), turn_rad}, t, t - before_->time_s, 0.0, index};
    const double length_m = way_m.head<2>().norm();
    if (length_m > kStepping_m_s * step.length_s) step.walked_m = length_m;
    const Motion sensed = belief_.of(step), slip = belief_.slipIn(step);
    off_rad_ += sensed.turn_rad + slip.turn_rad - turn_rad;
    sample_.T_odom_base.translation() += sensed.way_m + turned(off_rad_ + heading, slip.way_m);
    sample_.way_m += step.walked_m;
    sample_.turned_rad += std::abs(turn_rad);
  }

  Belief belief_;
  std::optional<Moment> before_;
  double off_rad_ = 0.0;  // the world's x axis, seen in `odom`
  LegSample sample_;
};

}  // namespace

std::vector<LegSample> senseLegs(const CameraPath& path, const LegsConfig& config,
                                 const TimeSpan& span, std::uint32_t seed) {
  const Body body(path, config, span);
  Counter counter(path, config, seed);
  std::vector<LegSample> samples(momentCount(span, config.rate_hz));
  for (std::size_t i = 0; i < samples.size(); ++i) {
    const double t = span.start_s + static_cast<double>(i) / config.rate_hz;
    const BodyPose pose = body.at(t);
    samples[i] = counter.add(t, pose.T_world_base, static_cast<std::uint32_t>(i));
    samples[i].neck = encoded(config, pose.neck);
    samples[i].T_base_camera = baseFromCamera(config, samples[i].neck);
  }
  return samples;
}

LegVariance varianceOf(const LegsConfig& c, double way_m, double turned_rad) {
  LegVariance variance = driftOf(c, way_m, turned_rad);
  // Of a uniform spread.
  variance.place_m2 += square(0.01 * c.scale_percent * way_m) / 3.0;
  variance.heading_rad2 += square(0.01 * c.turn_percent * turned_rad) / 3.0;
  return variance;
}

}  // namespace pf::simulator
