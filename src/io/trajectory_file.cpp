// SPDX-License-Identifier: BSD-3-Clause
#include "posefusion/io/trajectory_file.hpp"

#include <fcntl.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <cmath>
#include <cstdio>
#include <cstring>
#include <filesystem>
#include <iomanip>
#include <sstream>

#include "posefusion/core/error.hpp"
#include "posefusion/core/se3.hpp"
#include "posefusion/core/stamps.hpp"
#include "posefusion/io/files.hpp"

namespace pf {
namespace {

std::array<double, 7> parsePose(std::istringstream& fields) {
  std::array<double, 7> values{};
  for (double& value : values) {
    std::string text;
    if (!(fields >> text)) throw InputError("expected 8 numbers: stamp tx ty tz qx qy qz qw");
    std::istringstream number(text);
    if (!(number >> value) || !number.eof() || !std::isfinite(value)) {
      throw InputError("'" + text + "' is no number");
    }
  }
  std::string rest;
  if (fields >> rest) throw InputError("more than 8 numbers");
  return values;
}

StampedPose parseLine(std::string line) {
  std::replace(line.begin(), line.end(), ',', ' ');
  std::istringstream fields(line);
  std::string stamp;
  fields >> stamp;
  StampedPose pose;
  pose.stamp_ns = parseStamp(stamp);
  const auto v = parsePose(fields);
  const auto rotation = rotationOf({v[6], v[3], v[4], v[5]});
  if (!rotation) throw InputError("the quaternion is not of unit length");
  pose.T_world_camera.linear() = *rotation;
  pose.T_world_camera.translation() = Eigen::Vector3d(v[0], v[1], v[2]);
  return pose;
}

std::string headOf(const std::string& comment) {
  return (comment.empty() ? "" : "# " + comment + '\n') + "# timestamp tx ty tz qx qy qz qw\n";
}

void writeLine(std::ostream& out, const StampedPose& pose) {
  const Eigen::Vector3d t = pose.T_world_camera.translation();
  Eigen::Quaterniond q(pose.T_world_camera.linear());
  q.normalize();
  if (q.w() < 0) q.coeffs() = -q.coeffs();
  out << std::setprecision(9) << formatStamp(pose.stamp_ns) << ' ' << t.x() << ' ' << t.y() << ' '
      << t.z() << ' ' << q.x() << ' ' << q.y() << ' ' << q.z() << ' ' << q.w() << '\n';
}

}  // namespace

Trajectory loadTrajectory(const std::string& path) {
  std::istringstream file(readFile(path));
  Trajectory trajectory;
  std::string line;
  for (int number = 1; std::getline(file, line); ++number) {
    const auto first = line.find_first_not_of(" \t\r");
    if (first == std::string::npos || line[first] == '#') continue;
    try {
      trajectory.push_back(parseLine(line));
    } catch (const InputError& error) {
      throw InputError(path + ":" + std::to_string(number) + ": " + error.what());
    }
  }
  std::stable_sort(trajectory.begin(), trajectory.end(),
                   [](const auto& a, const auto& b) { return a.stamp_ns < b.stamp_ns; });
  return trajectory;
}

void saveTrajectory(const std::string& path, const Trajectory& trajectory,
                    const std::string& comment) {
  AtomicFile file(path);
  file.stream() << headOf(comment);
  for (const StampedPose& pose : trajectory) writeLine(file.stream(), pose);
  file.commit();
}

TrajectoryJournal::TrajectoryJournal(const std::string& path, const std::string& comment)
    : path_(path), synced_(std::chrono::steady_clock::now()) {
  std::error_code ignored;
  std::filesystem::rename(path, path + ".old", ignored);  // most often there is none
  fd_ = open(path.c_str(), O_WRONLY | O_CREAT | O_TRUNC | O_CLOEXEC, 0666);
  if (fd_ < 0 || !append(headOf(comment))) {
    const std::string reason = std::strerror(errno);
    if (fd_ >= 0) close(fd_);
    throw InputError(path + ": cannot be written: " + reason);
  }
}

TrajectoryJournal::~TrajectoryJournal() {
  if (syncing_.valid()) syncing_.wait();
  if (fd_ >= 0) close(fd_);
}

bool TrajectoryJournal::add(const StampedPose& pose) {
  std::ostringstream line;
  writeLine(line, pose);
  if (fd_ < 0 || !append(line.str())) return false;
  syncNowAndThen();
  return true;
}

bool TrajectoryJournal::append(const std::string& text) {
  const ssize_t written = write(fd_, text.data(), text.size());
  if (written == static_cast<ssize_t>(text.size())) {
    size_ += written;
    return true;
  }
  const int error = written < 0 ? errno : ENOSPC;
  if (ftruncate(fd_, size_) == 0) lseek(fd_, size_, SEEK_SET);  // no half lines
  errno = error;
  return false;
}

void TrajectoryJournal::syncNowAndThen() {
  const auto now = std::chrono::steady_clock::now();
  if (now - synced_ < std::chrono::seconds(1)) return;
  if (syncing_.valid() && syncing_.wait_for(std::chrono::seconds(0)) != std::future_status::ready) {
    return;  // a slow disk
  }
  synced_ = now;
  syncing_ = std::async(std::launch::async, [fd = fd_] { fdatasync(fd); });
}

void TrajectoryJournal::remove() {
  if (fd_ >= 0) std::remove(path_.c_str());
}

}  // namespace pf
