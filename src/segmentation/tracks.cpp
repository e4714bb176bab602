// SPDX-License-Identifier: BSD-3-Clause
#include "posefusion/segmentation/tracks.hpp"

#include <algorithm>
#include <cmath>

namespace pf {
namespace {

constexpr int kMaskSamples = 30;         // per person
constexpr float kMaxDeviation = 0.019F;  // of a joint's flow from its person's, in image widths

float medianOf(std::vector<float>& values) {
  if (values.empty()) return 0.0F;
  std::nth_element(values.begin(), values.begin() + values.size() / 2, values.end());
  return values[values.size() / 2];
}

/// What is followed of one person, in pixels: first the joints that were seen, then samples of the
/// mask.
struct PersonPoints {
  std::vector<int> joints;
  std::vector<cv::Point2f> before;
};

PersonPoints pointsOf(const PersonTrack& track, const SceneGrid& grid) {
  PersonPoints points;
  for (int j = 0; j < kJointCount; ++j) {
    const Keypoint& joint = track.person.joints[j];
    if (joint.p <= 0.0F) continue;
    points.joints.push_back(j);
    points.before.emplace_back(joint.u, joint.v);
  }
  const std::size_t stride = std::max<std::size_t>(1, track.cells.size() / kMaskSamples);
  const float half = 0.5F * static_cast<float>(grid.step - 1);
  for (std::size_t i = stride / 2; i < track.cells.size(); i += stride) {
    const int col = track.cells[i] % grid.cols, row = track.cells[i] / grid.cols;
    points.before.emplace_back(static_cast<float>(col * grid.step) + half,
                               static_cast<float>(row * grid.step) + half);
  }
  return points;
}

cv::Point2f medianFlow(const std::vector<cv::Point2f>& before, const FollowedPoints& followed) {
  std::vector<float> du, dv;
  for (std::size_t i = 0; i < before.size(); ++i) {
    if (followed.found[i] == 0) continue;
    du.push_back(followed.after[i].x - before[i].x);
    dv.push_back(followed.after[i].y - before[i].y);
  }
  return {medianOf(du), medianOf(dv)};
}

void moveJoints(const PersonPoints& points, const FollowedPoints& followed,
                const cv::Point2f& median, float max_deviation_px, Person& person) {
  for (std::size_t i = 0; i < points.joints.size(); ++i) {
    cv::Point2f flow = followed.after[i] - points.before[i];
    const cv::Point2f deviation = flow - median;
    if (followed.found[i] == 0 || std::hypot(deviation.x, deviation.y) > max_deviation_px) {
      flow = median;
    }
    person.joints[points.joints[i]].u += flow.x;
    person.joints[points.joints[i]].v += flow.y;
  }
}

void moveCells(const SceneGrid& grid, int right, int down, std::vector<int>& cells) {
  std::size_t kept = 0;
  for (int cell : cells) {
    const int col = cell % grid.cols + right;
    const int row = cell / grid.cols + down;
    if (col < 0 || row < 0 || col >= grid.cols || row >= grid.rows) continue;
    cells[kept++] = row * grid.cols + col;
  }
  cells.resize(kept);
}

/// Joints outside the image, or nowhere (NaN), are not seen.
void dropJointsOutside(const SceneGrid& grid, Person& person) {
  for (Keypoint& joint : person.joints) {
    if (grid.cellAt(joint.u, joint.v) < 0) joint = Keypoint();
  }
}

}  // namespace

void carryTracks(const FlowTracker& flow, const SceneGrid& grid, std::vector<PersonTrack>& tracks) {
  const float step = static_cast<float>(grid.step);
  const float max_deviation_px = kMaxDeviation * step * static_cast<float>(grid.cols);
  for (PersonTrack& track : tracks) {
    track.fresh = false;
    const PersonPoints points = pointsOf(track, grid);
    if (points.before.empty()) continue;
    const FollowedPoints followed = flow.follow(points.before);
    const cv::Point2f median = medianFlow(points.before, followed);
    moveJoints(points, followed, median, max_deviation_px, track.person);
    dropJointsOutside(grid, track.person);
    moveCells(grid, static_cast<int>(std::lround(median.x / step)),
              static_cast<int>(std::lround(median.y / step)), track.cells);
  }
}

void mergeDetections(const People& people, const SceneGrid& grid,
                     std::vector<PersonTrack>& tracks) {
  std::vector<int> holder(grid.size(), -1);
  for (std::size_t t = 0; t < tracks.size(); ++t) {
    for (int cell : tracks[t].cells) holder[cell] = static_cast<int>(t);
  }
  const std::size_t carried = tracks.size();
  for (Person person : people.people) {
    dropJointsOutside(grid, person);
    std::vector<int> votes(carried, 0);
    int joints = 0;
    for (const Keypoint& joint : person.joints) {
      const int cell = joint.p > 0.0F ? grid.cellAt(joint.u, joint.v) : -1;
      if (cell < 0) continue;
      ++joints;
      if (holder[cell] >= 0) ++votes[holder[cell]];
    }
    int best = -1;
    for (std::size_t t = 0; t < carried; ++t) {
      if (tracks[t].fresh || 3 * votes[t] < joints || votes[t] == 0) continue;
      if (best < 0 || votes[t] > votes[best]) best = static_cast<int>(t);
    }
    if (best < 0) {
      tracks.emplace_back();
      tracks.back().person = person;
      tracks.back().fresh = true;
      continue;
    }
    PersonTrack& track = tracks[best];
    const Person old = track.person;
    track.person = person;
    for (int j = 0; j < kJointCount; ++j) {
      // Kept joints fade, so that they go after a few detections without them.
      if (person.joints[j].p <= 0.0F && old.joints[j].p > 0.1F) {
        track.person.joints[j] = old.joints[j];
        track.person.joints[j].p *= 0.6F;
      }
    }
    track.fresh = true;
    track.unseen = 0.0;
  }
}

}  // namespace pf
