// SPDX-License-Identifier: BSD-3-Clause
// The settings that dynamic_reconfigure shows and may set.
#include <gtest/gtest.h>

#include <set>

#include "../temporary_folder.hpp"
#include "posefusion/config/field_text.hpp"
#include "posefusion_ros/running_settings.hpp"
#include "posefusion_ros/settings_messages.hpp"

namespace posefusion_ros {
namespace {

using dynamic_reconfigure::Config;
using pf::errorOf;

template <typename Settings>
VisitSettings visitOf(Settings& settings) {
  return [&settings](pf::FieldVisitor& visitor) { visitFields(settings, visitor); };
}

template <typename Values, typename Value>
void put(Values& values, const std::string& name, const Value& value) {
  values.emplace_back();
  values.back().name = name;
  values.back().value = value;
}

template <typename Settings>
std::string refusal(const Config& request) {
  Settings settings;
  return errorOf([&] { readValues(request, visitOf(settings)); });
}

template <typename Settings>
std::set<std::string> described() {
  Settings settings;
  std::set<std::string> names;
  for (const auto& group : describe(visitOf(settings)).groups) {
    for (const auto& parameter : group.parameters) names.insert(parameter.name);
  }
  return names;
}

TEST(RosSettings, AreThoseOfTheListThatMayChange) {
  EXPECT_EQ(described<DetectorSettings>(),
            (std::set<std::string>{"pose/every_nth_frame", "pose/min_peak", "pose/min_person_score",
                                   "pose/min_person_joints", "pose/max_people"}));
  const auto fusion = described<FusionSettings>();
  EXPECT_EQ(fusion.count("tracking/lost_after_s"), 1U);
  EXPECT_EQ(fusion.count("surfels_period_s"), 1U);
  FusionSettings settings;
  pf::FieldLister lister;
  visitFields(settings, lister);
  EXPECT_EQ(fusion.size(), lister.fields.size()) << "none of them is read at the start alone";
}

TEST(RosSettings, AreDescribedWithLimitsGroupsAndWords) {
  SegmenterSettings settings;
  settings.segmentation.margin_px = 7;
  const auto description = describe(visitOf(settings));
  ASSERT_EQ(description.groups.size(), 2U);
  EXPECT_EQ(description.groups[1].name, "segmentation");
  EXPECT_EQ(description.groups[1].parent, 0);
  EXPECT_TRUE(description.groups[0].parameters.empty());
  for (const auto& parameter : description.groups[1].parameters) {
    EXPECT_FALSE(parameter.description.empty()) << parameter.name;
    if (parameter.name == "segmentation/energy") {
      EXPECT_NE(parameter.edit_method.find("'value': 'paper'"), std::string::npos);
    }
  }
  for (std::size_t i = 0; i < description.dflt.ints.size(); ++i) {
    EXPECT_EQ(description.min.ints[i].name, description.dflt.ints[i].name);
    EXPECT_EQ(description.max.ints[i].name, description.dflt.ints[i].name);
    if (description.dflt.ints[i].name != "segmentation/margin_px") continue;
    EXPECT_EQ(description.dflt.ints[i].value, 7);
    EXPECT_EQ(description.max.ints[i].value, 50);
  }
}

TEST(RosSettings, ValuesComeBackAsTheyAreSent) {
  FusionSettings some;
  some.tracking.max_distance_m = 0.123456789012345;
  some.tracking.rotation_prealignment = false;
  some.tracking.max_iterations = 3;
  some.publishing.surfels_max_points = 17;
  FusionSettings other;
  readValues(valuesOf(visitOf(some)), visitOf(other));
  pf::FieldLister sent, read;
  visitFields(some, sent);
  visitFields(other, read);
  EXPECT_EQ(sent.fields, read.fields);
}

TEST(RosSettings, OneAloneIsSetAndAnIntegerIsTakenForANumber) {
  Config request;
  put(request.ints, "tracking/max_distance_m", 2);
  FusionSettings settings;
  readValues(request, visitOf(settings));
  EXPECT_EQ(settings.tracking.max_distance_m, 2.0);
  EXPECT_EQ(settings.tracking.max_iterations, FusionSettings().tracking.max_iterations);
}

TEST(RosSettings, RefusalsNameSettingValueAndWhatWasExpected) {
  Config outside, unknown, fixed, type, word;
  put(outside.doubles, "tracking/max_distance_m", 11.0);
  EXPECT_EQ(refusal<FusionSettings>(outside),
            "tracking/max_distance_m is 11, expected 0.001 to 10");
  outside.doubles[0].value = std::nan("");
  EXPECT_NE(refusal<FusionSettings>(outside), "");
  put(unknown.ints, "tracking/max_distnce_m", 1);
  EXPECT_EQ(refusal<FusionSettings>(unknown),
            "there is no setting tracking/max_distnce_m that may change while this runs");
  put(fixed.ints, "segmentation/grid_width", 100);
  EXPECT_NE(refusal<SegmenterSettings>(fixed).find("grid_width is read at the start alone"),
            std::string::npos);
  put(type.strs, "blur/enabled", std::string("perhaps"));
  EXPECT_EQ(refusal<GateSettings>(type), "blur/enabled is 'perhaps', expected true or false");
  put(word.strs, "segmentation/energy", std::string("best"));
  EXPECT_EQ(refusal<SegmenterSettings>(word),
            "segmentation/energy is 'best', expected one of improved, paper");
}

}  // namespace
}  // namespace posefusion_ros
