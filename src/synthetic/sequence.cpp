// SPDX-License-Identifier: BSD-3-Clause
#include "synthetic/sequence.hpp"

#include <cmath>
#include <string>

#include "camera_path.hpp"
#include "figure.hpp"
#include "posefusion/core/error.hpp"
#include "random.hpp"
#include "render.hpp"
#include "room.hpp"
#include "sensor.hpp"
#include "texture.hpp"

namespace pf {
namespace {

constexpr double kFramesPerSecond = 30.0;
constexpr double kFocalOf640 = 525.0;  // pixels
constexpr std::size_t kFewestJoints = 3;

void validate(const SyntheticOptions& options) {
  const auto check = [](const char* name, int value, int least, int most) {
    if (value < least || value > most)
      throw InputError("code-made sequence: " + std::string(name) + " is " + std::to_string(value) +
                       ", expected " + std::to_string(least) + " to " + std::to_string(most));
  };
  check("frames", options.frames, 1, 100000);
  check("width", options.width, 32, 4096);
  check("height", options.height, 24, 4096);
}

PinholeCamera makeCamera(const SyntheticOptions& options) {
  PinholeCamera camera;
  camera.width = options.width;
  camera.height = options.height;
  camera.fx = camera.fy = kFocalOf640 * options.width / 640.0;
  camera.cx = (options.width - 1) / 2.0;
  camera.cy = (options.height - 1) / 2.0;
  return camera;
}

}  // namespace

struct SyntheticSequence::State {
  SyntheticOptions options;
  PinholeCamera camera;
  std::vector<synthetic::Texture> textures;
  std::vector<synthetic::Shape> room;
  Eigen::Isometry3d T_map_room;

  double timeOf(int index) const { return index / kFramesPerSecond; }
  std::uint64_t seedOf(int index, int purpose) const {
    return (std::uint64_t{options.seed} * 100003 + static_cast<std::uint64_t>(index)) * 4 +
           static_cast<std::uint64_t>(purpose);
  }
  People observe(int index, const synthetic::Figure& figure,
                 const synthetic::Picture& picture) const;
};

/// A detector that sees well: joints in the image that no furniture hides, less sure of those
/// behind the body itself.
People SyntheticSequence::State::observe(int index, const synthetic::Figure& figure,
                                         const synthetic::Picture& picture) const {
  const Eigen::Isometry3f T_camera_room =
      synthetic::cameraAt(timeOf(index), options.seed).inverse().cast<float>();
  Person person;
  std::size_t seen = 0;
  for (std::size_t j = 0; j < figure.joints.size(); ++j) {
    const Eigen::Vector3d p = (T_camera_room * figure.joints[j]).cast<double>();
    if (p.z() < 0.2) continue;
    const Eigen::Vector2d pixel = camera.project(p);
    const int u = static_cast<int>(std::lround(pixel.x())),
              v = static_cast<int>(std::lround(pixel.y()));
    if (u < 0 || v < 0 || u >= camera.width || v >= camera.height) continue;
    const double surface = picture.depth.at<float>(v, u);
    const bool on_person = picture.mask.at<std::uint8_t>(v, u) != 0;
    if (!on_person && surface < p.z() - 0.05) continue;
    const std::uint64_t bits = synthetic::randomBits(seedOf(index, 2) * 32 + j);
    const float sigma =
        options.noise ? 0.0025F * static_cast<float>(camera.width) : 0.0F;  // pixels
    person.joints[j] = {static_cast<float>(pixel.x()) + sigma * synthetic::normal(bits, 0),
                        static_cast<float>(pixel.y()) + sigma * synthetic::normal(bits, 30),
                        on_person && surface < p.z() - 0.2 ? 0.6F : 0.9F};
    person.score += person.joints[j].p;
    ++seen;
  }
  People people;
  if (seen >= kFewestJoints) {
    person.score /= static_cast<float>(seen);
    people.people.push_back(person);
  }
  return people;
}

SyntheticSequence::SyntheticSequence(const SyntheticOptions& options) {
  validate(options);
  auto state = std::make_unique<State>();
  state->options = options;
  state->camera = makeCamera(options);
  state->textures = synthetic::makeTextures(options.seed);
  state->room = synthetic::makeRoom();
  state->T_map_room = synthetic::cameraAt(0.0, options.seed).inverse();
  state_ = std::move(state);
}

SyntheticSequence::~SyntheticSequence() = default;

int SyntheticSequence::frameCount() const { return state_->options.frames; }
const PinholeCamera& SyntheticSequence::camera() const { return state_->camera; }

SyntheticFrame SyntheticSequence::frame(int index) const {
  const State& s = *state_;
  std::vector<synthetic::Shape> shapes = s.room;
  const synthetic::Figure figure = synthetic::figureAt(s.timeOf(index), s.options.seed);
  if (s.options.figure) shapes.insert(shapes.end(), figure.shapes.begin(), figure.shapes.end());
  synthetic::Picture picture = synthetic::render(
      shapes, s.textures, s.camera, synthetic::cameraAt(s.timeOf(index), s.options.seed));
  SyntheticFrame result;
  if (s.options.figure) result.people = s.observe(index, figure, picture);
  result.people.stamp_ns = stamp(index);
  result.people.detected = true;
  if (s.options.noise) synthetic::addColorNoise(picture.color, s.seedOf(index, 1));
  result.frame.stamp_ns = stamp(index);
  result.frame.camera = s.camera;
  result.frame.color = picture.color;
  result.frame.depth = s.options.noise
                           ? synthetic::measureDepth(picture.depth, s.camera, s.seedOf(index, 0))
                           : synthetic::exactDepth(picture.depth);
  result.frame.depth_unit_m = 1e-3;
  result.T_map_camera = pose(index);
  result.true_depth = picture.depth;
  result.mask = picture.mask;
  return result;
}

Eigen::Isometry3d SyntheticSequence::pose(int index) const {
  return state_->T_map_room * synthetic::cameraAt(state_->timeOf(index), state_->options.seed);
}

std::int64_t SyntheticSequence::stamp(int index) const {
  return 1'000'000'000LL + std::llround(state_->timeOf(index) * 1e6) * 1000;
}

Trajectory SyntheticSequence::truth() const {
  Trajectory truth;
  for (int i = 0; i < frameCount(); ++i) truth.push_back({stamp(i), pose(i)});
  return truth;
}

Eigen::Vector3d SyntheticSequence::up() const {
  return state_->T_map_room.linear() * Eigen::Vector3d::UnitZ();
}

}  // namespace pf
