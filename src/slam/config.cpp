// SPDX-License-Identifier: BSD-3-Clause
#include "posefusion/slam/config.hpp"

#include <yaml-cpp/yaml.h>

#include "posefusion/config/field_path.hpp"
#include "posefusion/core/error.hpp"

namespace pf {
namespace {

/// Lists key and value of each field.
class Lister : public PathVisitor {
 public:
  void flag(const char* name, bool& value, const char*) override {
    add(name, value ? "true" : "false");
  }
  void number(const char* name, double& value, double, double, const char*) override {
    add(name, numberText(value));
  }
  void integer(const char* name, int& value, int, int, const char*) override {
    add(name, std::to_string(value));
  }
  void text(const char* name, std::string& value, const char*) override { add(name, value); }
  void choice(const char* name, std::string& value, const std::vector<std::string>&,
              const char*) override {
    add(name, value);
  }
  std::vector<std::pair<std::string, std::string>> fields;

 private:
  void add(const char* name, const std::string& value) { fields.emplace_back(key(name), value); }
};

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
  visitGroup("frame", config.frame, visitor);
  visitGroup("tracking", config.tracking, visitor);
  visitGroup("map", config.map, visitor);
}

void applyFile(Config& config, const std::string& path) {
  YAML::Node node;
  try {
    node = YAML::LoadFile(path);
  } catch (const YAML::BadFile&) {
    throw InputError(path + ": the configuration file cannot be opened");
  } catch (const YAML::Exception& error) {
    throw InputError(path + ": not YAML: " + error.what());
  }
  applyYaml(config, node, path);
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
  if (mode == "elastic") config.pose.detector = "none";
}

std::vector<std::pair<std::string, std::string>> listFields(const Config& config) {
  Config copy = config;
  Lister lister;
  visitFields(copy, lister);
  return lister.fields;
}

}  // namespace pf
