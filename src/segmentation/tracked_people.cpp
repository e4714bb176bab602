// SPDX-License-Identifier: BSD-3-Clause
#include "posefusion/segmentation/tracked_people.hpp"

#include <algorithm>
#include <cmath>

namespace pf {
namespace {

constexpr int kMaskSamples = 30;         // points of each person's mask whose flow is measured
constexpr float kMaxDeviation = 0.019F;  // of a joint's flow from its person's, in image widths
// A carried joint that leaves the image still shows where the rest of its limb is; so far, in image
// widths.
constexpr float kReachOutside = 0.3F;
constexpr int kMinJointsShare = 3;          // a detection continues a mask with 1/3 of its joints
constexpr float kMissedJointFading = 0.6F;  // likelihood of a joint that a detection missed ...
constexpr float kFrameFading = 0.93F;  // ... or, where every frame (at 30 Hz) brings one, this,
constexpr float kMinKeptLikelihood = 0.1F;  // and which is kept while it was above this

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
  FollowedPoints followed;
  cv::Point2f median_flow;
};

PersonPoints pointsOf(const TrackedPerson& tracked, const SceneGrid& grid) {
  PersonPoints points;
  for (int j = 0; j < kJointCount; ++j) {
    const Keypoint& joint = tracked.person.joints[j];
    if (joint.p <= 0.0F) continue;
    points.joints.push_back(j);
    points.before.emplace_back(joint.u, joint.v);
  }
  const std::size_t stride = std::max<std::size_t>(1, tracked.cells.size() / kMaskSamples);
  const float centre = 0.5F * static_cast<float>(grid.step - 1);
  for (std::size_t i = stride / 2; i < tracked.cells.size(); i += stride) {
    const int col = tracked.cells[i] % grid.cols, row = tracked.cells[i] / grid.cols;
    points.before.emplace_back(static_cast<float>(col * grid.step) + centre,
                               static_cast<float>(row * grid.step) + centre);
  }
  return points;
}

void follow(const FlowImages& flow, PersonPoints& points) {
  points.followed = flow.follow(points.before);
  std::vector<float> du, dv;
  for (std::size_t i = 0; i < points.before.size(); ++i) {
    if (points.followed.found[i] == 0) continue;
    du.push_back(points.followed.after[i].x - points.before[i].x);
    dv.push_back(points.followed.after[i].y - points.before[i].y);
  }
  points.median_flow = {medianOf(du), medianOf(dv)};
}

void moveJoints(const PersonPoints& points, float max_deviation_px, Person& person) {
  for (std::size_t i = 0; i < points.joints.size(); ++i) {
    cv::Point2f flow = points.followed.after[i] - points.before[i];
    const cv::Point2f deviation = flow - points.median_flow;
    if (points.followed.found[i] == 0 || std::hypot(deviation.x, deviation.y) > max_deviation_px) {
      flow = points.median_flow;
    }
    person.joints[points.joints[i]].u += flow.x;
    person.joints[points.joints[i]].v += flow.y;
  }
}

void moveCells(const SceneGrid& grid, const cv::Point2f& flow_px, std::vector<int>& cells) {
  const float step = static_cast<float>(grid.step);
  const int right = static_cast<int>(std::lround(flow_px.x / step));
  const int down = static_cast<int>(std::lround(flow_px.y / step));
  std::size_t kept = 0;
  for (int cell : cells) {
    const int col = cell % grid.cols + right;
    const int row = cell / grid.cols + down;
    if (col < 0 || row < 0 || col >= grid.cols || row >= grid.rows) continue;
    cells[kept++] = row * grid.cols + col;
  }
  cells.resize(kept);
}

/// Which of the carried people a detection continues, -1: none. `holder`: for each cell the person
/// whose mask holds it, or -1.
int findContinued(const Person& detected, const SceneGrid& grid, const std::vector<int>& holder,
                  const std::vector<TrackedPerson>& people) {
  std::vector<int> votes(people.size(), 0);
  int joints = 0;
  for (const Keypoint& joint : detected.joints) {
    const int cell = joint.p > 0.0F ? grid.cellAt(joint.u, joint.v) : -1;
    if (cell < 0) continue;
    ++joints;
    if (holder[cell] >= 0) ++votes[holder[cell]];
  }
  int best = -1;
  for (std::size_t i = 0; i < people.size(); ++i) {
    if (people[i].fresh || kMinJointsShare * votes[i] < joints || votes[i] == 0) continue;
    if (best < 0 || votes[i] > votes[best]) best = static_cast<int>(i);
  }
  return best;
}

/// Kept joints fade, so that they go after a few detections without them. Where detections come
/// with every frame, a joint that was seen better not long ago is kept too.
void continuePerson(const Person& detected, bool with_every_frame, float worth,
                    TrackedPerson& tracked) {
  const Person old = tracked.person;
  const float fading = with_every_frame ? std::pow(kFrameFading, worth) : kMissedJointFading;
  tracked.person = detected;
  for (int j = 0; j < kJointCount; ++j) {
    const float kept = old.joints[j].p * fading;
    const bool is_better = with_every_frame && kept > detected.joints[j].p;
    if (detected.joints[j].p > 0.0F && !is_better) continue;
    if (old.joints[j].p <= kMinKeptLikelihood) continue;
    tracked.person.joints[j] = old.joints[j];
    tracked.person.joints[j].p = kept;
  }
}

}  // namespace

void dropJointsOutside(const SceneGrid& grid, float margin_px, Person& person) {
  const float right = static_cast<float>(grid.step * grid.cols) + margin_px;
  const float bottom = static_cast<float>(grid.step * grid.rows) + margin_px;
  for (Keypoint& joint : person.joints) {
    const bool near =
        joint.u >= -margin_px && joint.v >= -margin_px && joint.u < right && joint.v < bottom;
    if (!near) joint = Keypoint();
  }
}

void carryPeople(const FlowImages& flow, const SceneGrid& grid,
                 std::vector<TrackedPerson>& people) {
  const auto width_px = static_cast<float>(grid.step * grid.cols);
  const float max_deviation_px = kMaxDeviation * width_px;
  for (TrackedPerson& tracked : people) {
    tracked.fresh = false;
    tracked.detection = -1;
    PersonPoints points = pointsOf(tracked, grid);
    if (points.before.empty()) continue;
    follow(flow, points);
    moveJoints(points, max_deviation_px, tracked.person);
    dropJointsOutside(grid, kReachOutside * width_px, tracked.person);
    moveCells(grid, points.median_flow, tracked.cells);
  }
}

void mergeDetections(const People& detected, const std::vector<bool>& may_be_new,
                     const SceneGrid& grid, float worth, std::vector<TrackedPerson>& people) {
  std::vector<int> holder(grid.size(), -1);
  for (std::size_t i = 0; i < people.size(); ++i) {
    for (int cell : people[i].cells) holder[cell] = static_cast<int>(i);
  }
  for (std::size_t i = 0; i < detected.people.size(); ++i) {
    Person person = detected.people[i];
    dropJointsOutside(grid, 0.0F, person);
    const int continued = findContinued(person, grid, holder, people);
    if (continued < 0 && !may_be_new[i]) continue;
    if (continued < 0) {
      people.emplace_back();
      people.back().person = person;
    } else {
      continuePerson(person, !detected.mask.empty(), worth, people[continued]);
    }
    TrackedPerson& tracked = continued < 0 ? people.back() : people[continued];
    tracked.fresh = true;
    tracked.detection = static_cast<int>(i);
    tracked.unseen = 0.0;
  }
}

}  // namespace pf
