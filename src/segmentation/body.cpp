// SPDX-License-Identifier: BSD-3-Clause
#include "posefusion/segmentation/body.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

namespace pf {
namespace {

constexpr float kSampleSpacing_m = 0.07F;
constexpr int kMaxPartsOfLimb = 20;
constexpr int kMedianReach = 1;             // cells: 3x3, about 9x9 pixels of 640
constexpr float kMaxDepthSpread_m = 0.30F;  // of one person's seeds around their median
constexpr float kMaxOffMedian_m = 0.10F;    // of a seed's own depth from that around it
constexpr float kTorsoRadius_m = 0.175F;
constexpr float kHeadRadius_m = 0.12F;
constexpr float kLegRadius_m = 0.105F;
constexpr float kArmRadius_m = 0.084F;

using Limb = std::pair<Joint, Joint>;

/// The lines of the skeleton, and the pelvis, which a drawing leaves out.
constexpr std::array<Limb, kSkeletonLines.size() + 1> kLimbs = [] {
  std::array<Limb, kSkeletonLines.size() + 1> limbs{};
  for (std::size_t i = 0; i < kSkeletonLines.size(); ++i) {
    limbs[i].first = kSkeletonLines[i].first;
    limbs[i].second = kSkeletonLines[i].second;
  }
  limbs.back().first = Joint::right_hip;
  limbs.back().second = Joint::left_hip;
  return limbs;
}();

/// How far the body reaches round a joint, and round the limb that leads to it.
float jointRadius(int joint) {
  switch (static_cast<Joint>(joint)) {
    case Joint::neck:
    case Joint::right_shoulder:
    case Joint::left_shoulder:
    case Joint::right_hip:
    case Joint::left_hip:
      return kTorsoRadius_m;
    case Joint::right_elbow:
    case Joint::right_wrist:
    case Joint::left_elbow:
    case Joint::left_wrist:
      return kArmRadius_m;
    case Joint::right_knee:
    case Joint::right_ankle:
    case Joint::left_knee:
    case Joint::left_ankle:
      return kLegRadius_m;
    default:
      return kHeadRadius_m;
  }
}

/// A joint or a point of a limb that lies on a cell with depth.
struct Sample {
  int cell = -1;
  float depth_m = 0.0F;
};

Sample sampleAt(const SceneGrid& grid, float u, float v) {
  const int cell = grid.cellAt(u, v);
  if (cell < 0) return {};
  return {cell, medianDepth(grid, cell, kMedianReach)};
}

float medianOf(const std::vector<Sample>& samples) {
  std::vector<float> depths;
  for (const Sample& sample : samples) {
    if (sample.depth_m > 0.0F) depths.push_back(sample.depth_m);
  }
  if (depths.empty()) return 0.0F;
  std::nth_element(depths.begin(), depths.begin() + depths.size() / 2, depths.end());
  return depths[depths.size() / 2];
}

/// Points along a limb at most kSampleSpacing_m apart, without its ends.
std::vector<Sample> sampleLimb(const Keypoint& a, const Keypoint& b, float depth_m,
                               const SceneGrid& grid) {
  std::vector<Sample> samples;
  const float pixel_m = depth_m * grid.spacing / static_cast<float>(grid.step);
  const float length_m = std::hypot(b.u - a.u, b.v - a.v) * pixel_m;
  const int parts =
      std::clamp(static_cast<int>(length_m / kSampleSpacing_m) + 1, 1, kMaxPartsOfLimb);
  for (int i = 1; i < parts; ++i) {
    const float t = static_cast<float>(i) / static_cast<float>(parts);
    samples.push_back(sampleAt(grid, a.u + t * (b.u - a.u), a.v + t * (b.v - a.v)));
  }
  return samples;
}

Eigen::Vector3f lift(const Keypoint& joint, float depth_m, const SceneGrid& grid) {
  // The rays are linear in the pixel: take them from the two corners of the grid.
  const float step = static_cast<float>(grid.step);
  const float centre = 0.5F * (step - 1.0F);
  return {(grid.ray_x[0] + (joint.u - centre) / step * grid.spacing) * depth_m,
          (grid.ray_y[0] + (joint.v - centre) / step * (grid.ray_y[grid.cols] - grid.ray_y[0])) *
              depth_m,
          depth_m};
}

bool limbIsSeen(const Person& person, const Limb& limb) {
  return person.joints[static_cast<int>(limb.first)].p > 0.0F &&
         person.joints[static_cast<int>(limb.second)].p > 0.0F;
}

void addCapsules(const Person& person, const std::array<float, kJointCount>& depth,
                 const SceneGrid& grid, Body& body) {
  std::array<bool, kJointCount> covered{};
  for (const Limb& limb : kLimbs) {
    if (!limbIsSeen(person, limb)) continue;
    const int a = static_cast<int>(limb.first), b = static_cast<int>(limb.second);
    body.capsules.push_back({lift(person.joints[a], depth[a], grid),
                             lift(person.joints[b], depth[b], grid), jointRadius(b)});
    covered[a] = covered[b] = true;
  }
  for (int j = 0; j < kJointCount; ++j) {
    if (covered[j] || person.joints[j].p <= 0.0F) continue;
    const Eigen::Vector3f point = lift(person.joints[j], depth[j], grid);
    body.capsules.push_back({point, point, jointRadius(j)});
  }
}

}  // namespace

Body liftPerson(const Person& person, const SceneGrid& grid, float near_depth_m) {
  Body body;
  std::array<Sample, kJointCount> joints;
  std::vector<Sample> samples;
  for (int j = 0; j < kJointCount; ++j) {
    const Keypoint& joint = person.joints[j];
    if (joint.p <= 0.0F) continue;
    joints[j] = sampleAt(grid, joint.u, joint.v);
    samples.push_back(joints[j]);
  }
  const float depth_m = near_depth_m > 0.0F ? near_depth_m : medianOf(samples);
  if (depth_m <= 0.0F) return body;
  for (const Limb& limb : kLimbs) {
    if (!limbIsSeen(person, limb)) continue;
    const auto along = sampleLimb(person.joints[static_cast<int>(limb.first)],
                                  person.joints[static_cast<int>(limb.second)], depth_m, grid);
    samples.insert(samples.end(), along.begin(), along.end());
  }
  std::vector<Sample> kept;
  for (const Sample& sample : samples) {
    if (sample.depth_m > 0.0F && std::abs(sample.depth_m - depth_m) < kMaxDepthSpread_m &&
        std::abs(grid.z[sample.cell] - sample.depth_m) < kMaxOffMedian_m) {
      kept.push_back(sample);
      body.seeds.push_back(sample.cell);
    }
  }
  body.depth_m = medianOf(kept);
  if (body.depth_m <= 0.0F) return body;
  std::array<float, kJointCount> joint_depth;
  for (int j = 0; j < kJointCount; ++j) {
    const float z = joints[j].depth_m;
    joint_depth[j] = std::abs(z - body.depth_m) < kMaxDepthSpread_m ? z : body.depth_m;
  }
  addCapsules(person, joint_depth, grid, body);
  return body;
}

}  // namespace pf
