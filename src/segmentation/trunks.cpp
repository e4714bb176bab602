// SPDX-License-Identifier: BSD-3-Clause
#include "posefusion/segmentation/trunks.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <opencv2/imgproc.hpp>

#include "posefusion/segmentation/mapped_people.hpp"

namespace pf {
namespace {

constexpr std::array<Joint, 4> kCorners = {Joint::right_shoulder, Joint::left_shoulder,
                                           Joint::left_hip, Joint::right_hip};
constexpr int kJointReach = 1;         // cells around a joint whose median depth is taken
constexpr float kMaxSpread_m = 0.30F;  // of the joints in depth
constexpr float kMaxOff_m = 0.15F;     // of a cell from the mean of the joints
constexpr float kBeyondJoints = 1.2F;  // the trunk is larger by this: joints lie inside the body

/// The outline of a trunk in cells, and its depth; no outline where it is not known.
struct Trunk {
  std::vector<cv::Point> outline;
  float depth_m = 0.0F;
};

Trunk trunkOf(const Person& person, const SceneGrid& grid, const std::vector<Flatness>& flatness) {
  std::vector<cv::Point2f> corners;
  float nearest = 1e9F, farthest = 0.0F, sum = 0.0F;
  cv::Point2f centre;
  for (const Joint joint : kCorners) {
    const Keypoint& k = person.joints[static_cast<std::size_t>(joint)];
    const int cell = k.p > 0.0F ? grid.cellAt(k.u, k.v) : -1;
    if (cell < 0 || flatness[cell] != Flatness::none) return {};
    const float depth = medianDepth(grid, cell, kJointReach);
    if (depth <= 0.0F) return {};
    nearest = std::min(nearest, depth);
    farthest = std::max(farthest, depth);
    sum += depth;
    corners.emplace_back(static_cast<float>(cell % grid.cols),
                         static_cast<float>(cell / grid.cols));
    centre += corners.back();
  }
  if (farthest - nearest > kMaxSpread_m) return {};
  centre *= 1.0F / kCorners.size();
  Trunk trunk{{}, sum / kCorners.size()};
  for (cv::Point2f& corner : corners) corner = centre + kBeyondJoints * (corner - centre);
  std::vector<cv::Point2f> hull;
  cv::convexHull(corners, hull);
  for (const cv::Point2f& p : hull) trunk.outline.emplace_back(cvRound(p.x), cvRound(p.y));
  return trunk;
}

}  // namespace

void doubtTrunks(const std::vector<TrackedPerson>& people, const SceneGrid& grid,
                 const std::vector<Flatness>& flatness, std::vector<Background>& background) {
  for (const TrackedPerson& tracked : people) {
    if (!tracked.fresh || !isSure(tracked.person)) continue;
    const Trunk trunk = trunkOf(tracked.person, grid, flatness);
    if (trunk.outline.empty()) continue;
    cv::Mat inside = cv::Mat::zeros(grid.rows, grid.cols, CV_8UC1);
    cv::fillConvexPoly(inside, trunk.outline, 255);
    for (int cell = 0; cell < grid.size(); ++cell) {
      if (background[cell] == Background::agrees && inside.data[cell] != 0 &&
          std::abs(grid.z[cell] - trunk.depth_m) < kMaxOff_m) {
        background[cell] = Background::recent;
      }
    }
  }
}

}  // namespace pf
