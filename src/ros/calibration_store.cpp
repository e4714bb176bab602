// SPDX-License-Identifier: BSD-3-Clause
#include "posefusion_ros/calibration_store.hpp"

#include <algorithm>
#include <cstdlib>
#include <filesystem>
#include <string_view>

#include "posefusion/core/error.hpp"
#include "posefusion/io/calibration_file.hpp"
#include "posefusion/io/files.hpp"

namespace posefusion_ros {
namespace {

namespace fs = std::filesystem;

constexpr char kBelowHome[] = "posefusion/cameras";
constexpr char kEnding[] = ".yaml";
constexpr std::size_t kLongestName = 200;  // file systems take 255 bytes

/// Empty where it is not set.
std::string environment(const char* name) {
  const char* const value = std::getenv(name);
  return value == nullptr ? "" : value;
}

bool fitsIntoFileName(char c) {
  constexpr std::string_view kOthers = "-_.";
  return (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || (c >= '0' && c <= '9') ||
         kOthers.find(c) != std::string_view::npos;
}

std::string asFileName(std::string name) {
  name = name.substr(0, kLongestName);
  std::replace_if(
      name.begin(), name.end(), [](char c) { return !fitsIntoFileName(c); }, '_');
  if (!name.empty() && name.front() == '.') name.front() = '_';  // hidden, or another folder
  return name;
}

}  // namespace

CalibrationStoreSettings readCalibrationStore(Parameters& parameters, bool is_on) {
  CalibrationStoreSettings s;
  s.folder = parameters.text("calibration_folder", is_on ? defaultCalibrationFolder() : "");
  s.serial = parameters.text("camera_serial", "");
  return s;
}

std::string defaultCalibrationFolder() {
  const std::string ros = environment("ROS_HOME"), user = environment("HOME");
  if (ros.empty() && user.empty()) return {};
  return (fs::path(ros.empty() ? user + "/.ros" : ros) / kBelowHome).string();
}

double errorAt2mMm(const pf::DepthCalibration& calibration) {
  constexpr double kMmByInverseDepth = 1000.0 * 2.0 * 2.0;  // an error of 1/z times z^2
  return kMmByInverseDepth * calibration.field.rms();
}

void CalibrationStore::setFrame(const std::string& frame_id) {
  name_ = settings_.serial.empty() ? frame_id : settings_.serial;
  if (settings_.folder.empty() || name_.empty()) return file_.clear();
  file_ = (fs::path(settings_.folder) / (asFileName(name_) + kEnding)).string();
}

std::optional<pf::DepthCalibration> CalibrationStore::find(const pf::PinholeCamera& camera) const {
  std::error_code ignored;
  if (file_.empty() || !fs::exists(file_, ignored)) return std::nullopt;
  pf::DepthCalibration found = pf::loadCalibration(file_);
  const std::string defect = pf::misfit(found, camera);
  if (!defect.empty()) throw pf::InputError(file_ + ": the calibration of depth " + defect);
  return found;
}

void CalibrationStore::keep(pf::DepthCalibration calibration) const {
  if (file_.empty()) return;
  if (calibration.name.empty()) calibration.name = name_;
  pf::makeFolder(settings_.folder);
  pf::saveCalibration(file_, calibration);
}

}  // namespace posefusion_ros
