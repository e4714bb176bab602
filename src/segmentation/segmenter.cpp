// SPDX-License-Identifier: BSD-3-Clause
#include "posefusion/segmentation/segmenter.hpp"

#include <algorithm>

#include "posefusion/core/map_pose.hpp"
#include "posefusion/segmentation/location.hpp"
#include "posefusion/segmentation/shown_people.hpp"
#include "segmenter_state.hpp"

namespace pf {

namespace {

/// Reports `objects` (in uncorrected coordinates) where the pose of the map in the world is known.
void reportObjects(const ModelView& view, const std::vector<MovingObject>& objects,
                   Segmentation& result) {
  if (view.fragment != kFirstFragment || !view.T_world_map) return;
  const Eigen::Isometry3d T_world_uncorrected = *view.T_world_map * view.T_map_uncorrected;
  for (const MovingObject& object : objects) {
    result.moving.push_back(object.in(T_world_uncorrected));
  }
}

}  // namespace

PeopleSegmenter::PeopleSegmenter(const SegmentationConfig& config, const DepthSensor& sensor)
    : config_(config), sensor_(sensor), state_(std::make_unique<State>(sensor)) {}
PeopleSegmenter::~PeopleSegmenter() = default;

/// False when there are no people. Else `labels` are the people's.
bool PeopleSegmenter::findPeople(const RgbdFrame& frame, const FlowImages& flow,
                                 const People& people) {
  State& s = *state_;
  s.labels.assign(s.evidence.grid.size(), 0);
  if (s.people.empty() && people.people.empty()) return false;
  carryPeople(flow, s.evidence.grid, s.people);
  sampleMask(people.mask, frame.depth.size(), s.evidence.grid, s.evidence.shown);
  mergeDetections(people, mayBeNew(people, s.evidence.shown, s.evidence.background),
                  s.evidence.grid, s.worth, s.people);
  s.planes.find(s.evidence.grid, s.evidence.flatness);
  s.locate(config_.carry_s);
  if (s.people.empty()) return false;
  s.cut(config_);
  return true;
}

/// The people as reported, and as kept for the next frame.
void PeopleSegmenter::keepPeople(bool with_map, Segmentation& result) {
  State& s = *state_;
  for (const TrackedPerson& tracked : s.people) {
    result.people.people.push_back(tracked.person);
    dropJointsOutside(s.evidence.grid, 0.0F, result.people.people.back());
  }
  s.keepPeople(with_map);
}

/// Before the people are cut: what speaks for other things than people.
void PeopleSegmenter::expectObjects(const RgbdFrame& frame, const ModelView* view,
                                    const Eigen::Isometry3d& T_uncorrected_camera) {
  State& s = *state_;
  s.evidence.object.assign(s.evidence.grid.size(), -1);
  s.evidence.stood.assign(s.evidence.grid.size(), 0);
  if (view == nullptr || !config_.moving_objects) return s.objects.reset();
  s.evidence.object = s.objects.expect(s.sceneOf(frame, *view, T_uncorrected_camera));
  for (int c = 0; c < s.evidence.grid.size(); ++c) s.evidence.stood[c] = s.objects.stood(c);
}

/// After expectObjects(): adds to `taken` the cells of what moves beside the people.
void PeopleSegmenter::findObjects(const RgbdFrame& frame, const ModelView* view,
                                  const Eigen::Isometry3d& T_uncorrected_camera,
                                  std::vector<std::uint8_t>& taken, Segmentation& result) {
  State& s = *state_;
  if (view == nullptr || !config_.moving_objects) return;
  const std::vector<MovingObject> objects =
      s.objects.find(s.sceneOf(frame, *view, T_uncorrected_camera));
  for (std::size_t cell = 0; cell < taken.size(); ++cell) taken[cell] |= s.objects.labels()[cell];
  reportObjects(*view, objects, result);
}

/// After keepPeople(): the cells are those of this frame's mask.
void PeopleSegmenter::placePeople(const ModelView* view,
                                  const Eigen::Isometry3d& T_uncorrected_camera,
                                  Segmentation& result) {
  State& s = *state_;
  if (view == nullptr || view->fragment != kFirstFragment) return s.people_in_map.reset();
  reportObjects(*view,
                s.people_in_map.place(s.people, s.evidence.grid, T_uncorrected_camera,
                                      result.people.stamp_ns),
                result);
}

Segmentation PeopleSegmenter::segment(const RgbdFrame& frame, const FlowImages& flow,
                                      const People& people, const ModelView* background,
                                      const std::optional<Eigen::Vector3d>& up_camera) {
  if (config_.energy == "paper") return segmentAsThePaper(frame, people, up_camera);
  State& s = *state_;
  s.worth = s.pace_meter.add(frame.stamp_ns).worth();
  Segmentation result{cv::Mat(), frame.depth, {frame.stamp_ns, people.detected, {}}, {}};
  Eigen::Isometry3d T_view_camera = Eigen::Isometry3d::Identity();
  Eigen::Isometry3d T_uncorrected_camera = Eigen::Isometry3d::Identity();
  if (!config_.enabled) return result;
  s.takeGrid(frame, config_.grid_width);
  s.evidence.background.assign(s.evidence.grid.size(), Background::unknown);
  if (background != nullptr) {
    T_view_camera = s.motion.expect(*background, frame, flow.corners(), s.depth_m);
    T_uncorrected_camera = background->T_uncorrected_camera() * T_view_camera;
    compareWithModel(s.evidence.grid, *background, T_view_camera, sensor_, s.evidence.background);
  }
  expectObjects(frame, background, T_uncorrected_camera);
  const bool has_people = findPeople(frame, flow, people);
  std::vector<std::uint8_t> taken = s.labels;
  findObjects(frame, background, T_uncorrected_camera, taken, result);
  const bool is_empty = std::all_of(taken.begin(), taken.end(), [](auto t) { return t == 0; });
  if (has_people || !is_empty) s.takeOut(frame, taken, config_.margin_px, result);
  if (has_people) keepPeople(background != nullptr, result);
  placePeople(background, T_uncorrected_camera, result);
  s.motion.keep(frame.stamp_ns, result.mask, s.depth_m);
  return result;
}

Segmentation PeopleSegmenter::segmentAsThePaper(const RgbdFrame& frame, const People& people,
                                                const std::optional<Eigen::Vector3d>& up_camera) {
  State& s = *state_;
  Segmentation result{cv::Mat(), frame.depth, {frame.stamp_ns, people.detected, {}}, {}};
  if (!config_.enabled || people.people.empty()) return result;
  s.takeGrid(frame, config_.grid_width);
  const std::vector<Eigen::Vector3f> seeds = liftJoints(people, s.evidence.grid);
  if (seeds.empty()) return result;
  PaperTerms terms;
  terms.sigma_m = static_cast<float>(config_.paper_sigma_m);
  terms.radius_m = static_cast<float>(config_.paper_radius_m);
  if (up_camera) terms.up = up_camera->cast<float>().normalized();
  s.paper_cutter.cut(s.evidence.grid, seeds, terms, s.labels);
  s.takeOut(frame, s.labels, config_.margin_px, result);
  result.people.people = people.people;
  return result;
}

void PeopleSegmenter::reset() { state_ = std::make_unique<State>(sensor_); }

}  // namespace pf
