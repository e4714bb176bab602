// SPDX-License-Identifier: BSD-3-Clause
#include "posefusion/run/slam.hpp"

#include <utility>

#include "posefusion/core/error.hpp"
#include "posefusion/io/map_file.hpp"
#include "posefusion/io/trajectory_file.hpp"
#include "posefusion/map/stable_surfels.hpp"
#include "posefusion/run/run.hpp"

namespace pf {
namespace {

std::string reasonFor(const FrameStatus& status, const std::string& defect) {
  return defect.empty() ? reasonOf(status) : std::string(name(status.outcome)) + ": " + defect;
}

}  // namespace

struct Slam::State {
  State(const Config& config, RecordedPeople people)
      : pipeline(config, makePoseDetector(config.pose, std::move(people))) {}

  FrameAnswer answer(const FrameStatus& status, const std::string& defect) const {
    FrameAnswer out;
    out.stamp_ns = status.stamp_ns;
    out.state = status.state;
    out.outcome = status.outcome;
    out.located = status.located;
    out.T_world_camera = pipeline.mapper().worldFromMap() * status.T_map_camera;
    out.covariance = status.covariance;
    out.reason = reasonFor(status, defect);
    return out;
  }

  Pipeline pipeline;
};

Slam::Slam(const Config& config) : state_(std::make_unique<State>(config, RecordedPeople{})) {}

Slam::Slam(Config config, FrameSource& recording) {
  config = configFor(config, recording);
  RecordedPeople people;
  if (config.pose.detector == "recorded") {
    people = recording.people();
    if (people.empty())
      throw InputError("pose.detector: recorded, but the recording has no people");
  }
  state_ = std::make_unique<State>(config, std::move(people));
  if (const auto color = recording.colorCamera()) state_->pipeline.registerColor(*color);
}

Slam::Slam(Slam&& other) noexcept = default;
Slam& Slam::operator=(Slam&& other) noexcept = default;
Slam::~Slam() = default;

FrameAnswer Slam::process(const RgbdFrame& frame) {
  return state_->answer(state_->pipeline.process(frame).status, {});
}

void Slam::process(FrameSource& recording, const std::function<bool(const FrameAnswer&)>& done) {
  runPipeline(recording, state_->pipeline,
              [&](const ProcessedFrame& frame, const std::string& defect) {
                return !done || done(state_->answer(frame.status, defect));
              });
}

std::string Slam::finish() { return state_->pipeline.finish(); }

Trajectory Slam::trajectory() const {
  const Mapper& mapper = state_->pipeline.mapper();
  return inWorld(mapper.worldFromMap(), mapper.backEnd().trajectory());
}

SurfelArrays Slam::surfels() const {
  const Mapper& mapper = state_->pipeline.mapper();
  return stableSurfels(mapper.map(), mapper.worldFromMap());
}

void Slam::saveTrajectory(const std::string& path) const {
  pf::saveTrajectory(path, trajectory(), "poses of the camera in the map (z up)");
}

std::size_t Slam::saveMap(const std::string& path) const {
  const Mapper& mapper = state_->pipeline.mapper();
  return pf::saveMap(path, mapper.map(), mapper.worldFromMap());
}

}  // namespace pf
