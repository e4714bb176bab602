// SPDX-License-Identifier: BSD-3-Clause
#include "posefusion/segmentation/tracks.hpp"

#include <algorithm>
#include <cmath>
#include <opencv2/imgproc.hpp>
#include <opencv2/video/tracking.hpp>

namespace pf {
namespace {

constexpr int kFlowWidth = 320;  // pixels of the images that flow is measured on
constexpr int kPyramidLevels = 2;
constexpr int kMaskSamples = 30;          // per person
constexpr float kMaxDeviation_px = 6.0F;  // of a joint's flow from its person's, at kFlowWidth
const cv::Size kWindow(13, 13);

float medianOf(std::vector<float>& values) {
  if (values.empty()) return 0.0F;
  std::nth_element(values.begin(), values.begin() + values.size() / 2, values.end());
  return values[values.size() / 2];
}

/// What of one person is followed: first the seen joints, then samples of the mask.
struct Points {
  std::vector<int> joints;
  std::vector<cv::Point2f> before, after;
  std::vector<std::uint8_t> found;
};

Points pointsOf(const PersonTrack& track, const SceneGrid& grid, float scale) {
  Points points;
  for (int j = 0; j < kJointCount; ++j) {
    const Keypoint& joint = track.person.joints[j];
    if (joint.p <= 0.0F) continue;
    points.joints.push_back(j);
    points.before.emplace_back(joint.u * scale, joint.v * scale);
  }
  const std::size_t stride = std::max<std::size_t>(1, track.cells.size() / kMaskSamples);
  const float cell_px = static_cast<float>(grid.step) * scale;
  for (std::size_t i = stride / 2; i < track.cells.size(); i += stride) {
    points.before.emplace_back((track.cells[i] % grid.cols + 0.5F) * cell_px,
                               (track.cells[i] / grid.cols + 0.5F) * cell_px);
  }
  return points;
}

cv::Point2f medianFlow(const Points& points) {
  std::vector<float> du, dv;
  for (std::size_t i = 0; i < points.before.size(); ++i) {
    if (!points.found[i]) continue;
    du.push_back(points.after[i].x - points.before[i].x);
    dv.push_back(points.after[i].y - points.before[i].y);
  }
  return {medianOf(du), medianOf(dv)};
}

void moveJoints(const Points& points, const cv::Point2f& median, float scale, Person& person) {
  for (std::size_t i = 0; i < points.joints.size(); ++i) {
    cv::Point2f flow = points.after[i] - points.before[i];
    const cv::Point2f deviation = flow - median;
    if (!points.found[i] || std::hypot(deviation.x, deviation.y) > kMaxDeviation_px) flow = median;
    person.joints[points.joints[i]].u += flow.x / scale;
    person.joints[points.joints[i]].v += flow.y / scale;
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

void TrackCarrier::buildPyramid(const RgbdFrame& frame) {
  if (current_stamp_ns_ == frame.stamp_ns && !current_.empty()) return;
  cv::Mat grey, small;
  const int width = std::min(kFlowWidth, frame.color.cols);
  scale_ = static_cast<float>(width) / static_cast<float>(frame.color.cols);
  const int height = std::max(1, static_cast<int>(std::lround(frame.color.rows * scale_)));
  cv::resize(frame.color, small, {width, height}, 0, 0, cv::INTER_AREA);
  cv::cvtColor(small, grey, cv::COLOR_RGB2GRAY);
  current_.clear();
  cv::buildOpticalFlowPyramid(grey, current_, kWindow, kPyramidLevels);
  current_stamp_ns_ = frame.stamp_ns;
}

void TrackCarrier::carry(const RgbdFrame& frame, const SceneGrid& grid,
                         std::vector<PersonTrack>& tracks) {
  buildPyramid(frame);
  const bool comparable = !last_.empty() && last_[0].size() == current_[0].size();
  const cv::TermCriteria stop(cv::TermCriteria::COUNT + cv::TermCriteria::EPS, 8, 0.05);
  for (PersonTrack& track : tracks) {
    track.fresh = false;
    if (!comparable) continue;
    Points points = pointsOf(track, grid, scale_);
    if (points.before.empty()) continue;
    cv::calcOpticalFlowPyrLK(last_, current_, points.before, points.after, points.found,
                             cv::noArray(), kWindow, kPyramidLevels, stop);
    const cv::Point2f median = medianFlow(points);
    moveJoints(points, median, scale_, track.person);
    dropJointsOutside(grid, track.person);
    const float cell_px = static_cast<float>(grid.step) * scale_;
    moveCells(grid, static_cast<int>(std::lround(median.x / cell_px)),
              static_cast<int>(std::lround(median.y / cell_px)), track.cells);
  }
}

void TrackCarrier::remember(const RgbdFrame& frame) {
  buildPyramid(frame);
  last_.swap(current_);
  current_.clear();
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
