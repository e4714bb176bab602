// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <array>
#include <cstdint>
#include <opencv2/core.hpp>
#include <string_view>
#include <utility>
#include <vector>

namespace pf {

/// COCO-18 joints in OpenPose's order.
enum class Joint : int {
  nose,
  neck,
  right_shoulder,
  right_elbow,
  right_wrist,
  left_shoulder,
  left_elbow,
  left_wrist,
  right_hip,
  right_knee,
  right_ankle,
  left_hip,
  left_knee,
  left_ankle,
  right_eye,
  left_eye,
  right_ear,
  left_ear
};
constexpr int kJointCount = 18;

/// Names as in COCO, indexed by Joint ("nose", "neck", "right_shoulder", ...).
inline constexpr std::array<std::string_view, kJointCount> kJointNames = {
    "nose",       "neck",       "right_shoulder", "right_elbow", "right_wrist", "left_shoulder",
    "left_elbow", "left_wrist", "right_hip",      "right_knee",  "right_ankle", "left_hip",
    "left_knee",  "left_ankle", "right_eye",      "left_eye",    "right_ear",   "left_ear"};

/// Limbs: joints that a drawing of a skeleton connects.
inline constexpr std::array<std::pair<Joint, Joint>, 17> kSkeletonLines = {
    {{Joint::neck, Joint::right_shoulder},
     {Joint::right_shoulder, Joint::right_elbow},
     {Joint::right_elbow, Joint::right_wrist},
     {Joint::neck, Joint::left_shoulder},
     {Joint::left_shoulder, Joint::left_elbow},
     {Joint::left_elbow, Joint::left_wrist},
     {Joint::neck, Joint::right_hip},
     {Joint::right_hip, Joint::right_knee},
     {Joint::right_knee, Joint::right_ankle},
     {Joint::neck, Joint::left_hip},
     {Joint::left_hip, Joint::left_knee},
     {Joint::left_knee, Joint::left_ankle},
     {Joint::neck, Joint::nose},
     {Joint::nose, Joint::right_eye},
     {Joint::right_eye, Joint::right_ear},
     {Joint::nose, Joint::left_eye},
     {Joint::left_eye, Joint::left_ear}}};

/// A joint in the image. Shape of the paper's matrix element (u, v, p).
struct Keypoint {
  float u = 0.0F;  ///< column, pixels
  float v = 0.0F;  ///< row, pixels
  float p = 0.0F;  ///< likelihood in (0, 1]; 0: the joint was not seen
};

struct Person {
  std::array<Keypoint, kJointCount> joints{};
  float score = 0.0F;  ///< mean score of joints and limbs
  int id = 0;          ///< the same from frame to frame, from 1 on; 0: not followed
};

/// What a detector says of the pixels of a frame, on a coarse grid laid over the image: cell (x, y)
/// covers 2x2 cells of depthInputGrid() for the frame's size.
struct PersonMask {
  cv::Mat probability;  ///< CV_8UC1, 255 = surely a person
  cv::Mat owner;  ///< CV_8UC1, same size: 1 + index of the person in People::people, 0: no person

  bool empty() const { return probability.empty(); }
};

/// The people of one frame: the paper's [h x w] matrix with h <= 15.
struct People {
  std::int64_t stamp_ns = 0;
  bool detected = false;  ///< false: the detector did not look at this frame
  std::vector<Person> people;
  PersonMask mask{};  ///< empty: the detector knows of joints alone
};

}  // namespace pf
