// SPDX-License-Identifier: BSD-3-Clause
#include "posefusion_ros/input_settings.hpp"

#include <gtest/gtest.h>

#include <filesystem>
#include <map>

#include "../temporary_folder.hpp"
#include "posefusion_ros/names.hpp"

namespace posefusion_ros {
namespace {

constexpr char kCameras[] = "config/cameras";

Parameters parametersOf(const std::map<std::string, std::string>& texts) {
  XmlRpc::XmlRpcValue values;
  for (const auto& [name, text] : texts) values[name] = text;
  return Parameters(values, "/gate");
}

TEST(InputSettings, EachFileOfOursLoadsAndNamesWhatItHasToName) {
  std::map<std::string, InputSettings> cameras;
  for (const auto& entry : std::filesystem::directory_iterator(kCameras)) {
    const std::string name = entry.path().stem();
    ASSERT_EQ(entry.path().extension(), ".yaml");
    const CameraSettings camera = loadCameraSettings(entry.path());
    cameras[name] = camera.input;
    for (const auto& topic :
         {camera.input.color_topic, camera.input.depth_topic, camera.input.camera_info_topic}) {
      EXPECT_FALSE(topic.empty()) << name;
    }
    pf::Config config;
    pf::applyYaml(config, camera.settings, name);
    EXPECT_LT(config.frame.min_depth_m, config.frame.max_depth_m) << name;
    auto parameters = parametersOf({{"camera_settings", entry.path()}});
    const InputSettings input = readInput(parameters);
    EXPECT_EQ(input.color_topic.front(), '/') << name;
    EXPECT_TRUE(parameters.unknown().empty()) << name;
  }
  for (const char* name :
       {"topics", "openni2", "xtion", "realsense_d4xx", "kinect_v2", "azure_kinect"}) {
    EXPECT_EQ(cameras.count(name), 1U) << name;
  }
  EXPECT_EQ(cameras.size(), 6U) << "a new one is to be named here and in docs/ros-api.md";
}

TEST(InputSettings, TopicsAreBelowTheNamespaceOfTheCamera) {
  const auto colorOf = [](const std::map<std::string, std::string>& texts) {
    auto parameters = parametersOf(texts);
    return readInput(parameters).color_topic;
  };
  const std::string realsense = std::string(kCameras) + "/realsense_d4xx.yaml";
  const std::string azure = std::string(kCameras) + "/azure_kinect.yaml";
  EXPECT_EQ(colorOf({}), topics::kColor);
  EXPECT_EQ(colorOf({{"camera_settings", realsense}}), "/camera/color/image_raw");
  EXPECT_EQ(colorOf({{"camera_settings", realsense}, {"camera_name", "eye"}}),
            "/eye/color/image_raw");
  EXPECT_EQ(colorOf({{"camera_settings", azure}}), "/rgb/image_raw");
  EXPECT_EQ(colorOf({{"camera_settings", azure}, {"camera_name", "/head/k4a"}}),
            "/head/k4a/rgb/image_raw");
  EXPECT_EQ(colorOf({{"camera_settings", realsense}, {"color_topic", "mine"}}), "mine");
  EXPECT_EQ(colorOf({{"camera_settings", realsense}, {"color_topic", ""}}),
            "/camera/color/image_raw");
}

TEST(InputSettings, ParametersHoldOverTheFileAndTheFileOverTheDefaults) {
  pf::TemporaryFolder folder;
  XmlRpc::XmlRpcValue values;
  values["camera_settings"] = folder.write(
      "c.yaml",
      "input: {depth_stamp_offset_s: -0.02, depth_unit_m: 0.0001, max_interval_s: 0.5}\n"
      "settings: {frame: {max_depth_m: 3.5}}\n");
  values["depth_unit_m"] = 0.002;
  Parameters parameters(values, "/gate");
  const InputSettings input = readInput(parameters);
  EXPECT_EQ(input.depth_stamp_offset_s, -0.02);
  EXPECT_EQ(input.depth_unit_m, 0.002);
  EXPECT_EQ(input.pairing.max_interval_s, 0.5);
  EXPECT_EQ(input.color_topic, topics::kColor);
  EXPECT_EQ(parameters.config({"frame"}).frame.max_depth_m, 3.5);
  values["frame"]["max_depth_m"] = 4.5;
  EXPECT_EQ(Parameters(values, "/gate").config({"frame"}).frame.max_depth_m, 4.5);
}

TEST(InputSettings, DepthIsTransportedAsColourByDefault) {
  InputSettings input;
  EXPECT_EQ(input.depthTransport(), "raw");
  input.image_transport = "compressed";
  EXPECT_EQ(input.depthTransport(), "compressedDepth");
  input.depth_image_transport = "raw";
  EXPECT_EQ(input.depthTransport(), "raw");
}

TEST(InputSettings, ErrorsNameFileKeyValueAndExpectation) {
  pf::TemporaryFolder folder;
  const auto error = [&](const std::string& text) {
    const std::string file = folder.write("c.yaml", text);
    return pf::errorOf([&] { loadCameraSettings(file); });
  };
  const auto has = [](const std::string& text, const std::string& part) {
    return text.find(part) != std::string::npos;
  };
  EXPECT_TRUE(has(error("input: {colour_topic: x}"), "c.yaml: input.colour_topic"));
  EXPECT_TRUE(has(error("inputs: {}"), "inputs"));
  EXPECT_TRUE(has(error("settings: {frame: {max_depth: 3}}"), "frame.max_depth"));
  const std::string theora = error("input: {image_transport: theora}");
  EXPECT_TRUE(has(theora, "'theora'") && has(theora, "raw, compressed")) << theora;
  EXPECT_TRUE(has(error("input: {depth_stamp_offset_s: 33}"), "depth_stamp_offset_s"));
  EXPECT_TRUE(has(pf::errorOf([] { loadCameraSettings("/nowhere.yaml"); }), "/nowhere.yaml"));
}

}  // namespace
}  // namespace posefusion_ros
