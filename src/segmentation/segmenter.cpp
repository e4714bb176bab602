// SPDX-License-Identifier: BSD-3-Clause
#include "posefusion/segmentation/segmenter.hpp"

#include <algorithm>
#include <cmath>
#include <tuple>

#include "posefusion/core/pace.hpp"
#include "posefusion/segmentation/cut_grid.hpp"
#include "posefusion/segmentation/energy.hpp"
#include "posefusion/segmentation/location.hpp"
#include "posefusion/segmentation/mapped_people.hpp"
#include "posefusion/segmentation/moving_objects.hpp"
#include "posefusion/segmentation/paper_cut.hpp"
#include "posefusion/segmentation/planes.hpp"
#include "posefusion/segmentation/trunks.hpp"
#include "posefusion/segmentation/upsample.hpp"

namespace pf {
namespace {

constexpr double kMinDepth_m = 0.25;
constexpr float kUnlabelledFading =
    0.6F;  // at 30 Hz, of the likelihood of joints outside the mask ...
constexpr float kFadedLikelihood = 0.08F;  // ... until they are dropped

// How much each frame (at 30 Hz) without a detection ages a carried person.
constexpr double kAgeing = 1.0;
constexpr double kConfirmedAgeing = 0.25;  // the map shows that somebody stands before it
constexpr double kBlindAgeing = 3.0;       // no map: the mask may leak into furniture unnoticed

constexpr double kMarginWidth_px = 640.0;  // image width that margin_px is given for

/// Carried joints that the mask does not hold have lost their person: they fade, then go.
void fadeLostJoints(const SceneGrid& grid, const std::vector<std::uint8_t>& labels, float worth,
                    Person& person) {
  const float fading = std::pow(kUnlabelledFading, worth);
  for (Keypoint& joint : person.joints) {
    const int cell = joint.p > 0.0F ? grid.cellAt(joint.u, joint.v) : -1;
    if (cell < 0 || labels[cell] != 0) continue;
    joint.p *= fading;
    if (joint.p < kFadedLikelihood) joint.p = 0.0F;
  }
}

}  // namespace

struct PeopleSegmenter::State {
  explicit State(const DepthSensor& sensor) : objects(sensor) {}

  cv::Mat depth_m;
  std::vector<TrackedPerson> people;
  Evidence evidence;
  MotionPredictor motion;
  PlaneFinder planes;
  Unary unary;
  GridCutter cutter;
  PaperCutter paper_cutter;
  std::vector<std::uint8_t> labels;  // 1: a person
  MovingObjects objects;
  int last_id = 0;
  PaceMeter pace_meter;
  float worth = 1.0F;  // of the frame, see Pace

  void takeGrid(const RgbdFrame& frame, int grid_width);
  void locate(double carry_s);
  void markCarriedMasks();
  void markShownPeople();
  void cut(const SegmentationConfig& config);
  void keepPeople(bool with_map);
  cv::Mat inMapMask(const RgbdFrame& frame, const cv::Mat& mask) const;
  void takeOut(const RgbdFrame& frame, const std::vector<std::uint8_t>& taken, int margin_px,
               Segmentation& result) const;
};

PeopleSegmenter::PeopleSegmenter(const SegmentationConfig& config, const DepthSensor& sensor)
    : config_(config), sensor_(sensor), state_(std::make_unique<State>(sensor)) {}
PeopleSegmenter::~PeopleSegmenter() = default;

/// Samples the frame. The cells of carried people count on the grid of the last frame: where this
/// one has another size, they mean nothing and the people are forgotten.
void PeopleSegmenter::State::takeGrid(const RgbdFrame& frame, int grid_width) {
  const auto sizeOf = [](const SceneGrid& g) { return std::make_tuple(g.cols, g.rows, g.step); };
  const auto last = sizeOf(evidence.grid);
  depthInMetres(frame, kMinDepth_m, kFarthestPerson_m, depth_m);
  sampleGrid(frame, depth_m, grid_width, evidence.grid);
  if (sizeOf(evidence.grid) != last) people.clear();
}

void PeopleSegmenter::State::locate(double carry_s) {
  std::vector<TrackedPerson> located;
  for (TrackedPerson& tracked : people) {
    if (!locatePerson(evidence, carry_s, tracked)) continue;
    if (tracked.id == 0) tracked.id = ++last_id;
    tracked.person.id = tracked.id;
    located.push_back(std::move(tracked));
  }
  people.swap(located);
}

void PeopleSegmenter::State::markCarriedMasks() {
  const SceneGrid& grid = evidence.grid;
  evidence.carried.assign(grid.size(), -1);
  for (std::size_t i = 0; i < people.size(); ++i) {
    for (int cell : people[i].cells) {
      const float gap_m = std::abs(grid.z[cell] - people[i].depth_m);
      if (grid.hasDepth(cell) && gap_m > kMaxMaskSpread_m) continue;
      evidence.carried[cell] = static_cast<std::int16_t>(i);
    }
  }
}

void PeopleSegmenter::State::markShownPeople() {
  evidence.shown_person.assign(evidence.grid.size(), -1);
  if (evidence.shown.empty()) return;
  std::vector<std::int16_t> of_detection(people.size(), -1);
  for (std::size_t i = 0; i < people.size(); ++i) {
    const auto detection = static_cast<std::size_t>(std::max(0, people[i].detection));
    if (detection >= of_detection.size()) of_detection.resize(detection + 1, -1);
    if (people[i].detection >= 0) of_detection[detection] = static_cast<std::int16_t>(i);
  }
  for (int cell = 0; cell < evidence.grid.size(); ++cell) {
    const int detection = evidence.shown.detection[cell];
    if (detection < 0 || detection >= static_cast<int>(of_detection.size())) continue;
    evidence.shown_person[cell] = of_detection[static_cast<std::size_t>(detection)];
  }
}

void PeopleSegmenter::State::cut(const SegmentationConfig& config) {
  markCarriedMasks();
  markShownPeople();
  measureDistance(people, evidence.grid, kDistanceLimit, evidence.distance);
  improvedUnary(evidence, config, people, unary);
  cutter.cut(evidence.grid, unary, config, labels);
  keepAnchoredRegions(evidence.grid, people, labels);
}

/// Hands the mask's cells to the people for the next frame; people without a mask go.
void PeopleSegmenter::State::keepPeople(bool with_map) {
  for (TrackedPerson& tracked : people) tracked.cells.clear();
  for (int cell = 0; cell < evidence.grid.size(); ++cell) {
    if (labels[cell] == 0) continue;
    const int owner = candidateOf(evidence, cell);
    if (owner >= 0) people[owner].cells.push_back(cell);
  }
  for (TrackedPerson& tracked : people) {
    const bool confirmed = standsBeforeMap(tracked.cells, evidence.background);
    const bool blind = !with_map && !tracked.fresh;
    tracked.unseen += worth * (confirmed ? kConfirmedAgeing : blind ? kBlindAgeing : kAgeing);
    fadeLostJoints(evidence.grid, labels, worth, tracked.person);
  }
  const auto isNobody = [](const TrackedPerson& t) { return t.cells.size() < kMinMaskCells; };
  people.erase(std::remove_if(people.begin(), people.end(), isNobody), people.end());
}

cv::Mat PeopleSegmenter::State::inMapMask(const RgbdFrame& frame, const cv::Mat& mask) const {
  const std::vector<std::uint8_t> mapped = findMappedPeople(evidence, people, labels);
  if (std::count(mapped.begin(), mapped.end(), 0) == evidence.grid.size()) return {};
  return upsampleMask(frame, depth_m, evidence.grid, mapped) & mask;
}

/// Takes these cells out of the depth, at full resolution.
void PeopleSegmenter::State::takeOut(const RgbdFrame& frame, const std::vector<std::uint8_t>& taken,
                                     int margin_px, Segmentation& result) const {
  result.mask = upsampleMask(frame, depth_m, evidence.grid, taken);
  const double margin = margin_px * frame.depth.cols / kMarginWidth_px;
  result.static_depth =
      removeMasked(frame.depth, result.mask, static_cast<int>(std::lround(margin)));
}

/// False when there is nobody. Else `labels` are the people's.
bool PeopleSegmenter::findPeople(const RgbdFrame& frame, const FlowTracker& flow,
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
  doubtTrunks(s.people, s.evidence.grid, s.evidence.flatness, s.evidence.background);
  s.cut(config_);
  return true;
}

/// Adds to `taken` the cells of what moves beside the people.
void PeopleSegmenter::findObjects(const RgbdFrame& frame, const ModelView* view,
                                  const Eigen::Isometry3d& T_view_camera,
                                  std::vector<std::uint8_t>& taken, Segmentation& result) {
  State& s = *state_;
  if (view == nullptr || !config_.moving_objects) return s.objects.reset();
  const Eigen::Isometry3d T_map_camera = view->T_map_camera * T_view_camera;
  result.objects = s.objects.find({s.evidence.grid, frame.camera, *view, T_map_camera,
                                   s.evidence.background, s.labels, frame.stamp_ns, s.worth});
  for (std::size_t cell = 0; cell < taken.size(); ++cell) taken[cell] |= s.objects.labels()[cell];
}

Segmentation PeopleSegmenter::segment(const RgbdFrame& frame, const FlowTracker& flow,
                                      const People& people, const ModelView* background,
                                      const std::optional<Eigen::Vector3d>& up_camera) {
  if (config_.energy == "paper") return segmentAsThePaper(frame, people, up_camera);
  State& s = *state_;
  s.worth = s.pace_meter.add(frame.stamp_ns).worth();
  Segmentation result{cv::Mat(), cv::Mat(), frame.depth, {frame.stamp_ns, people.detected, {}}, {}};
  Eigen::Isometry3d T_view_camera = Eigen::Isometry3d::Identity();
  if (background != nullptr) T_view_camera = s.motion.predict(*background, frame.stamp_ns);
  if (!config_.enabled) return result;
  s.takeGrid(frame, config_.grid_width);
  s.evidence.background.assign(s.evidence.grid.size(), Background::unknown);
  if (background != nullptr) {
    compareWithModel(s.evidence.grid, *background, T_view_camera, sensor_, s.evidence.background);
  }
  const bool has_people = findPeople(frame, flow, people);
  std::vector<std::uint8_t> taken = s.labels;
  findObjects(frame, background, T_view_camera, taken, result);
  const bool is_empty = std::all_of(taken.begin(), taken.end(), [](auto t) { return t == 0; });
  if (has_people || !is_empty) s.takeOut(frame, taken, config_.margin_px, result);
  if (!has_people) return result;
  result.in_map_mask = s.inMapMask(frame, result.mask);
  for (const TrackedPerson& tracked : s.people) {
    result.people.people.push_back(tracked.person);
    dropJointsOutside(s.evidence.grid, 0.0F, result.people.people.back());
  }
  s.keepPeople(background != nullptr);
  return result;
}

Segmentation PeopleSegmenter::segmentAsThePaper(const RgbdFrame& frame, const People& people,
                                                const std::optional<Eigen::Vector3d>& up_camera) {
  State& s = *state_;
  Segmentation result{cv::Mat(), cv::Mat(), frame.depth, {frame.stamp_ns, people.detected, {}}, {}};
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
