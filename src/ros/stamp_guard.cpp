// SPDX-License-Identifier: BSD-3-Clause
#include "posefusion_ros/stamp_guard.hpp"

#include <cmath>
#include <iomanip>
#include <sstream>

#include "posefusion/core/stamps.hpp"

namespace posefusion_ros {
namespace {

std::string text(double value_s) {
  std::ostringstream out;
  out << std::fixed << std::setprecision(3) << value_s << " s";
  return out.str();
}

}  // namespace

bool StampGuard::follows(const Arrival& last, const Arrival& next) const {
  const double step_s = pf::secondsBetween(last.stamp_ns, next.stamp_ns);
  const double passed_s = std::chrono::duration<double>(next.time - last.time).count();
  return step_s > 0.0 && step_s <= passed_s + jump_s_;
}

std::string StampGuard::defectOf(std::int64_t stamp_ns, Time now) {
  if (stamp_ns <= 0) return "the stamp is 0";
  const Arrival next{stamp_ns, now};
  if (!last_ || follows(*last_, next) || (jump_ && follows(*jump_, next))) {
    last_ = next;
    jump_.reset();
    return {};
  }
  const double step_s = pf::secondsBetween(last_->stamp_ns, stamp_ns);
  if (step_s == 0.0) return "the stamp is that of the frame before";
  if (step_s < 0.0 && -step_s <= jump_s_) return "the stamp went back by " + text(-step_s);
  jump_ = next;
  return "the stamp jumps " + std::string(step_s < 0.0 ? "back" : "ahead") + " by " +
         text(std::abs(step_s)) + ": where the next frames go on from there it is followed";
}

// Cameras are not punctual: what comes up to a tenth of a period too early is due.
bool RateLimit::lets(std::int64_t stamp_ns) {
  const bool restart =
      !due_ns_ || stamp_ns > *due_ns_ + period_ns_ || stamp_ns < *due_ns_ - 2 * period_ns_;
  if (!restart && stamp_ns < *due_ns_ - period_ns_ / 10) return false;
  due_ns_ = (restart ? stamp_ns : *due_ns_) + period_ns_;
  return true;
}

}  // namespace posefusion_ros
