// SPDX-License-Identifier: BSD-3-Clause
#include "posefusion/evaluation/trajectory.hpp"

#include <algorithm>
#include <array>
#include <cctype>
#include <cmath>
#include <cstdlib>
#include <iomanip>
#include <limits>
#include <sstream>

#include "posefusion/core/error.hpp"
#include "posefusion/io/files.hpp"

namespace posefusion {
namespace {

constexpr int kStampDigits = 9;  // nanoseconds

/// A decimal number as its digits and the place of its point: "12.5e1" is 125 with the point
/// after 3.
struct Decimal {
  bool negative = false;
  std::string digits;
  long point = 0;
};

[[noreturn]] void failStamp(const std::string& text) {
  throw InputError("'" + text + "' is no stamp, expected decimal seconds");
}

Decimal parseDecimal(const std::string& text) {
  Decimal decimal;
  std::size_t i = 0;
  if (i < text.size() && (text[i] == '-' || text[i] == '+')) decimal.negative = text[i++] == '-';
  bool past_point = false;
  for (; i < text.size() && (std::isdigit(static_cast<unsigned char>(text[i])) || text[i] == '.');
       ++i) {
    if (text[i] == '.') {
      if (past_point) failStamp(text);
      past_point = true;
      continue;
    }
    decimal.digits += text[i];
    if (!past_point) ++decimal.point;
  }
  if (decimal.digits.empty()) failStamp(text);
  if (i == text.size()) return decimal;
  if (text[i] != 'e' && text[i] != 'E') failStamp(text);
  const std::string exponent = text.substr(i + 1);
  std::size_t used = 0;
  int power = 0;
  try {
    power = std::stoi(exponent, &used);
  } catch (const std::exception&) {
    failStamp(text);
  }
  if (used != exponent.size() || std::abs(power) > 30) failStamp(text);
  decimal.point += power;
  return decimal;
}

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

std::int64_t parseStamp(const std::string& seconds) {
  const Decimal decimal = parseDecimal(seconds);
  const long count = decimal.point + kStampDigits;  // digits that make up the nanoseconds
  std::int64_t value = 0;
  for (long i = 0; i < count; ++i) {
    const int digit = i < static_cast<long>(decimal.digits.size())
                          ? decimal.digits[static_cast<std::size_t>(i)] - '0'
                          : 0;
    if (value > (std::numeric_limits<std::int64_t>::max() - digit) / 10) failStamp(seconds);
    value = 10 * value + digit;
  }
  // Digits beyond a nanosecond are rounded.
  if (count >= 0 && count < static_cast<long>(decimal.digits.size()) &&
      decimal.digits[static_cast<std::size_t>(count)] >= '5') {
    ++value;
  }
  return decimal.negative ? -value : value;
}

std::string formatStamp(std::int64_t stamp_ns) {
  const std::int64_t second = 1'000'000'000;
  const std::int64_t size = std::abs(stamp_ns);
  const bool micro = size % 1000 == 0;
  std::ostringstream text;
  text << (stamp_ns < 0 ? "-" : "") << size / second << '.' << std::setfill('0')
       << std::setw(micro ? 6 : 9) << (micro ? size % second / 1000 : size % second);
  return text.str();
}

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

}  // namespace posefusion
