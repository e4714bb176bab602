// SPDX-License-Identifier: BSD-3-Clause
// What a session knows of its depth camera, and keeps for the next one.
#include <cstdio>

#include "posefusion/core/error.hpp"
#include "posefusion_ros/mapping_session.hpp"

namespace posefusion_ros {
namespace {

constexpr char kLearned[] = "learned";

}  // namespace

/// From now on depth is corrected by what that file says.
void MappingSession::noteCorrection(const std::string& file) {
  corrected_by_ = file;
  char amount[48];
  std::snprintf(amount, sizeof amount, "%.1f mm at 2 m", errorAt2mMm(*mapper_->calibration()));
  notices_.push_back({false, "depth is corrected by " + file + ": " + amount});
}

/// Before the first frame: applies the stored calibration of its camera, where there is no other. A
/// map whose file is written on stays as it was measured.
void MappingSession::recallCamera(const std::string& frame_id) {
  if (isLoaded() && !pf::isSameCamera(camera_, seen_)) return;  // not the one that this is about
  is_camera_named_ = true;
  store_.setFrame(frame_id);
  if (mapper_->calibration() || !config_.calibration.corrects() || is_continued_) return;
  try {
    const auto known = store_.find(seen_);
    if (!known) return;
    if (isLoaded()) {
      mapper_ = begunIn(mapper_->saved(camera_), map_file_, use_, known);
      loops_.reset();
    } else {
      mapper_->calibrate(*known);
    }
    noteCorrection(store_.file());
  } catch (const std::exception& error) {
    notices_.push_back({true, std::string(error.what()) + "; going on without it"});
  }
}

/// Where more is known than at that Mapper::depthVersion().
void MappingSession::keepWhatWasLearned(int version_before) {
  if (mapper_->depthVersion() == version_before) return;
  corrected_by_ = kLearned;
  std::string text = "learned: " + mapper_->lastCalibration();
  is_unkept_ = false;
  try {
    store_.keep(*mapper_->calibration());
    if (!store_.file().empty()) text += "; kept in " + store_.file();
  } catch (const std::exception& error) {
    is_unkept_ = true;
    notices_.push_back(
        {true, std::string("what was learned of depth is not kept: ") + error.what()});
  }
  notices_.push_back({false, text});
}

void MappingSession::askForCalibration() {
  if (use_ == pf::MapUse::localize_only) {
    throw pf::InputError("localisation: the map does not change, and nothing is learned");
  }
  if (!config_.loop.enabled) {
    throw pf::InputError("loop.enabled is false: the loop closer, which would learn, is not asked");
  }
  const std::string doubt = mapper_->askForCalibration();
  if (!doubt.empty()) throw pf::InputError(doubt);
}

CalibrationProgress MappingSession::calibrationProgress() const {
  return {frames_, loops_.unanswered(), mapper_->depthVersion(), mapper_->lastCalibration()};
}

}  // namespace posefusion_ros
