// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <memory>
#include <opencv2/core.hpp>
#include <string>

#include "posefusion/pose/person_mask.hpp"

namespace pf {

/// Of the maps of joints and centres, cells of 4x4 pixels of the input.
constexpr int kMapWidth = kDepthInputWidth / 4, kMapHeight = kDepthInputHeight / 4;

/// What the embedded person model says of a frame. Views of its memory.
struct PersonMaps {
  cv::Mat mask;                             ///< CV_32FC1, 60x80: probability of a person
  std::array<cv::Mat, kJointCount> joints;  ///< CV_32FC1, 30x40 each: probability of the joint
  cv::Mat centre;    ///< CV_32FC1, 30x40: probability of a body's centre (middle of neck and hips)
  cv::Mat offset_x;  ///< CV_32FC1, 30x40, to the centre of the body that the cell shows, in
  cv::Mat offset_y;  ///< kOffsetUnit_px pixels of the input
};

/// One step of PersonMaps::offset_x and _y, in pixels of the model's input.
constexpr float kOffsetUnit_px = 10.0F;

/// The network that finds people in depth alone; its weights, models/person.onnx, come with the
/// package. One thread at a time; the result does not depend on the number of threads.
class PersonModel {
 public:
  /// Throws InputError naming the file if it is missing, damaged, or a network of other inputs or
  /// outputs.
  explicit PersonModel(const std::string& path);
  ~PersonModel();

  /// `small_m`: depth as from shrinkDepth(). The maps are valid until the next call.
  PersonMaps infer(const cv::Mat& small_m);

 private:
  struct Backend;
  std::string path_;
  std::unique_ptr<Backend> backend_;
};

/// Where the package's own weights lie, in the source tree or as installed.
std::string packagedPersonModel();

}  // namespace pf
