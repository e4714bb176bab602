// SPDX-License-Identifier: BSD-3-Clause
#include "posefusion_ros/parameters.hpp"

#include <algorithm>
#include <utility>

#include "posefusion_ros/input_settings.hpp"

namespace posefusion_ros {
namespace {

XmlRpc::XmlRpcValue privateTree(const ros::NodeHandle& handle) {
  XmlRpc::XmlRpcValue values;
  handle.getParam(handle.getNamespace(), values);
  return values;
}

YAML::Node mapOf(XmlRpc::XmlRpcValue values) {
  const YAML::Node tree = toYaml(std::move(values));
  return tree.IsMap() ? tree : YAML::Node(YAML::NodeType::Map);
}

}  // namespace

YAML::Node toYaml(XmlRpc::XmlRpcValue value) {
  using XmlRpc::XmlRpcValue;
  YAML::Node node;
  switch (value.getType()) {
    case XmlRpcValue::TypeBoolean:
      node = static_cast<bool>(value);
      break;
    case XmlRpcValue::TypeInt:
      node = static_cast<int>(value);
      break;
    case XmlRpcValue::TypeDouble:
      node = static_cast<double>(value);
      break;
    case XmlRpcValue::TypeString:
      node = static_cast<std::string>(value);
      break;
    case XmlRpcValue::TypeArray:
      node = YAML::Node(YAML::NodeType::Sequence);
      for (int i = 0; i < value.size(); ++i) node.push_back(toYaml(value[i]));
      break;
    case XmlRpcValue::TypeStruct:
      node = YAML::Node(YAML::NodeType::Map);
      for (auto& entry : value) node[entry.first] = toYaml(entry.second);
      break;
    default:
      break;
  }
  return node;
}

Parameters::Parameters(const ros::NodeHandle& private_handle)
    : Parameters(privateTree(private_handle), private_handle.getNamespace()) {}

Parameters::Parameters(XmlRpc::XmlRpcValue values, std::string origin)
    : tree_(mapOf(std::move(values))),
      origin_(std::move(origin)),
      values_(tree_, "parameter " + origin_ + "/") {}

template <typename Value>
Value Parameters::note(const std::string& name, const Value& value, const Value& fallback) {
  effective_ << (effective_.tellp() > 0 ? " " : "") << name << "=" << value;
  if (value != fallback) changed_ << " " << name << "=" << value;
  return value;
}

std::string Parameters::changed() const {
  const std::string list = changed_.str();
  return list.empty() ? "all settings are the defaults" : "settings besides the defaults:" + list;
}

bool Parameters::flag(const std::string& name, bool fallback) {
  const bool value = values_.flag(name, fallback);
  const auto word = [](bool is_true) { return std::string(is_true ? "true" : "false"); };
  note(name, word(value), word(fallback));
  return value;
}

int Parameters::integer(const std::string& name, int fallback, const Range& range) {
  return note(
      name,
      values_.integer(name, fallback, static_cast<int>(range.min), static_cast<int>(range.max)),
      fallback);
}

double Parameters::number(const std::string& name, double fallback, const Range& range) {
  return note(name, values_.number(name, fallback, range.min, range.max), fallback);
}

std::string Parameters::text(const std::string& name, const std::string& fallback) {
  const std::string value = values_.text(name, fallback);
  note(name, "'" + value + "'", "'" + fallback + "'");
  return value;
}

std::string Parameters::choice(const std::string& name, const std::string& fallback,
                               const std::vector<std::string>& words) {
  return note(name, values_.word(name, fallback, words), fallback);
}

pf::Config Parameters::config(const std::vector<std::string>& groups) {
  pf::Config config;
  const auto defaults = pf::listFields(config);
  const std::string file = text("config", "");
  if (!file.empty()) pf::applyFile(config, file);
  const std::string camera = values_.text("camera_settings", "");  // noted with the input
  if (!camera.empty()) {
    const YAML::Node settings = loadCameraSettings(camera).settings;
    if (settings) pf::applyYaml(config, settings, camera + ": settings");
  }
  YAML::Node tree(YAML::NodeType::Map);
  for (const auto& entry : tree_) {
    if (!entry.second.IsMap()) continue;
    tree[entry.first] = entry.second;
    values_.map(entry.first.as<std::string>());  // is asked for
  }
  pf::applyYaml(config, tree, "parameters of " + origin_);
  const std::string mode = text("mode", "");
  if (!mode.empty()) pf::applyMode(config, mode);
  const auto fields = pf::listFields(config);
  for (std::size_t i = 0; i < fields.size(); ++i) {
    const auto& [key, value] = fields[i];
    const std::string group = key.substr(0, key.find('.'));
    if (std::find(groups.begin(), groups.end(), group) != groups.end()) {
      note(key, value, defaults[i].second);
    }
  }
  return config;
}

std::vector<std::string> Parameters::unknown() const {
  std::vector<std::string> names = values_.unread();
  for (const char* known : {kEndOnError, kDiagnosticPeriod}) {
    names.erase(std::remove(names.begin(), names.end(), known), names.end());
  }
  for (auto& name : names) name.insert(0, origin_ + "/");
  return names;
}

}  // namespace posefusion_ros
