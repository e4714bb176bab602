// SPDX-License-Identifier: BSD-3-Clause
#include <gtest/gtest.h>
#include <yaml-cpp/yaml.h>

#include <fstream>
#include <sstream>

#include "posefusion/core/error.hpp"
#include "posefusion/slam/config.hpp"
#include "temporary_folder.hpp"

namespace pf {
namespace {

std::string assignmentError(const std::string& assignment) {
  Config config;
  try {
    applyAssignment(config, assignment);
  } catch (const InputError& error) {
    return error.what();
  }
  return "";
}

TEST(Config, ShippedFileRestatesTheDefaults) {
  std::ifstream file("config/posefusion.yaml");
  ASSERT_TRUE(file.good()) << "run from the root of the repository";
  std::stringstream text;
  text << file.rdbuf();
  EXPECT_EQ(text.str(), toYaml(Config{})) << "write it anew: posefusion_run --print-config";
}

TEST(Config, TextFormReadsBackAsTheSame) {
  Config config, read;
  config.tracking.max_distance_m = 0.123456789;
  config.pose.model = "a: b.pb";
  applyYaml(read, YAML::Load(toYaml(config)), "test");
  EXPECT_EQ(listFields(read), listFields(config));
}

TEST(Config, AssignmentSetsOneField) {
  Config config;
  applyAssignment(config, "tracking.max_distance_m=0.25");
  applyAssignment(config, "blur.enabled=false");
  applyAssignment(config, "pose.model=");
  EXPECT_EQ(config.tracking.max_distance_m, 0.25);
  EXPECT_FALSE(config.blur.enabled);
  EXPECT_EQ(config.pose.model, "");
}

TEST(Config, ErrorsNameTheKeyTheValueAndWhatWasExpected) {
  EXPECT_EQ(assignmentError("tracking.speed=1")
                .rfind("setting: tracking.speed is unknown, expected one of ", 0),
            0U);
  EXPECT_NE(assignmentError("tracking.speed=1").find("max_distance_m"), std::string::npos);
  EXPECT_EQ(assignmentError("trackin.max_distance_m=1"),
            "setting: trackin is unknown, expected one of blur, calibration, frame, graph, loop, "
            "map, pose, robot, "
            "segmentation, sensor, tracking");
  EXPECT_EQ(assignmentError("tracking.max_distance_m=near"),
            "setting: tracking.max_distance_m is 'near', expected a number");
  EXPECT_EQ(assignmentError("tracking.max_distance_m=-1"),
            "setting: tracking.max_distance_m is -1, expected 0.001 to 10");
  EXPECT_EQ(assignmentError("tracking.max_distance_m=.nan"),
            "setting: tracking.max_distance_m is nan, expected 0.001 to 10");
  EXPECT_EQ(assignmentError("pose.detector=guess"),
            "setting: pose.detector is 'guess', expected one of auto, embedded, network, "
            "network+embedded, recorded, none");
  EXPECT_EQ(assignmentError("speed"), "'speed': expected group.name=value");
}

TEST(Config, AFailedFileLeavesTheConfigurationAsItWas) {
  Config config;
  EXPECT_THROW(applyYaml(config, YAML::Load("{blur: {threshold: 5, nonsense: 1}}"), "x.yaml"),
               InputError);
  EXPECT_EQ(listFields(config), listFields(Config{}));
}

TEST(Config, FilesAreCheckedAsWholes) {
  const TemporaryFolder folder;
  Config config;
  const auto error = [&](const std::string& text) {
    return errorOf([&] { applyFile(config, folder.write("x.yaml", text)); });
  };
  EXPECT_EQ(error("blur: {threshold: 5}\npose:\n"), "") << "a group without a value is empty";
  EXPECT_EQ(config.blur.threshold, 5.0);
  EXPECT_NE(error("blur: {threshold: 6, threshold: 7}").find("x.yaml: threshold is given twice"),
            std::string::npos);
  EXPECT_NE(error("blur: &a {threshold: *a}").find("x.yaml: is nested without end"),
            std::string::npos)
      << "it overflowed the stack";
  EXPECT_NE(error("blur: 3").find("x.yaml: blur is '3', expected keys with values"),
            std::string::npos);
  EXPECT_NE(error("blur: [").find("x.yaml: is not YAML"), std::string::npos);
  EXPECT_EQ(config.blur.threshold, 5.0);
}

TEST(Config, ModesDifferByConfigurationAlone) {
  Config elastic, pfh;
  applyMode(elastic, "elastic");
  applyMode(pfh, "pfh");
  EXPECT_FALSE(elastic.blur.enabled);
  EXPECT_FALSE(elastic.segmentation.enabled);
  EXPECT_TRUE(pfh.blur.enabled);
  EXPECT_TRUE(pfh.segmentation.enabled);
  EXPECT_THROW(applyMode(pfh, "fast"), InputError);
}

}  // namespace
}  // namespace pf
