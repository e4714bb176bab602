// SPDX-License-Identifier: BSD-3-Clause
#include "posefusion/map/fusion.hpp"

#include <algorithm>
#include <string>
#include <vector>

#include "free_space.hpp"
#include "insertion.hpp"
#include "posefusion/core/error.hpp"
#include "posefusion/core/parallel.hpp"
#include "posefusion/frame/depth_filter.hpp"
#include "posefusion/map/visibility.hpp"
#include "seen_space.hpp"
#include "surfel_update.hpp"

namespace pf {
namespace {

// Blocks are swept in turn, each once in so many frames: counting its dead surfels, and moving all
// arrays of one that has some, costs more than carrying them for a while.
constexpr int kSweptInView = 10, kSweptElsewhere = 30;
// At once where a frame refuted more than one of so many surfels: things that went away.
constexpr std::size_t kAtOnceShare = 50;

std::string sizeText(const cv::Size& size) {
  return std::to_string(size.width) + "x" + std::to_string(size.height);
}

/// How often an image of `size` is larger than the working frame, a rest of pixels at its right and
/// lower border left out. Throws InputError when it is no multiple of that.
int factorOf(const cv::Size& size, const cv::Size& working, const char* name) {
  const int factor = size.width / working.width;
  if (factor < 1 || cv::Size(size.width / factor, size.height / factor) != working) {
    throw InputError(std::string(name) + " is " + sizeText(size) + ", expected a multiple of " +
                     sizeText(working));
  }
  return factor;
}

/// The depth with people at the size of the working frame; empty when there is none.
void shrinkInput(const cv::Mat& input_depth_m, const WorkingFrame& frame, cv::Mat& input_m) {
  input_m.release();
  if (input_depth_m.empty()) return;
  const int factor = factorOf(input_depth_m.size(), frame.depth_m.size(), "the input depth");
  shrinkDepth(input_depth_m, factor, frame.sensor, input_m);
}

/// The depth of the people of a mask at the size of the working frame; empty when there are none.
/// `full_m`: work memory.
void findPeople(const cv::Mat& mask, const cv::Mat& input_depth_m, const WorkingFrame& frame,
                cv::Mat& full_m, cv::Mat& person_m) {
  person_m.release();
  if (mask.empty()) return;
  const int factor = factorOf(mask.size(), frame.depth_m.size(), "the mask of people");
  if (mask.type() != CV_8UC1) {
    throw InputError("the mask of people has OpenCV's type " + std::to_string(mask.type()) +
                     ", expected 8 bits a pixel");
  }
  if (input_depth_m.size() != mask.size() || input_depth_m.type() != CV_32FC1) {
    throw InputError("the input depth is " + sizeText(input_depth_m.size()) +
                     ", expected floats and the size of the mask of people, " +
                     sizeText(mask.size()));
  }
  full_m.create(mask.size(), CV_32FC1);
  full_m.setTo(0);
  input_depth_m.copyTo(full_m, mask);
  shrinkDepth(full_m, factor, frame.sensor, person_m);
}

/// Of a surfel farther than this (m) the frame says nothing. In a gap it does of all that can be
/// measured.
double reachOf(const DepthSensor& sensor, const cv::Mat& seen_m, const cv::Mat& person_m,
               const cv::Mat& gaps) {
  double farthest = cv::countNonZero(gaps) > 0 ? sensor.max_depth_m : 0.0;
  for (const cv::Mat& depth_m : {seen_m, person_m}) {
    double most = 0;
    if (!depth_m.empty()) cv::minMaxLoc(depth_m, nullptr, &most);
    farthest = std::max(farthest, most);
  }
  const double tolerance = 2.0 * sensor.tolerance(static_cast<float>(farthest), 5.0F);
  return farthest + std::max<double>(tolerance, person_m.empty() ? 0.0 : NearPeople::kReach_m);
}

}  // namespace

/// What is kept between calls.
struct Fuser::Scratch {
  cv::Mat seen_m, full_m, input_m, people;
  Evidence evidence;
  std::vector<std::uint32_t> visible;  // blocks in view of the frame
  std::vector<std::uint32_t> emptied;  // blocks of which it refuted much
  SurfelArrays fresh;                  // new surfels, in the order of their pixels
  SeenSpace seen_space;                // of the frames before
};

Fuser::Fuser() : scratch_(std::make_unique<Scratch>()) {}
Fuser::~Fuser() = default;

void Fuser::follow(const Deformation& deformation) { scratch_->seen_space.follow(deformation); }

void Fuser::forget() { scratch_->seen_space.clear(); }

FusionCounts Fuser::fuse(const WorkingFrame& frame, const Eigen::Isometry3d& T_map_camera,
                         SurfelMap& map, const FusionOptions& options) {
  Scratch& s = *scratch_;
  findPeople(options.mask, options.input_depth_m, frame, s.full_m, s.evidence.person_m);
  s.evidence.near_people.clear();
  if (!s.evidence.person_m.empty()) {
    s.evidence.near_people.assign(s.evidence.person_m, frame.camera);
  }
  map.advance(frame.pace);
  FusionCounts counts;
  update(frame, T_map_camera, options, map, counts);
  counts.removed = clean(map);
  surfelsOfUnexplained(frame, T_map_camera, options, map.frame(), s.evidence,
                       s.seen_space.from(T_map_camera, options.fragment), s.fresh);
  counts.inserted = map.add(s.fresh, options.fragment);
  if (options.may_remove_stable) {
    s.seen_space.add(s.evidence.free_m, frame, T_map_camera, options.fragment, map.frame());
  }
  return counts;
}

void Fuser::update(const WorkingFrame& frame, const Eigen::Isometry3d& T_map_camera,
                   const FusionOptions& options, SurfelMap& map, FusionCounts& counts) {
  Scratch& s = *scratch_;
  shrinkInput(options.input_depth_m, frame, s.input_m);
  findFreeSpace(frame, s.input_m, s.seen_m, s.evidence.free_m);
  findGaps(s.seen_m, options.mask, s.people, s.evidence.gaps);
  s.evidence.measured.assign(frame, map.config().shrink);
  s.evidence.explained.clear(s.evidence.measured);
  s.evidence.known_behind.assign(frame.depth_m.size());
  s.visible = visibleBlocks(map, frame.camera, {options.fragment, T_map_camera},
                            reachOf(frame.sensor, s.seen_m, s.evidence.person_m, s.evidence.gaps));
  const auto ranges = rangesOf(map, s.visible);
  parallelFor(s.visible.size(), 1, [&](std::size_t begin, std::size_t end) {
    for (std::size_t k = begin; k < end; ++k) map.blocks_.change(s.visible[k]);
  });
  const SurfelUpdate update(frame, T_map_camera, options, map, s.evidence);
  std::vector<SurfelUpdate::Result> results(ranges.size());
  parallelFor(ranges.size(), 1, [&](std::size_t begin, std::size_t end) {
    for (std::size_t k = begin; k < end; ++k) {
      results[k] = update.update(ranges[k], map.blocks_.change(ranges[k].block).surfels);
    }
  });
  parallelFor(ranges.size(), 1, [&](std::size_t begin, std::size_t end) {
    for (std::size_t k = begin; k < end; ++k) {
      update.contradict(results[k], map.blocks_.change(ranges[k].block).surfels);
    }
  });
  s.emptied.clear();
  for (std::size_t k = 0; k < ranges.size(); ++k) {
    counts.merged += results[k].merged;
    if (results[k].refuted * kAtOnceShare > ranges[k].end - ranges[k].begin) {
      s.emptied.push_back(ranges[k].block);
    }
    SurfelBlock& block = map.blocks_.change(ranges[k].block);
    block.bounds.extend(results[k].moved);
    block.changed = map.frame();
  }
}

/// Sweeps up the dead surfels of the blocks that lost much, or whose turn it is.
std::size_t Fuser::clean(SurfelMap& map) {
  const auto frame = static_cast<std::uint32_t>(map.frame());
  std::vector<std::uint32_t> blocks = scratch_->emptied;
  for (const std::uint32_t i : scratch_->visible) {
    if (i % kSweptInView == frame % kSweptInView) blocks.push_back(i);
  }
  for (std::uint32_t i = frame % kSweptElsewhere; i < map.blocks_.size(); i += kSweptElsewhere) {
    if (map.blocks_[i].any_unstable) blocks.push_back(i);
  }
  std::sort(blocks.begin(), blocks.end());
  blocks.erase(std::unique(blocks.begin(), blocks.end()), blocks.end());
  const auto removed =
      deterministicSum<std::size_t>(blocks.size(), 1, [&](std::size_t begin, std::size_t end) {
        std::size_t count = 0;
        for (std::size_t k = begin; k < end; ++k) {
          const SurfelArrays& s = map.blocks_[blocks[k]].surfels;
          std::size_t dead = 0, unstable = 0;
          for (std::size_t i = 0; i < s.size(); ++i) {
            dead += map.isDead(s, i) ? 1 : 0;
            unstable += map.isStable(s, i) ? 0 : 1;
          }
          if (map.blocks_[blocks[k]].any_unstable != (unstable > 0)) {
            map.blocks_.change(blocks[k]).any_unstable = unstable > 0;
          }
          if (dead == 0) continue;
          count += map.removeFrom(blocks[k], [&](const SurfelArrays& surfels, std::size_t i) {
            return map.isDead(surfels, i);
          });
        }
        return count;
      });
  if (removed > 0) map.countMemory();
  return removed;
}

}  // namespace pf
