// SPDX-License-Identifier: BSD-3-Clause
#include "posefusion/robot/robot_motion.hpp"

#include <utility>

#include "posefusion/core/stamps.hpp"

namespace pf {
namespace {

void count(MotionSourceReport& report, std::string why_left_out) {
  ++report.received;
  if (why_left_out.empty()) return;
  ++report.left_out;
  report.why_left_out = std::move(why_left_out);
}

void count(MotionSourceReport& report, bool is_there) {
  if (report.received > 0) ++(is_there ? report.told : report.missing);
}

}  // namespace

void RobotMotion::addOdometry(const StampedPose& pose) {
  count(odometry_report_, odometry_.add(pose));
}

void RobotMotion::addImu(const ImuSample& sample) { count(imu_report_, imu_.add(sample)); }

std::optional<MotionPrior> RobotMotion::between(std::int64_t from_ns, std::int64_t to_ns) {
  if (imu_.isFalling(to_ns)) odometry_trust_.doubt();
  const auto by_odometry = odometry_.between(from_ns, to_ns);
  const auto by_imu = imu_.between(from_ns, to_ns);
  count(odometry_report_, by_odometry.has_value());
  count(imu_report_, by_imu.has_value());
  std::optional<MotionPrior> known;
  if (by_odometry && odometry_trust_.isBelieved()) known = odometry_trust_.honest(*by_odometry);
  if (!by_imu || !imu_trust_.isBelieved()) return known;
  const MotionPrior turn = imu_trust_.honest(*by_imu);
  // Legs slip, an inertial sensor does not.
  const auto both = known ? combined(*known, turn) : std::nullopt;
  return both ? both : turn;
}

void RobotMotion::compare(std::int64_t from_ns, std::int64_t to_ns, const Eigen::Isometry3d& T_seen,
                          const Matrix6d& covariance) {
  const double elapsed_s = secondsBetween(from_ns, to_ns);
  const auto by_odometry = odometry_.between(from_ns, to_ns);
  if (by_odometry && !imu_.isFalling(to_ns)) {
    odometry_trust_.compare(*by_odometry, T_seen, covariance, elapsed_s);
  }
  if (const auto by_imu = imu_.between(from_ns, to_ns)) {
    imu_trust_.compare(*by_imu, T_seen, covariance, elapsed_s);
    imu_.learnBias(from_ns, to_ns, T_seen.linear());
  }
  odometry_report_.is_believed = odometry_trust_.isBelieved();
  imu_report_.is_believed = imu_trust_.isBelieved();
}

void RobotMotion::restart() {
  odometry_.clear();
  imu_.clear();
  odometry_trust_ = imu_trust_ = {};
  odometry_report_.is_believed = imu_report_.is_believed = false;
}

}  // namespace pf
