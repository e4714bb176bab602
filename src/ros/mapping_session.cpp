// SPDX-License-Identifier: BSD-3-Clause
#include "posefusion_ros/mapping_session.hpp"

#include <utility>

#include "posefusion/core/error.hpp"
#include "posefusion/io/calibration_file.hpp"

namespace posefusion_ros {
namespace {

using pf::InputError;
using pf::MapUse;

constexpr char kImages[] = "the images";

pf::AnswerTime answerTime(bool lossless) {
  return lossless ? pf::AnswerTime::after_lag : pf::AnswerTime::when_ready;
}

}  // namespace

MappingSettings readMapping(Parameters& parameters) {
  MappingSettings s;
  s.config = parameters.config(
      {"sensor", "frame", "tracking", "robot", "map", "loop", "graph", "calibration"});
  s.lossless = parameters.flag("lossless", false);
  s.saver = readMapSaver(parameters);
  s.saver.settings = pf::toYaml(s.config);
  s.map_file = parameters.text("map_file", "");
  s.calibration_file = parameters.text("calibration_file", "");
  // A lossless replay equals the offline run: it uses nothing but its arguments.
  s.store = readCalibrationStore(parameters, !s.lossless);
  s.localize_only = parameters.flag("localize_only", false);
  s.continue_map = parameters.flag("continue_map", false);
  if (s.map_file.empty() && (s.localize_only || s.continue_map)) {
    throw InputError("localize_only and continue_map need a map: map_file is empty");
  }
  if (s.localize_only && s.continue_map) {
    throw InputError("localize_only and continue_map: expected one of them");
  }
  return s;
}

MappingSession::MappingSession(const MappingSettings& settings,
                               std::unique_ptr<pf::LoopResponder> closer)
    : config_(settings.config),
      is_lossless_(settings.lossless),
      store_(settings.store),
      is_continued_(settings.continue_map),
      saver_(settings.saver),
      mapper_(std::make_unique<pf::Mapper>(settings.config)),
      loops_(settings.config.loop.answer_lag_s, answerTime(settings.lossless), std::move(closer)) {
  std::optional<pf::DepthCalibration> known;
  if (!settings.calibration_file.empty()) {
    known = pf::loadCalibration(settings.calibration_file);
    mapper_->calibrate(*known);
  }
  if (settings.map_file.empty()) {
    if (known) noteCorrection(settings.calibration_file);
    return;
  }
  use_ = settings.localize_only ? MapUse::localize_only : MapUse::extend;
  pf::SavedMap saved = pf::readSavedMap(settings.map_file);
  camera_ = saved.camera;
  const bool has_calibration = saved.calibration.has_value();
  mapper_ = begunIn(std::move(saved), settings.map_file, use_, known);
  map_file_ = realPath(settings.map_file);
  if (has_calibration || known)
    noteCorrection(has_calibration ? map_file_ : settings.calibration_file);
  if (settings.continue_map) saver_.continueIn(map_file_, toSave());
}

pf::FrameStatus MappingSession::process(const pf::StaticFrame& input,
                                        const std::string& camera_frame, std::string& trouble) {
  trouble.clear();
  seen_ = input.frame.camera;
  if (!is_camera_named_ && pf::defectOf(input.frame).empty()) recallCamera(camera_frame);
  const int version = mapper_->depthVersion();
  ++frames_;
  pf::FrameStatus status = mapper_->process(input);
  if (status.is_other_camera && isLoaded()) {
    status.detail = pf::cameraDefect(map_file_, camera_, seen_, kImages);
  }
  try {
    loops_.serve(*mapper_);
  } catch (const std::exception& error) {
    trouble = error.what();
  }
  keepWhatWasLearned(version);
  if (status.outcome != pf::FrameOutcome::bad_input && !pf::isSameCamera(camera_, seen_)) {
    camera_ = seen_;
  }
  const std::string unwritten = saver_.note(status, toSave(), use_ == MapUse::extend);
  if (!unwritten.empty()) trouble = unwritten;
  return status;
}

void MappingSession::clear() {
  mapper_->reset();
  loops_.reset();
  is_continued_ = false;
  use_ = MapUse::extend;
  map_file_.clear();
}

std::string MappingSession::reset() {
  std::string said = saver_.beginAnew(toSave(), "");
  clear();
  return said + (said.empty() ? "" : "; ") + "the map is empty, the next frame begins a new one";
}

std::unique_ptr<pf::Mapper> MappingSession::begunIn(
    pf::SavedMap map, const std::string& file, MapUse use,
    const std::optional<pf::DepthCalibration>& known) const {
  auto mapper = std::make_unique<pf::Mapper>(config_);
  try {
    if (known) mapper->calibrate(*known);
    mapper->load(std::move(map), use);
  } catch (const InputError& error) {
    throw InputError(file + ": " + error.what());
  }
  return mapper;
}

std::string MappingSession::load(const std::string& file, pf::SavedMap map) {
  if (seen_.width > 0) {
    const std::string defect = pf::cameraDefect(file, map.camera, seen_, kImages);
    if (!defect.empty()) throw InputError(defect);
  }
  const pf::PinholeCamera camera = map.camera;
  const bool has_calibration = map.calibration.has_value();
  auto loaded = begunIn(std::move(map), file, use_, mapper_->calibration());
  const std::string real_file = realPath(file);  // `latest` will lead elsewhere
  std::string said = saver_.beginAnew(toSave(), real_file);
  mapper_ = std::move(loaded);
  loops_.reset();
  map_file_ = real_file;
  is_continued_ = false;
  if (has_calibration) noteCorrection(map_file_);
  camera_ = camera;
  return said + (said.empty() ? "" : "; ") + "the map is that of " + file + ", with " +
         std::to_string(mapper_->map().size()) + " surfels; the camera is looked for in it";
}

std::string MappingSession::setUse(MapUse use) {
  mapper_->setUse(use);
  use_ = use;
  return use == MapUse::extend ? "mapping: the map grows" : "localisation: the map does not change";
}

std::string MappingSession::startAnew(std::string& lost) {
  std::string said;
  lost.clear();
  try {
    said = saver_.beginAnew(toSave(), use_ == MapUse::extend ? "" : map_file_);
  } catch (const std::exception& error) {  // the new map is worth more than the old one
    lost = std::string("is lost: ") + error.what();
    saver_.abandon();
  }
  if (use_ == MapUse::extend) {
    clear();
  } else {
    mapper_ = begunIn(mapper_->saved(camera_), map_file_, use_, mapper_->calibration());
    loops_.reset();
  }
  return said;
}

std::string MappingSession::restartClock(std::string& unsaved) {
  std::string said;
  unsaved.clear();
  try {
    said = saver_.saveInBetween(toSave());
  } catch (const std::exception& error) {  // the map goes on
    unsaved = std::string("is not saved: ") + error.what();
  }
  mapper_->restartClock();
  return said;
}

std::string MappingSession::finish() {
  const int version = mapper_->depthVersion();
  try {
    loops_.finish(*mapper_);
    if (is_lossless_ && config_.loop.enabled && config_.loop.refine_at_end) mapper_->refine();
  } catch (const std::exception&) {  // what it still had to say
  }
  keepWhatWasLearned(is_unkept_ ? -1 : version);
  std::string said = saver_.finish(toSave());
  for (const Notice& notice : takeNotices()) {
    if (notice.is_warning) said += (said.empty() ? "" : "; ") + notice.text;
  }
  return said;
}

}  // namespace posefusion_ros
