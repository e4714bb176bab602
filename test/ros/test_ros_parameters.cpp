// SPDX-License-Identifier: BSD-3-Clause
#include "posefusion_ros/parameters.hpp"

#include <gtest/gtest.h>

#include "../temporary_folder.hpp"
#include "posefusion/core/error.hpp"

namespace posefusion_ros {
namespace {

using XmlRpc::XmlRpcValue;

using pf::errorOf;

XmlRpcValue someValues() {
  XmlRpcValue values;
  values["queue_size"] = 7;
  values["rate"] = 0.123456789012345;
  values["lossless"] = true;
  values["output"] = std::string("/tmp/a: b");
  values["blur"]["threshold"] = 5;
  values["blur"]["enabled"] = false;
  values["tracking"]["max_distance_m"] = 0.123456789012345;
  return values;
}

TEST(RosParameters, AreReadWithTheirTypes) {
  Parameters p(someValues(), "/gate");
  EXPECT_EQ(p.integer("queue_size", 1, {1, 10}), 7);
  EXPECT_EQ(p.number("rate", 1, {0, 1}), 0.123456789012345);
  EXPECT_TRUE(p.flag("lossless", false));
  EXPECT_EQ(p.text("output", ""), "/tmp/a: b");
  EXPECT_EQ(p.integer("other", 3, {1, 10}), 3);
}

TEST(RosParameters, ReachTheConfigurationWithAllTheirDigits) {
  Parameters p(someValues(), "/gate");
  const pf::Config config = p.config({"blur"});
  EXPECT_EQ(config.blur.threshold, 5.0);
  EXPECT_FALSE(config.blur.enabled);
  EXPECT_EQ(config.tracking.max_distance_m, 0.123456789012345);
  EXPECT_NE(p.effective().find("blur.threshold=5"), std::string::npos);
  EXPECT_EQ(p.effective().find("tracking"), std::string::npos);
}

TEST(RosParameters, TheFileIsReadFirst) {
  const pf::TemporaryFolder folder;
  XmlRpcValue values;
  values["config"] = folder.write("some.yaml", "blur: {threshold: 4, max_gap_s: 0.9}\n");
  values["blur"]["threshold"] = 5;
  const pf::Config config = Parameters(values, "/gate").config({"blur"});
  EXPECT_EQ(config.blur.threshold, 5.0);
  EXPECT_EQ(config.blur.max_gap_s, 0.9);
  values["config"] = folder.write("bad.yaml", "blurr: {}\n");
  EXPECT_NE(errorOf([&] { Parameters(values, "/gate").config({"blur"}); }).find("bad.yaml"),
            std::string::npos);
}

TEST(RosParameters, WhatIsNotTheDefaultIsListed) {
  Parameters p(someValues(), "/gate");
  p.config({"blur"});
  p.integer("queue_size", 7, {1, 10});
  p.flag("lossless", false);
  EXPECT_EQ(p.changed(),
            "settings besides the defaults: blur.enabled=false blur.threshold=5 lossless=true");
  EXPECT_EQ(Parameters(XmlRpcValue(), "/gate").changed(), "all settings are the defaults");
}

TEST(RosParameters, ModeHoldsOverTheGroups) {
  XmlRpcValue values = someValues();
  values["mode"] = std::string("pfh");
  EXPECT_TRUE(Parameters(values, "/gate").config({}).blur.enabled);
}

TEST(RosParameters, ErrorsNameParameterValueAndExpectation) {
  XmlRpcValue values;
  values["queue_size"] = std::string("many");
  values["window"] = 0;
  values["sync"] = std::string("maybe");
  Parameters p(values, "/gate");
  EXPECT_EQ(errorOf([&] {
              p.integer("queue_size", 1, {1, 10});
            }),
            "parameter /gate/queue_size is 'many', expected a whole number");
  EXPECT_EQ(errorOf([&] {
              p.integer("window", 1, {1, 10});
            }),
            "parameter /gate/window is 0, expected 1 to 10");
  EXPECT_EQ(errorOf([&] {
              p.choice("sync", "auto", {"auto", "yes", "no"});
            }),
            "parameter /gate/sync is 'maybe', expected one of auto, yes, no");
}

TEST(RosParameters, UnknownSettingsAreErrorsAndUnknownParametersAreListed) {
  XmlRpcValue values = someValues();
  values["blur"]["treshold"] = 1.0;
  EXPECT_NE(errorOf([&] {
              Parameters(values, "/gate").config({"blur"});
            }).find("parameters of /gate: blur.treshold is unknown, expected one of "),
            std::string::npos);
  XmlRpcValue group = someValues();
  group["blurr"]["threshold"] = 1.0;
  EXPECT_NE(errorOf([&] { Parameters(group, "/gate").config({"blur"}); }).find("blurr"),
            std::string::npos);
  XmlRpcValue own = someValues();
  own["queue_sice"] = 3;
  Parameters p(own, "/gate");
  p.config({});
  for (const char* name : {"queue_size", "rate", "lossless", "output"}) p.text(name, "");
  EXPECT_EQ(p.unknown(), std::vector<std::string>{"/gate/queue_sice"});
}

TEST(RosParameters, NoneAtAllAreTheDefaults) {
  Parameters p(XmlRpcValue(), "/gate");
  EXPECT_EQ(pf::listFields(p.config({})), pf::listFields(pf::Config{}));
  EXPECT_TRUE(p.unknown().empty());
}

}  // namespace
}  // namespace posefusion_ros
