// SPDX-License-Identifier: BSD-3-Clause
#include "posefusion/io/trajectory_file.hpp"

#include <algorithm>
#include <array>
#include <cctype>
#include <cmath>
#include <cstdlib>
#include <iomanip>
#include <limits>
#include <sstream>

#include "posefusion/core/error.hpp"
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
  Eigen::Quaterniond q(v[6], v[3], v[4], v[5]);
  if (std::abs(q.norm() - 1.0) > 0.05) throw InputError("the quaternion is not of unit length");
  pose.T_world_camera.linear() = q.normalized().toRotationMatrix();
  pose.T_world_camera.translation() = Eigen::Vector3d(v[0], v[1], v[2]);
  return pose;
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
  std::ostream& out = file.stream();
  if (!comment.empty()) out << "# " << comment << '\n';
  out << "# timestamp tx ty tz qx qy qz qw\n" << std::setprecision(9);
  for (const StampedPose& pose : trajectory) {
    const Eigen::Vector3d t = pose.T_world_camera.translation();
    Eigen::Quaterniond q(pose.T_world_camera.linear());
    q.normalize();
    if (q.w() < 0) q.coeffs() = -q.coeffs();
    out << formatStamp(pose.stamp_ns) << ' ' << t.x() << ' ' << t.y() << ' ' << t.z() << ' '
        << q.x() << ' ' << q.y() << ' ' << q.z() << ' ' << q.w() << '\n';
  }
  file.commit();
}

}  // namespace pf
