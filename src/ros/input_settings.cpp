// SPDX-License-Identifier: BSD-3-Clause
#include "posefusion_ros/input_settings.hpp"

#include <array>

#include "posefusion/core/error.hpp"
#include "posefusion/io/files.hpp"
#include "posefusion_ros/names.hpp"

namespace posefusion_ros {
namespace {

using Topic = std::string InputSettings::*;
constexpr std::array<Topic, 4> kTopics = {&InputSettings::color_topic, &InputSettings::depth_topic,
                                          &InputSettings::camera_info_topic,
                                          &InputSettings::depth_camera_info_topic};

std::string below(const std::string& camera_name, const std::string& topic) {
  if (topic.front() == '/') return topic;
  if (camera_name.empty()) return "/" + topic;
  return (camera_name.front() == '/' ? "" : "/") + camera_name + "/" + topic;
}

}  // namespace

std::string InputSettings::depthTransport() const {
  if (depth_image_transport != "auto") return depth_image_transport;
  return image_transport == "compressed" ? "compressedDepth" : image_transport;
}

void visitFields(InputSettings& s, pf::FieldVisitor& v) {
  v.text("camera_name", s.camera_name, "namespace of the topics that do not begin with /");
  v.text("color_topic", s.color_topic, "raw name, without the transport");
  v.text("depth_topic", s.depth_topic, "registered to colour");
  v.text("camera_info_topic", s.camera_info_topic, "of colour");
  v.text("depth_camera_info_topic", s.depth_camera_info_topic,
         "of depth; needed where its images have another size");
  v.choice("image_transport", s.image_transport, {"raw", "compressed"}, "of colour");
  v.choice("depth_image_transport", s.depth_image_transport,
           {"auto", "raw", "compressed", "compressedDepth"},
           "compressed: plain PNG; auto: compressedDepth where colour is compressed");
  v.choice("input_rectified", s.input_rectified, {"auto", "yes", "no"},
           "auto: where the name of the colour topic has _rect");
  v.flag("require_same_frame", s.require_same_frame,
         "refuse depth whose frame_id is not that of colour");
  v.number("depth_unit_m", s.depth_unit_m, 1e-6, 1.0, "of 16-bit depth");
  v.number("depth_stamp_offset_s", s.depth_stamp_offset_s, -10.0, 10.0,
           "added to the stamps of depth before they are compared with those of colour");
  PairingSettings& p = s.pairing;
  v.integer("queue_size", p.queue_size, 1, 10000, "images that wait for their partner");
  v.flag("approximate_sync", p.approximate, "false: equal stamps only");
  v.number("max_interval_s", p.max_interval_s, 0.0, 10.0, "between colour and depth");
  v.number("time_jump_threshold_s", p.time_jump_threshold_s, 0.0, 1e6,
           "stamps that go back further begin anew");
}

CameraSettings loadCameraSettings(const std::string& path) {
  pf::YamlMap file(pf::parseYaml(pf::readFile(path), path), path + ": ");
  CameraSettings camera;
  pf::YamlFields fields(file);
  fields.enter("input");
  visitFields(camera.input, fields);
  fields.leave();
  file.map("input");  // is asked for
  camera.settings = pf::parseYaml(pf::readFile(path), path)["settings"];
  file.map("settings");
  file.finish();
  pf::Config checked;
  if (camera.settings) pf::applyYaml(checked, camera.settings, path + ": settings");
  return camera;
}

InputSettings readInput(Parameters& parameters) {
  const std::string file = parameters.text("camera_settings", "");
  InputSettings named;
  named.color_topic = topics::kColor;
  named.depth_topic = topics::kDepth;
  named.camera_info_topic = topics::kCameraInfo;
  named.depth_camera_info_topic = topics::kDepthCameraInfo;
  InputSettings settings = file.empty() ? InputSettings() : loadCameraSettings(file).input;
  const InputSettings of_file = settings;
  settings.camera_name.clear();
  for (const Topic topic : kTopics) (settings.*topic).clear();
  ParameterFields fields(parameters);
  visitFields(settings, fields);
  if (settings.camera_name.empty()) settings.camera_name = of_file.camera_name;
  for (const Topic topic : kTopics) {
    if (!(settings.*topic).empty()) continue;
    const std::string& in_file = of_file.*topic;
    settings.*topic = in_file.empty() ? named.*topic : below(settings.camera_name, in_file);
  }
  return settings;
}

}  // namespace posefusion_ros
