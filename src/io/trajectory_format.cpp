// SPDX-License-Identifier: BSD-3-Clause
#include "posefusion/io/trajectory_format.hpp"

#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>
#include <sstream>
#include <utility>

#include "number_text.hpp"
#include "posefusion/core/error.hpp"
#include "posefusion/core/se3.hpp"
#include "posefusion/core/stamps.hpp"
#include "posefusion/io/files.hpp"
#include "posefusion/io/trajectory_file.hpp"

namespace pf {
namespace {

constexpr std::size_t kKittiColumns = 12, kTumColumns = 8;

struct Line {
  int number = 0;  ///< in the file, from 1 on
  bool has_commas = false;
  std::vector<std::string> words;
};

std::vector<Line> linesOf(const std::string& path) {
  std::istringstream file(readFile(path));
  std::vector<Line> lines;
  std::string text;
  for (int number = 1; std::getline(file, text); ++number) {
    Line line{number, text.find(',') != std::string::npos, {}};
    std::replace(text.begin(), text.end(), ',', ' ');
    std::istringstream words(text);
    for (std::string word; words >> word;) line.words.push_back(word);
    if (!line.words.empty() && line.words[0][0] != '#') lines.push_back(std::move(line));
  }
  return lines;
}

StampedPose kittiPose(const Line& line, std::size_t index) {
  if (line.words.size() != kKittiColumns) {
    throw InputError(std::to_string(line.words.size()) + " numbers, expected 12: a pose's matrix");
  }
  StampedPose pose;
  pose.stamp_ns = static_cast<std::int64_t>(index) * kSecond_ns;
  for (int i = 0; i < 12; ++i) {
    pose.T_world_camera(i / 4, i % 4) = parseNumber(line.words[static_cast<std::size_t>(i)]);
  }
  const Eigen::Matrix3d R = pose.T_world_camera.linear();
  const double off = (R * R.transpose() - Eigen::Matrix3d::Identity()).norm();
  if (!(off < 1e-2) || R.determinant() < 0) {
    throw InputError("the first three columns are no rotation");
  }
  return pose;
}

StampedPose eurocPose(const Line& line) {
  const auto& words = line.words;
  if (words.size() < kTumColumns) {
    throw InputError(std::to_string(words.size()) +
                     " columns, expected 8 or more: stamp (ns), tx, ty, tz, qw, qx, qy, qz");
  }
  StampedPose pose;
  const char* const end = words[0].data() + words[0].size();
  const auto [stop, error] = std::from_chars(words[0].data(), end, pose.stamp_ns);
  if (error != std::errc() || stop != end) {
    throw InputError("'" + words[0] + "' is no stamp, expected whole nanoseconds");
  }
  std::array<double, 7> v{};
  for (std::size_t i = 0; i < v.size(); ++i) v[i] = parseNumber(words[i + 1]);
  const auto rotation = rotationOf({v[3], v[4], v[5], v[6]});
  if (!rotation) throw InputError("the quaternion is not of unit length");
  pose.T_world_camera.linear() = *rotation;
  pose.T_world_camera.translation() = Eigen::Vector3d(v[0], v[1], v[2]);
  return pose;
}

TrajectoryFormat formatOf(const Line& line) {
  if (line.words.size() == kKittiColumns && !line.has_commas) return TrajectoryFormat::kitti;
  // Seconds have a point or fewer than 12 digits; nanoseconds since 1970 have 19.
  const bool is_ns = line.words[0].size() >= 12 && line.words[0].find('.') == std::string::npos;
  if (line.has_commas && is_ns) return TrajectoryFormat::euroc;
  return TrajectoryFormat::tum;
}

}  // namespace

const std::vector<std::string>& trajectoryFormats() {
  static const std::vector<std::string> words = {"auto", "tum", "kitti", "euroc"};
  return words;
}

TrajectoryFormat trajectoryFormatNamed(const std::string& name) {
  const auto& words = trajectoryFormats();
  const auto found = std::find(words.begin(), words.end(), name);
  if (found == words.end()) {
    throw InputError("format is '" + name + "', expected one of auto, tum, kitti, euroc");
  }
  return static_cast<TrajectoryFormat>(found - words.begin());
}

ReadTrajectory readTrajectory(const std::string& path, TrajectoryFormat format) {
  const std::vector<Line> lines = linesOf(path);
  if (format == TrajectoryFormat::automatic && !lines.empty()) format = formatOf(lines.front());
  const bool is_kitti = format == TrajectoryFormat::kitti;
  if (!is_kitti && format != TrajectoryFormat::euroc) return {loadTrajectory(path), true};
  ReadTrajectory read{{}, !is_kitti};
  for (const Line& line : lines) {
    try {
      read.poses.push_back(is_kitti ? kittiPose(line, read.poses.size()) : eurocPose(line));
    } catch (const InputError& error) {
      throw InputError(path + ":" + std::to_string(line.number) + ": " + error.what());
    }
  }
  std::stable_sort(read.poses.begin(), read.poses.end(),
                   [](const auto& a, const auto& b) { return a.stamp_ns < b.stamp_ns; });
  return read;
}

}  // namespace pf
