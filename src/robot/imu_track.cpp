// SPDX-License-Identifier: BSD-3-Clause
#include "posefusion/robot/imu_track.hpp"

#include <algorithm>
#include <cmath>

#include "posefusion/core/stamps.hpp"

namespace pf {
namespace {

constexpr double kImuKept_s = 10.0, kImuCarriedOn_s = 0.02;
// Less weight than gravity for so long: a step while walking is shorter.
constexpr double kFreeFall_s = 0.08;
constexpr double kBiasMemory_s = 20.0, kMostBias_rad_s = 0.2;
// The shift is not measured: wider than any motion of a robot between two frames.
constexpr double kAnyShift_m = 10.0;

}  // namespace

std::string ImuTrack::add(const ImuSample& sample) {
  if (!sample.rate_rad_s.allFinite() || !sample.acceleration_m_s2.allFinite()) {
    return "the sample is not finite";
  }
  if (!samples_.empty() && sample.stamp_ns <= samples_.back().stamp_ns) {
    return "stamp " + formatStamp(sample.stamp_ns) + " is not later than the one before, " +
           formatStamp(samples_.back().stamp_ns);
  }
  samples_.push_back(sample);
  while (secondsBetween(samples_.front().stamp_ns, sample.stamp_ns) > kImuKept_s) {
    samples_.pop_front();
  }
  watch(sample);
  return {};
}

void ImuTrack::watch(const ImuSample& sample) {
  const double felt_m_s2 = sample.acceleration_m_s2.norm();
  if (felt_m_s2 >= config_.free_fall_m_s2) light_since_ns_.reset();
  if (felt_m_s2 < config_.free_fall_m_s2 && !light_since_ns_) light_since_ns_ = sample.stamp_ns;
  const bool falls =
      light_since_ns_ && secondsBetween(*light_since_ns_, sample.stamp_ns) >= kFreeFall_s;
  if (falls || felt_m_s2 > config_.impact_m_s2) fell_ns_ = sample.stamp_ns;
}

bool ImuTrack::isFalling(std::int64_t now_ns) const {
  return fell_ns_ && secondsBetween(*fell_ns_, now_ns) < config_.after_fall_s;
}

/// The rate at a moment between two samples, or just after the last.
std::optional<Eigen::Vector3d> ImuTrack::rateAt(std::int64_t stamp_ns) const {
  if (samples_.size() < 2 || stamp_ns < samples_.front().stamp_ns) return std::nullopt;
  const auto after = std::lower_bound(samples_.begin(), samples_.end(), stamp_ns,
                                      [](const auto& s, std::int64_t t) { return s.stamp_ns < t; });
  if (after == samples_.begin()) return after->rate_rad_s;
  const ImuSample& a = *(after - 1);
  if (after == samples_.end()) {
    if (secondsBetween(a.stamp_ns, stamp_ns) > kImuCarriedOn_s) return std::nullopt;
    return a.rate_rad_s;
  }
  const double part =
      secondsBetween(a.stamp_ns, stamp_ns) / secondsBetween(a.stamp_ns, after->stamp_ns);
  return Eigen::Vector3d(a.rate_rad_s + part * (after->rate_rad_s - a.rate_rad_s));
}

std::pair<ImuTrack::Place, ImuTrack::Place> ImuTrack::within(std::int64_t from_ns,
                                                             std::int64_t to_ns) const {
  const auto after = [this](std::int64_t stamp_ns) {
    return std::upper_bound(samples_.begin(), samples_.end(), stamp_ns,
                            [](std::int64_t t, const auto& s) { return t < s.stamp_ns; });
  };
  return {after(from_ns), after(to_ns)};
}

std::optional<Eigen::Matrix3d> ImuTrack::turnBetween(std::int64_t from_ns, std::int64_t to_ns,
                                                     const Eigen::Vector3d& bias_rad_s) const {
  const auto first = rateAt(from_ns), last = rateAt(to_ns);
  if (!first || !last || from_ns >= to_ns) return std::nullopt;
  Eigen::Matrix3d R = Eigen::Matrix3d::Identity();
  std::int64_t at_ns = from_ns;
  Eigen::Vector3d rate = *first;
  const auto advance = [&](std::int64_t next_ns, const Eigen::Vector3d& next) {
    const double step_s = secondsBetween(at_ns, next_ns);
    R *= expSo3(step_s * (0.5 * (rate + next) - bias_rad_s));
    at_ns = next_ns;
    rate = next;
    return step_s <= config_.imu_max_gap_s && next.norm() < config_.gyro_full_scale_rad_s;
  };
  for (auto [sample, end] = within(from_ns, to_ns - 1); sample != end; ++sample) {
    if (!advance(sample->stamp_ns, sample->rate_rad_s)) return std::nullopt;
  }
  if (!advance(to_ns, *last)) return std::nullopt;
  return R;
}

std::optional<MotionPrior> ImuTrack::between(std::int64_t from_ns, std::int64_t to_ns) const {
  const auto turn = turnBetween(from_ns, to_ns, bias_rad_s_);
  if (!turn) return std::nullopt;
  const double elapsed_s = secondsBetween(from_ns, to_ns);
  MotionPrior prior;
  prior.T_before_after.linear() = *turn;
  prior.covariance =
      independentCovariance(kAnyShift_m, std::hypot(config_.gyro_noise_rad_s * std::sqrt(elapsed_s),
                                                    config_.gyro_bias_rad_s * elapsed_s));
  return prior;
}

std::optional<Eigen::Vector3d> ImuTrack::feltBetween(std::int64_t from_ns,
                                                     std::int64_t to_ns) const {
  if (isFalling(to_ns)) return std::nullopt;
  const auto [first, last] = within(from_ns, to_ns);
  if (last <= first) return std::nullopt;
  Eigen::Vector3d sum = Eigen::Vector3d::Zero();
  for (auto sample = first; sample != last; ++sample) sum += sample->acceleration_m_s2;
  return Eigen::Vector3d(sum / static_cast<double>(last - first));
}

void ImuTrack::learnBias(std::int64_t from_ns, std::int64_t to_ns,
                         const Eigen::Matrix3d& R_before_after) {
  const auto turn = turnBetween(from_ns, to_ns, Eigen::Vector3d::Zero());
  if (!turn) return;
  const double elapsed_s = secondsBetween(from_ns, to_ns);
  const Eigen::Vector3d bias = logSo3(R_before_after.transpose() * *turn) / elapsed_s;
  if (bias.norm() > kMostBias_rad_s) return;
  learned_s_ = std::min(kBiasMemory_s, learned_s_ + elapsed_s);
  bias_rad_s_ += elapsed_s / learned_s_ * (bias - bias_rad_s_);
}

}  // namespace pf
