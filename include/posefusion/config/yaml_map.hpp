// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <yaml-cpp/yaml.h>

#include <Eigen/Core>
#include <optional>
#include <set>
#include <string>
#include <vector>

#include "posefusion/config/fields.hpp"

namespace pf {

/// YAML in a text. Throws InputError naming `origin` for what is no YAML, and for a key that is
/// given twice in one map (one of its values would be lost without a word).
YAML::Node parseYaml(const std::string& text, const std::string& origin);

/// A map of keys and values that is read key by key: the one checker of settings, scene files and
/// parameters. Each reader takes what holds where the key is missing. All errors are InputError:
/// `prefix` (the file or namespace, and the maps above), key, value, and what was expected.
class YamlMap {
 public:
  /// `prefix` stands directly before the key in messages: "scene.yaml: camera.". Throws for a node
  /// that is no map; one without a value is an empty map.
  YamlMap(const YAML::Node& node, std::string prefix);

  bool has(const std::string& key) const;
  double number(const std::string& key, double otherwise, double min, double max);
  int integer(const std::string& key, int otherwise, int min, int max);
  bool flag(const std::string& key, bool otherwise);
  std::string text(const std::string& key, const std::string& otherwise);
  std::string word(const std::string& key, const std::string& otherwise,
                   const std::vector<std::string>& words);
  double angle(const std::string& key, double otherwise_rad);  ///< degrees in the file
  /// Exactly so many numbers; throws where the key is missing.
  std::vector<double> numbers(const std::string& key, std::size_t count);
  Eigen::Vector2d vector2(const std::string& key, const Eigen::Vector2d& otherwise);
  Eigen::Vector3d vector3(const std::string& key, const Eigen::Vector3d& otherwise);
  std::optional<Eigen::Vector3d> maybeVector3(const std::string& key);
  /// Two or three numbers; z is NaN where only two are given.
  std::optional<Eigen::Vector3d> placeOf(const std::string& key);
  /// A list of those.
  std::vector<Eigen::Vector3d> places(const std::string& key);
  YamlMap map(const std::string& key);  ///< a missing one is empty
  std::vector<YamlMap> maps(const std::string& key);

  /// Keys that were never read.
  std::vector<std::string> unread() const;
  /// Throws where there are any.
  void finish() const;
  [[noreturn]] void fail(const std::string& key, const std::string& what) const;

 private:
  YAML::Node get(const std::string& key);
  YAML::Node node_;
  std::string prefix_;
  std::set<std::string> used_;
};

/// Reads the settings that a visitFields() lists out of a map; groups are maps within it. What the
/// map does not name stays as it is.
class YamlFields : public FieldVisitor {
 public:
  explicit YamlFields(YamlMap map) : open_{std::move(map)} {}

  void enter(const std::string& group) override { open_.push_back(open_.back().map(group)); }
  void leave() override {
    open_.back().finish();
    open_.pop_back();
  }
  void flag(const char* name, bool& value, const char*) override {
    value = open_.back().flag(name, value);
  }
  void number(const char* name, double& value, double min, double max, const char*) override {
    value = open_.back().number(name, value, min, max);
  }
  void integer(const char* name, int& value, int min, int max, const char*) override {
    value = open_.back().integer(name, value, min, max);
  }
  void text(const char* name, std::string& value, const char*) override {
    value = open_.back().text(name, value);
  }
  void choice(const char* name, std::string& value, const std::vector<std::string>& words,
              const char*) override {
    value = open_.back().word(name, value, words);
  }

  /// Throws for keys that no field has.
  void finish() const { open_.front().finish(); }

 private:
  std::vector<YamlMap> open_;  ///< the map of the group entered last, below it those above
};

}  // namespace pf
