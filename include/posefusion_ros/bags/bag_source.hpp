// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <memory>
#include <string>

#include "posefusion/io/frame_source.hpp"

namespace posefusion_ros {

/// Topics to read; an empty one is found by its usual names.
struct BagTopics {
  std::string color;        ///< sensor_msgs/Image or CompressedImage
  std::string depth;        ///< registered with colour: Image (16UC1 mm, 32FC1 m), compressedDepth
                            ///< or a PNG in a CompressedImage
  std::string camera_info;  ///< of the colour image
  std::string depth_camera_info;  ///< of depth; needed where its images have another size
  std::string people;             ///< posefusion/People
  std::string truth;              ///< geometry_msgs/PoseStamped, the camera's
};

struct InputOptions {
  std::string camera_file;              ///< instead of the input's own camera
  double max_pair_difference_s = 0.02;  ///< between the stamps of colour and depth
  double depth_stamp_offset_s = 0.0;    ///< added to the stamps of depth before that
  BagTopics topics;
};

/// Opens a bag; no master is needed. Colour and depth are paired by the nearest stamp; what finds
/// no partner is counted. Frames come in the order of recording; one whose stamp is not later than
/// all before it comes with a defect. The camera is that of the first camera_info; images of a
/// topic with "rect" in its name are free of distortion. Throws InputError naming the bag and what
/// is in it when it is damaged, or something is missing.
std::unique_ptr<pf::FrameSource> openBag(const std::string& path, const InputOptions& options = {});

/// A TUM folder, or a bag (a file).
std::unique_ptr<pf::FrameSource> openInput(const std::string& path,
                                           const InputOptions& options = {});

/// The frame_id of the first colour image; empty for a TUM folder. Throws as openInput().
std::string recordedFrameId(const std::string& path, const BagTopics& topics);

}  // namespace posefusion_ros
