// SPDX-License-Identifier: BSD-3-Clause
#include <gtest/gtest.h>
#include <yaml-cpp/yaml.h>

#include <fstream>
#include <sstream>

#include "posefusion/core/error.hpp"
#include "posefusion/slam/config.hpp"

namespace pf {
namespace {

std::string errorOf(const std::string& assignment) {
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
  EXPECT_EQ(errorOf("tracking.speed=1"), "setting: tracking.speed is no setting of posefusion");
  EXPECT_EQ(errorOf("trackin.max_distance_m=1"), "setting: trackin is no setting of posefusion");
  EXPECT_EQ(errorOf("tracking.max_distance_m=near"),
            "setting: tracking.max_distance_m is 'near', expected a number");
  EXPECT_EQ(errorOf("tracking.max_distance_m=-1"),
            "setting: tracking.max_distance_m is -1, expected 0.001 to 10");
  EXPECT_EQ(errorOf("tracking.max_distance_m=.nan"),
            "setting: tracking.max_distance_m is nan, expected 0.001 to 10");
  EXPECT_EQ(errorOf("pose.detector=guess"),
            "setting: pose.detector is 'guess', expected one of network, recorded, none");
  EXPECT_EQ(errorOf("speed"), "'speed': expected group.name=value");
}

TEST(Config, AFailedFileLeavesTheConfigurationAsItWas) {
  Config config;
  EXPECT_THROW(applyYaml(config, YAML::Load("{blur: {threshold: 5, nonsense: 1}}"), "x.yaml"),
               InputError);
  EXPECT_EQ(listFields(config), listFields(Config{}));
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
