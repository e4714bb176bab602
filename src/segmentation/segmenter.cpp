// SPDX-License-Identifier: BSD-3-Clause
#include "posefusion/segmentation/segmenter.hpp"

#include <algorithm>
#include <cmath>
#include <tuple>

#include "posefusion/segmentation/cut_grid.hpp"
#include "posefusion/segmentation/energy.hpp"
#include "posefusion/segmentation/planes.hpp"
#include "posefusion/segmentation/upsample.hpp"

namespace pf {
namespace {

constexpr double kMinDepth_m = 0.25;
constexpr double kMaxDepth_m = 8.0;
constexpr int kSureJoints = 5;       // a detection with so many joints ...
constexpr float kSureScore = 0.55F;  // ... and this score is a person even if the map has it
constexpr double kInMapFrames = 10;  // ... for so long
constexpr int kMinMaskCells = 12;
constexpr float kMaxPriorSpread_m = 0.4F;  // in depth, of a carried mask around its person
constexpr float kFading = 0.6F;            // of joints that are carried outside the mask
constexpr float kFaded = 0.08F;

/// Carried joints that the mask does not hold have lost their person: they fade, then go.
void fadeLostJoints(const SceneGrid& grid, const std::vector<std::uint8_t>& labels,
                    PersonTrack& track) {
  for (Keypoint& joint : track.person.joints) {
    const int cell = joint.p > 0.0F ? grid.cellAt(joint.u, joint.v) : -1;
    if (cell < 0 || labels[cell] != 0) continue;
    joint.p *= kFading;
    if (joint.p < kFaded) joint.p = 0.0F;
  }
}

/// Parts of cells on which the map agrees and which it has farther away, of those it knows.
struct MapVote {
  float known = 0, agrees = 0, nearer = 0;
};

MapVote voteOf(const std::vector<int>& cells, const std::vector<Background>& background) {
  MapVote vote;
  for (int cell : cells) {
    vote.known += background[cell] != Background::unknown;
    vote.agrees += background[cell] == Background::agrees;
    vote.nearer += background[cell] == Background::nearer;
  }
  return vote;
}

bool isSure(const Person& person) {
  const auto joints = std::count_if(person.joints.begin(), person.joints.end(),
                                    [](const Keypoint& k) { return k.p > 0.0F; });
  return joints >= kSureJoints && person.score >= kSureScore;
}

}  // namespace

struct PeopleSegmenter::State {
  cv::Mat depth_m;
  SceneGrid grid;
  std::vector<PersonTrack> tracks;
  std::vector<Body> bodies;
  MotionPredictor motion;
  PlaneFinder planes;
  Evidence evidence;
  Unary unary;
  GridCutter cutter;
  std::vector<std::uint8_t> labels;

  void takeGrid(const RgbdFrame& frame, int grid_width);
  std::vector<int> cellsBeforeMap(const PersonTrack& track) const;
  void locate(const SegmentationConfig& config);
  void cut(const SegmentationConfig& config, const std::optional<Eigen::Vector3d>& up_camera);
  void keepTracks(const SegmentationConfig& config);
};

PeopleSegmenter::PeopleSegmenter(const SegmentationConfig& config)
    : config_(config), state_(std::make_unique<State>()) {}
PeopleSegmenter::~PeopleSegmenter() = default;

/// Samples the frame. The cells of carried people count on the grid of the last frame: where this
/// one has another size, they mean nothing and the people are forgotten.
void PeopleSegmenter::State::takeGrid(const RgbdFrame& frame, int grid_width) {
  const auto sizeOf = [](const SceneGrid& g) { return std::make_tuple(g.cols, g.rows, g.step); };
  const auto last = sizeOf(grid);
  sampleGrid(frame, depth_m, grid_width, grid);
  if (sizeOf(grid) != last) tracks.clear();
}

/// Cells of the carried mask, at the person's depth, that lie in front of the known background.
std::vector<int> PeopleSegmenter::State::cellsBeforeMap(const PersonTrack& track) const {
  std::vector<int> cells;
  for (int cell : track.cells) {
    if (evidence.background[cell] == Background::nearer &&
        std::abs(grid.z[cell] - track.depth_m) < kMaxPriorSpread_m) {
      cells.push_back(cell);
    }
  }
  return cells;
}

/// Lifts every track into the scene; drops those that have no place there, and what only looks like
/// a person and has long been part of the map.
void PeopleSegmenter::State::locate(const SegmentationConfig& config) {
  bodies.clear();
  std::size_t kept = 0;
  for (std::size_t t = 0; t < tracks.size(); ++t) {
    PersonTrack& track = tracks[t];
    Body body = liftPerson(track.person, grid, track.fresh ? 0.0F : track.depth_m);
    const MapVote vote = voteOf(body.seeds, evidence.background);
    const bool in_map = vote.known >= 3 && vote.agrees > 0.6F * vote.known;
    if (track.fresh) track.in_map = in_map && isSure(track.person);
    if (track.unseen > kInMapFrames) track.in_map = false;
    if (in_map && track.fresh && !track.in_map) continue;
    if (!track.in_map) {
      body.seeds.erase(
          std::remove_if(body.seeds.begin(), body.seeds.end(),
                         [&](int cell) { return evidence.background[cell] == Background::agrees; }),
          body.seeds.end());
    }
    body.anchors = cellsBeforeMap(track);
    if (track.unseen > config.carry_frames) continue;
    if (body.seeds.empty() && static_cast<int>(body.anchors.size()) < kMinMaskCells) continue;
    if (body.depth_m <= 0.0F) body.depth_m = track.depth_m;
    body.anchors.insert(body.anchors.end(), body.seeds.begin(), body.seeds.end());
    track.depth_m = body.depth_m;
    bodies.push_back(std::move(body));
    if (kept != t) tracks[kept] = std::move(track);
    ++kept;
  }
  tracks.resize(kept);
  evidence.prior.assign(grid.size(), -1);
  for (std::size_t t = 0; t < tracks.size(); ++t) {
    for (int cell : tracks[t].cells) {
      if (grid.hasDepth(cell) && std::abs(grid.z[cell] - tracks[t].depth_m) > kMaxPriorSpread_m) {
        continue;
      }
      evidence.prior[cell] = static_cast<std::int16_t>(t);
    }
  }
}

void PeopleSegmenter::State::cut(const SegmentationConfig& config,
                                 const std::optional<Eigen::Vector3d>& up_camera) {
  measureDistance(bodies, grid, kDistanceLimit, evidence.distance);
  if (config.energy == "paper") {
    const Eigen::Vector3f up =
        up_camera ? up_camera->cast<float>().normalized() : Eigen::Vector3f::UnitZ();
    cutter.cutPaper(grid, bodies, up, config, labels);
    return;
  }
  planes.find(grid, evidence.on_plane);
  improvedUnary(grid, evidence, bodies, config, tracks, unary);
  cutter.cut(grid, unary, config, labels);
  keepAnchoredRegions(grid, bodies, labels);
}

/// Hands the mask's cells to the people for the next frame, and lets the unconfirmed grow old.
void PeopleSegmenter::State::keepTracks(const SegmentationConfig&) {
  for (PersonTrack& track : tracks) track.cells.clear();
  for (int cell = 0; cell < grid.size(); ++cell) {
    if (labels[cell] == 0) continue;
    int owner = evidence.distance.owner.empty() ? -1 : evidence.distance.owner[cell];
    if (owner < 0) owner = evidence.prior[cell];
    if (owner >= 0) tracks[owner].cells.push_back(cell);
  }
  for (PersonTrack& track : tracks) {
    const MapVote vote = voteOf(track.cells, evidence.background);
    const float cells = static_cast<float>(track.cells.size());
    const bool confirmed = vote.known > 0.5F * cells && vote.nearer > 0.7F * vote.known;
    track.unseen += confirmed ? 0.25 : 1.0;
    fadeLostJoints(grid, labels, track);
  }
  tracks.erase(std::remove_if(tracks.begin(), tracks.end(),
                              [](const PersonTrack& track) {
                                return static_cast<int>(track.cells.size()) < kMinMaskCells;
                              }),
               tracks.end());
}

Segmentation PeopleSegmenter::segment(const RgbdFrame& frame, const FlowTracker& flow,
                                      const People& people, const ModelView* background,
                                      const std::optional<Eigen::Vector3d>& up_camera) {
  State& s = *state_;
  Segmentation result{cv::Mat(), frame.depth, {frame.stamp_ns, people.detected, {}}};
  Eigen::Isometry3d T_view_camera = Eigen::Isometry3d::Identity();
  if (background != nullptr) T_view_camera = s.motion.predict(*background, frame.stamp_ns);
  if (!config_.enabled || (s.tracks.empty() && people.people.empty())) {
    return result;
  }
  depthInMetres(frame, kMinDepth_m, kMaxDepth_m, s.depth_m);
  s.takeGrid(frame, config_.grid_width);
  carryTracks(flow, s.grid, s.tracks);
  mergeDetections(people, s.grid, s.tracks);
  if (background != nullptr) {
    compareWithModel(s.grid, *background, T_view_camera, s.evidence.background);
  } else {
    s.evidence.background.assign(s.grid.size(), Background::unknown);
  }
  s.locate(config_);
  if (!s.tracks.empty()) {
    s.cut(config_, up_camera);
    upsampleMask(frame, s.depth_m, s.grid, s.labels, result.mask);
    for (const PersonTrack& track : s.tracks) result.people.people.push_back(track.person);
    s.keepTracks(config_);
    const double margin = static_cast<double>(config_.margin_px) * frame.depth.cols / 640.0;
    result.static_depth =
        removeMasked(frame.depth, result.mask, static_cast<int>(std::lround(margin)));
  }
  return result;
}

void PeopleSegmenter::reset() { state_ = std::make_unique<State>(); }

}  // namespace pf
