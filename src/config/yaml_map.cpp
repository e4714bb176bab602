// SPDX-License-Identifier: BSD-3-Clause
#include "posefusion/config/yaml_map.hpp"

#include <algorithm>
#include <cmath>

#include "posefusion/config/field_text.hpp"
#include "posefusion/core/error.hpp"

namespace pf {
namespace {

std::string shortText(const YAML::Node& node) {
  YAML::Emitter out;
  out << YAML::Flow << node;
  std::string text = out.c_str();
  return text.size() > 60 ? text.substr(0, 57) + "..." : text;
}

template <typename Words>
std::string joined(const Words& words) {
  std::string text;
  for (const auto& word : words) text += (text.empty() ? "" : ", ") + word;
  return text;
}

/// "scene.yaml: camera." without what only joins it to a key.
std::string nameOf(const std::string& prefix) {
  return prefix.substr(0, prefix.find_last_not_of(".:/ ") + 1);
}

/// Also what holds itself through an alias, which has no end.
void refuseTwins(const YAML::Node& node, const std::string& origin, int depth = 0) {
  constexpr int kDeepest = 64;  // far more maps within maps than any file of ours has
  if (depth > kDeepest) throw InputError(origin + ": is nested without end");
  std::set<std::string> keys;
  for (const auto& entry : node) {
    if (node.IsSequence()) {
      refuseTwins(entry, origin, depth + 1);
      continue;
    }
    const auto key = entry.first.as<std::string>("");
    if (!keys.insert(key).second) throw InputError(origin + ": " + key + " is given twice");
    refuseTwins(entry.second, origin, depth + 1);
  }
}

}  // namespace

YAML::Node parseYaml(const std::string& text, const std::string& origin) {
  YAML::Node node;
  try {
    node = YAML::Load(text);
  } catch (const YAML::Exception& error) {
    throw InputError(origin + ": is not YAML: " + error.what());
  }
  refuseTwins(node, origin);
  return node;
}

YamlMap::YamlMap(const YAML::Node& node, std::string prefix)
    : node_(!node.IsDefined() || node.IsNull() ? YAML::Node(YAML::NodeType::Map) : node),
      prefix_(std::move(prefix)) {
  if (!node_.IsMap()) {
    throw InputError(nameOf(prefix_) + " is '" + shortText(node_) + "', expected keys with values");
  }
}

void YamlMap::fail(const std::string& key, const std::string& what) const {
  throw InputError(prefix_ + key + " " + what);
}

bool YamlMap::has(const std::string& key) const {
  const YAML::Node& node = node_;
  return static_cast<bool>(node[key]);
}

YAML::Node YamlMap::get(const std::string& key) {
  used_.insert(key);
  const YAML::Node& node = node_;
  return node[key];
}

double YamlMap::number(const std::string& key, double otherwise, double min, double max) {
  const YAML::Node node = get(key);
  if (!node) return otherwise;
  double value = 0.0;
  try {
    value = node.as<double>();
  } catch (const YAML::Exception&) {
    fail(key, "is '" + shortText(node) + "', expected a number");
  }
  if (!(value >= min && value <= max)) {
    fail(key,
         "is " + numberText(value) + ", expected " + numberText(min) + " to " + numberText(max));
  }
  return value;
}

int YamlMap::integer(const std::string& key, int otherwise, int min, int max) {
  const YAML::Node node = get(key);
  double value = 0.0;
  const bool is_number = !node || YAML::convert<double>::decode(node, value);
  if (!is_number || (std::isfinite(value) && value != std::floor(value))) {
    const std::string text = shortText(node);
    fail(key, "is " + (is_number ? text : "'" + text + "'") + ", expected a whole number");
  }
  return static_cast<int>(number(key, otherwise, min, max));
}

bool YamlMap::flag(const std::string& key, bool otherwise) {
  const YAML::Node node = get(key);
  if (!node) return otherwise;
  try {
    return node.as<bool>();
  } catch (const YAML::Exception&) {
    fail(key, "is '" + shortText(node) + "', expected true or false");
  }
}

std::string YamlMap::text(const std::string& key, const std::string& otherwise) {
  const YAML::Node node = get(key);
  if (!node) return otherwise;
  if (node.IsNull()) return "";
  if (!node.IsScalar()) fail(key, "is '" + shortText(node) + "', expected a text");
  return node.Scalar();
}

std::string YamlMap::word(const std::string& key, const std::string& otherwise,
                          const std::vector<std::string>& words) {
  const std::string value = text(key, otherwise);
  if (std::find(words.begin(), words.end(), value) != words.end()) return value;
  fail(key, "is '" + value + "', expected one of " + joined(words));
}

double YamlMap::angle(const std::string& key, double otherwise_rad) {
  return number(key, otherwise_rad * 180.0 / M_PI, -1e4, 1e4) * M_PI / 180.0;
}

std::vector<double> YamlMap::numbers(const std::string& key, std::size_t count) {
  const YAML::Node node = get(key);
  std::vector<double> values;
  try {
    values = node.as<std::vector<double>>();
  } catch (const YAML::Exception&) {
  }
  const bool finite =
      std::all_of(values.begin(), values.end(), [](double v) { return std::abs(v) < 1e4; });
  if (values.size() != count || !finite) {
    fail(key,
         "is '" + shortText(node) + "', expected a list of " + std::to_string(count) + " numbers");
  }
  return values;
}

Eigen::Vector2d YamlMap::vector2(const std::string& key, const Eigen::Vector2d& otherwise) {
  if (!get(key)) return otherwise;
  const auto v = numbers(key, 2);
  return {v[0], v[1]};
}

Eigen::Vector3d YamlMap::vector3(const std::string& key, const Eigen::Vector3d& otherwise) {
  return maybeVector3(key).value_or(otherwise);
}

std::optional<Eigen::Vector3d> YamlMap::maybeVector3(const std::string& key) {
  if (!get(key)) return std::nullopt;
  const auto v = numbers(key, 3);
  return Eigen::Vector3d(v[0], v[1], v[2]);
}

std::optional<Eigen::Vector3d> YamlMap::placeOf(const std::string& key) {
  const YAML::Node node = get(key);
  if (!node) return std::nullopt;
  const auto v = numbers(key, node.IsSequence() && node.size() == 3 ? 3 : 2);
  return Eigen::Vector3d(v[0], v[1], v.size() == 3 ? v[2] : std::nan(""));
}

std::vector<Eigen::Vector3d> YamlMap::places(const std::string& key) {
  const YAML::Node node = get(key);
  std::vector<Eigen::Vector3d> places;
  if (!node) return places;
  try {
    for (const auto& v : node.as<std::vector<std::vector<double>>>()) {
      if (v.size() < 2 || v.size() > 3) throw YAML::Exception(YAML::Mark(), "");
      places.emplace_back(v[0], v[1], v.size() == 3 ? v[2] : std::nan(""));
    }
  } catch (const YAML::Exception&) {
    fail(key, "is '" + shortText(node) + "', expected a list of [x, y] or [x, y, z]");
  }
  return places;
}

YamlMap YamlMap::map(const std::string& key) {
  const YAML::Node node = get(key);
  return YamlMap(node ? node : YAML::Node(YAML::NodeType::Map), prefix_ + key + ".");
}

std::vector<YamlMap> YamlMap::maps(const std::string& key) {
  const YAML::Node node = get(key);
  std::vector<YamlMap> maps;
  if (!node) return maps;
  if (!node.IsSequence()) fail(key, "is '" + shortText(node) + "', expected a list");
  for (std::size_t i = 0; i < node.size(); ++i) {
    maps.emplace_back(node[i], prefix_ + key + "[" + std::to_string(i) + "].");
  }
  return maps;
}

std::vector<std::string> YamlMap::unread() const {
  std::vector<std::string> keys;
  for (const auto& entry : node_) {
    const auto key = entry.first.as<std::string>();
    if (used_.count(key) == 0) keys.push_back(key);
  }
  return keys;
}

void YamlMap::finish() const {
  const auto keys = unread();
  if (!keys.empty()) fail(keys.front(), "is unknown, expected one of " + joined(used_));
}

}  // namespace pf
