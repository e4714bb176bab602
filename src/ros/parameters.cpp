// SPDX-License-Identifier: BSD-3-Clause
#include "posefusion_ros/parameters.hpp"

#include <algorithm>
#include <utility>

#include "posefusion/core/error.hpp"

namespace posefusion_ros {
namespace {

XmlRpc::XmlRpcValue privateTree(const ros::NodeHandle& handle) {
  XmlRpc::XmlRpcValue values;
  handle.getParam(handle.getNamespace(), values);
  return values;
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
    : values_(toYaml(std::move(values))), origin_(std::move(origin)) {
  if (!values_.IsMap()) values_ = YAML::Node(YAML::NodeType::Map);
}

void Parameters::fail(const std::string& name, const std::string& what) const {
  throw pf::InputError("parameter " + origin_ + "/" + name + " " + what);
}

template <typename Value>
void Parameters::note(const std::string& name, const Value& value) {
  effective_ << (effective_.tellp() > 0 ? " " : "") << name << "=" << value;
}

template <typename Value>
Value Parameters::read(const std::string& name, const Value& fallback,
                       const std::string& expected) {
  known_.insert(name);
  Value value = fallback;
  const YAML::Node& values = values_;
  if (const YAML::Node found = values[name]) {
    try {
      value = found.as<Value>();
    } catch (const YAML::Exception&) {
      std::ostringstream text;
      text << found;
      fail(name, "is '" + text.str() + "', expected " + expected);
    }
  }
  return value;
}

bool Parameters::flag(const std::string& name, bool fallback) {
  const bool value = read(name, fallback, "true or false");
  note(name, value ? "true" : "false");
  return value;
}

template <typename Value>
Value Parameters::within(const std::string& name, const Value& value, const Range& range) {
  if (!(value >= range.min && value <= range.max)) {  // not a number is out of range, too
    std::ostringstream what;
    what << "is " << value << ", expected " << range.min << " to " << range.max;
    fail(name, what.str());
  }
  note(name, value);
  return value;
}

int Parameters::integer(const std::string& name, int fallback, const Range& range) {
  return within(name, read(name, fallback, "a whole number"), range);
}

double Parameters::number(const std::string& name, double fallback, const Range& range) {
  return within(name, read(name, fallback, "a number"), range);
}

std::string Parameters::text(const std::string& name, const std::string& fallback) {
  const std::string value = read(name, fallback, "a text");
  note(name, "'" + value + "'");
  return value;
}

std::string Parameters::choice(const std::string& name, const std::string& fallback,
                               const std::vector<std::string>& words) {
  const std::string value = read(name, fallback, "a word");
  if (std::find(words.begin(), words.end(), value) == words.end()) {
    std::string list;
    for (const auto& word : words) list += (list.empty() ? "" : ", ") + word;
    fail(name, "is '" + value + "', expected one of " + list);
  }
  note(name, value);
  return value;
}

pf::Config Parameters::config(const std::vector<std::string>& groups) {
  pf::Config config;
  YAML::Node tree(YAML::NodeType::Map);
  for (const auto& entry : values_) {
    if (!entry.second.IsMap()) continue;
    tree[entry.first] = entry.second;
    known_.insert(entry.first.as<std::string>());
  }
  pf::applyYaml(config, tree, "parameters of " + origin_);
  const std::string mode = text("mode", "");
  if (!mode.empty()) pf::applyMode(config, mode);
  for (const auto& [key, value] : pf::listFields(config)) {
    const std::string group = key.substr(0, key.find('.'));
    if (std::find(groups.begin(), groups.end(), group) != groups.end()) note(key, value);
  }
  return config;
}

std::vector<std::string> Parameters::unknown() const {
  std::vector<std::string> names;
  for (const auto& entry : values_) {
    const auto name = entry.first.as<std::string>();
    if (known_.count(name) == 0) names.push_back(origin_ + "/" + name);
  }
  return names;
}

}  // namespace posefusion_ros
