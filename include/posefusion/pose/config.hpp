// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string>

#include "posefusion/config/fields.hpp"

namespace pf {

/// The detector where neither it nor a pose network is named.
constexpr const char* kDefaultDetector = "embedded";
/// The detector where a pose network is named alone.
constexpr const char* kDefaultWithNetwork = "network+embedded";
/// How often a pose network looks: alone, and beside the embedded model, which sees all frames.
constexpr int kLookAlone_frames = 2;
constexpr int kLookBeside_frames = 5;

/// Settings of the pose detector.
struct PoseConfig {
  std::string detector = "auto";
  std::string model;
  std::string embedded_model;
  int input_height_px = 0;
  int every_nth_frame = 0;
  double min_peak = 0.05;
  double min_person_score = 0.4;
  int min_person_joints = 3;
  int max_people = 15;
};

inline void visitFields(PoseConfig& c, FieldVisitor& v) {
  v.integer(
      "every_nth_frame", c.every_nth_frame, 0, 1000,
      "the network sees every n-th sharp frame; people are carried between; the embedded model "
      "sees all; 0 = every 2nd where the network is alone, every 5th beside the embedded model");
  v.number("min_peak", c.min_peak, 0.0, 1.0, "smallest heat-map value of a joint");
  v.number("min_person_score", c.min_person_score, 0.0, 1.0, "smallest mean score of a person");
  v.integer("min_person_joints", c.min_person_joints, 1, 18, "fewest joints of a person");
  v.integer("max_people", c.max_people, 1, 15, "people kept per frame, best first");
  v.atStart();
  v.choice("detector", c.detector,
           {"auto", "embedded", "network", "network+embedded", "recorded", "none"},
           "where people come from: the package's own model of depth, a pose network, both, People "
           "recorded with the input, or nowhere; auto: both where `model` names a network, else "
           "embedded");
  v.text("model", c.model,
         "weights of the pose network (.pb, .caffemodel, .onnx), its settings in the "
         ".yaml of the same name beside it or in config/models; empty = from scripts/get_models");
  v.text("embedded_model", c.embedded_model,
         "weights of the person model of depth (.onnx); empty = the package's own");
  v.integer("input_height_px", c.input_height_px, 0, 4096,
            "height of the network's input, the width follows; 0 = as the model's settings say");
}

/// The detector that the settings choose: never "auto".
inline std::string chosenDetector(const PoseConfig& c) {
  if (c.detector != "auto") return c.detector;
  return c.model.empty() ? kDefaultDetector : kDefaultWithNetwork;
}

/// The network looks once in so many frames: at least 1.
inline int lookInterval_frames(const PoseConfig& c) {
  if (c.every_nth_frame > 0) return c.every_nth_frame;
  return chosenDetector(c) == "network" ? kLookAlone_frames : kLookBeside_frames;
}

}  // namespace pf
