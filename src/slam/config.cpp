// SPDX-License-Identifier: BSD-3-Clause
#include "posefusion/slam/config.hpp"

#include <fstream>
#include <iterator>

#include "posefusion/config/field_text.hpp"
#include "posefusion/config/yaml_map.hpp"
#include "posefusion/core/error.hpp"

namespace pf {
namespace {

template <typename Group>
void visitGroup(const char* name, Group& group, FieldVisitor& visitor) {
  visitor.enter(name);
  visitFields(group, visitor);
  visitor.leave();
}

}  // namespace

void visitFields(Config& config, FieldVisitor& visitor) {
  visitGroup("blur", config.blur, visitor);
  visitGroup("pose", config.pose, visitor);
  visitGroup("segmentation", config.segmentation, visitor);
  visitGroup("sensor", config.sensor, visitor);
  visitGroup("frame", config.frame, visitor);
  visitGroup("tracking", config.tracking, visitor);
  visitGroup("robot", config.robot, visitor);
  visitGroup("map", config.map, visitor);
  visitGroup("loop", config.loop, visitor);
  visitGroup("graph", config.graph, visitor);
  visitGroup("calibration", config.calibration, visitor);
}

void applyYaml(Config& config, const YAML::Node& node, const std::string& origin) {
  Config changed = config;
  YamlFields fields(YamlMap(node, origin + ": "));
  visitFields(changed, fields);
  fields.finish();
  config = changed;
}

void applyFile(Config& config, const std::string& path) {
  std::ifstream in(path);
  if (!in) throw InputError(path + ": the configuration file cannot be opened");
  const std::string text(std::istreambuf_iterator<char>(in), {});
  applyYaml(config, parseYaml(text, path), path);
}

void applyAssignment(Config& config, const std::string& assignment) {
  const auto equals = assignment.find('=');
  const auto dot = assignment.find('.');
  if (equals == std::string::npos || dot == std::string::npos || dot > equals) {
    throw InputError("'" + assignment + "': expected group.name=value");
  }
  YAML::Node value;
  try {
    value = YAML::Load(assignment.substr(equals + 1));
  } catch (const YAML::Exception&) {
    value = assignment.substr(equals + 1);
  }
  if (value.IsNull()) value = "";
  YAML::Node node;
  node[assignment.substr(0, dot)][assignment.substr(dot + 1, equals - dot - 1)] = value;
  applyYaml(config, node, "setting");
}

void applyMode(Config& config, const std::string& mode) {
  if (mode != "elastic" && mode != "posefusion" && mode != "pfh") {
    throw InputError("mode is '" + mode + "', expected one of elastic, posefusion, pfh");
  }
  config.blur.enabled = mode == "pfh";
  config.segmentation.enabled = mode != "elastic";
  config.loop.static_view_rule = mode == "pfh";
  if (mode == "elastic") config.pose.detector = "none";
}

std::string toYaml(const Config& config) {
  Config copy = config;
  YamlWriter writer;
  visitFields(copy, writer);
  return writer.result();
}

std::vector<std::pair<std::string, std::string>> listFields(const Config& config) {
  Config copy = config;
  FieldLister lister;
  visitFields(copy, lister);
  return lister.fields;
}

}  // namespace pf
