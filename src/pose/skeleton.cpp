// SPDX-License-Identifier: BSD-3-Clause
#include "posefusion/pose/skeleton.hpp"

namespace pf {

const std::array<std::string_view, kJointCount> kJointNames = {
    "nose",       "neck",       "right_shoulder", "right_elbow", "right_wrist", "left_shoulder",
    "left_elbow", "left_wrist", "right_hip",      "right_knee",  "right_ankle", "left_hip",
    "left_knee",  "left_ankle", "right_eye",      "left_eye",    "right_ear",   "left_ear"};

const std::array<std::pair<Joint, Joint>, 17> kSkeletonLines = {
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

}  // namespace pf
