// SPDX-License-Identifier: BSD-3-Clause
#include "bag_topics.hpp"

#include <rosbag/view.h>

#include <algorithm>
#include <vector>

#include "posefusion/core/error.hpp"

namespace posefusion_ros {
namespace {

using pf::InputError;
using Names = std::vector<std::string>;

const Names kImageTypes = {"sensor_msgs/Image", "sensor_msgs/CompressedImage"};
const Names kCameraTypes = {"sensor_msgs/CameraInfo"};
const Names kPeopleTypes = {"posefusion/People"};
const Names kTruthTypes = {"geometry_msgs/PoseStamped"};

// Endings of the usual names, best first.
const Names kColorNames = {"rgb/image_rect_color",
                           "rgb/image_color",
                           "rgb/image_raw",
                           "color/image_rect_color",
                           "color/image_raw",
                           "rgb/image",
                           "image_color",
                           "rgb/image_rect_color/compressed",
                           "rgb/image_color/compressed",
                           "rgb/image_raw/compressed",
                           "color/image_raw/compressed",
                           "image_color/compressed",
                           "qhd/image_color_rect",
                           "qhd/image_color_rect/compressed"};
const Names kDepthNames = {"depth_registered/image_rect",
                           "depth_registered/image_raw",
                           "depth_registered/image",
                           "depth_registered/hw_registered/image_rect_raw",
                           "aligned_depth_to_color/image_raw",
                           "depth_to_rgb/image_raw",
                           "depth/image_raw",
                           "depth/image_rect_raw",
                           "depth/image_rect",
                           "depth/image",
                           "depth_registered/image_raw/compressedDepth",
                           "depth_registered/image/compressedDepth",
                           "aligned_depth_to_color/image_raw/compressedDepth",
                           "depth/image_raw/compressedDepth",
                           "depth/image/compressedDepth",
                           "aligned_depth_to_color/image_raw/compressed",
                           "depth_to_rgb/image_raw/compressed",
                           "depth_to_rgb/image_raw/compressedDepth",
                           "qhd/image_depth_rect",
                           "qhd/image_depth_rect/compressed"};
const Names kTruthNames = {"truth", "ground_truth", "groundtruth"};

bool contains(const Names& names, const std::string& name) {
  return std::find(names.begin(), names.end(), name) != names.end();
}

bool endsWith(const std::string& topic, const std::string& ending) {
  if (topic == ending) return true;
  const std::string full = "/" + ending;
  return topic.size() >= full.size() &&
         topic.compare(topic.size() - full.size(), full.size(), full) == 0;
}

std::string listText(const TopicTypes& available) {
  std::string text;
  for (const auto& [topic, type] : available) text += "\n  " + topic + " [" + type + "]";
  return available.empty() ? " nothing" : text;
}

/// A topic that the user named.
std::string checked(const TopicTypes& available, const std::string& topic, const Names& types) {
  const auto found = available.find(topic);
  if (found == available.end()) {
    throw InputError("topic " + topic + " is not in the bag, which has" + listText(available));
  }
  if (!contains(types, found->second)) {
    throw InputError("topic " + topic + " is a " + found->second + ", expected " + types.front());
  }
  return topic;
}

/// The topic with the best of the usual names; empty when none has one.
std::string findByName(const TopicTypes& available, const Names& endings, const Names& types) {
  for (const auto& ending : endings) {
    for (const auto& [topic, type] : available) {
      if (contains(types, type) && endsWith(topic, ending)) return topic;
    }
  }
  return {};
}

std::string findImage(const TopicTypes& available, const Names& endings, const std::string& what) {
  const std::string topic = findByName(available, endings, kImageTypes);
  if (topic.empty()) {
    throw InputError("no topic has a usual name of a " + what + " image (name it with --" + what +
                     "-topic); the bag has" + listText(available));
  }
  return topic;
}

std::string findOnly(const TopicTypes& available, const Names& types) {
  std::string found;
  for (const auto& [topic, type] : available) {
    if (!contains(types, type)) continue;
    if (!found.empty()) return {};
    found = topic;
  }
  return found;
}

/// camera_info beside the image: /camera/rgb/image_raw/compressed -> /camera/rgb/camera_info.
std::string cameraInfoBeside(const TopicTypes& available, std::string image) {
  while (image.find('/') != std::string::npos) {
    image.erase(image.rfind('/'));
    const auto found = available.find(image + "/camera_info");
    if (found != available.end() && contains(kCameraTypes, found->second)) return found->first;
  }
  return {};
}

}  // namespace

TopicTypes topicsOf(const rosbag::Bag& bag) {
  TopicTypes topics;
  rosbag::View view(bag);
  for (const auto* connection : view.getConnections()) {
    topics[connection->topic] = connection->datatype;
  }
  return topics;
}

BagTopics chooseTopics(const TopicTypes& available, const BagTopics& given) {
  BagTopics t;
  t.color = given.color.empty() ? findImage(available, kColorNames, "color")
                                : checked(available, given.color, kImageTypes);
  t.depth = given.depth.empty() ? findImage(available, kDepthNames, "depth")
                                : checked(available, given.depth, kImageTypes);
  if (!given.camera_info.empty()) {
    t.camera_info = checked(available, given.camera_info, kCameraTypes);
  } else {
    // Registered depth has the camera of the colour image.
    t.camera_info = cameraInfoBeside(available, t.color);
    if (t.camera_info.empty()) t.camera_info = cameraInfoBeside(available, t.depth);
    if (t.camera_info.empty()) t.camera_info = findOnly(available, kCameraTypes);
  }
  t.depth_camera_info = given.depth_camera_info.empty()
                            ? cameraInfoBeside(available, t.depth)
                            : checked(available, given.depth_camera_info, kCameraTypes);
  t.people = given.people.empty() ? findOnly(available, kPeopleTypes)
                                  : checked(available, given.people, kPeopleTypes);
  t.truth = given.truth.empty() ? findByName(available, kTruthNames, kTruthTypes)
                                : checked(available, given.truth, kTruthTypes);
  return t;
}

}  // namespace posefusion_ros
