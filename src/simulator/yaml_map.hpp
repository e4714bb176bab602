// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <yaml-cpp/yaml.h>

#include <Eigen/Core>
#include <optional>
#include <set>
#include <string>
#include <vector>

#include "posefusion/config/fields.hpp"

namespace pf::simulator {

/// A map of a scene file, read key by key. All errors are InputError and name the file, the place
/// in it, the value and what was expected; finish() throws for keys that nobody asked for.
class YamlMap : public FieldVisitor {
 public:
  YamlMap(const YAML::Node& node, std::string where);

  bool has(const std::string& key) const;
  double number(const std::string& key, double otherwise, double min, double max);
  int integer(const std::string& key, int otherwise, int min, int max);
  bool flag(const std::string& key, bool otherwise);
  std::string text(const std::string& key, const std::string& otherwise);
  std::string word(const std::string& key, const std::string& otherwise,
                   const std::vector<std::string>& words);
  double angle(const std::string& key, double otherwise_rad);  ///< degrees in the file
  Eigen::Vector2d vector2(const std::string& key, const Eigen::Vector2d& otherwise);
  Eigen::Vector3d vector3(const std::string& key, const Eigen::Vector3d& otherwise);
  std::optional<Eigen::Vector3d> maybeVector3(const std::string& key);
  /// Two or three numbers; z is NaN where only two are given.
  std::optional<Eigen::Vector3d> placeOf(const std::string& key);
  std::vector<Eigen::Vector2d> points(const std::string& key);
  YamlMap map(const std::string& key);
  std::vector<YamlMap> maps(const std::string& key);

  /// Throws for keys that were not read.
  void finish() const;
  [[noreturn]] void fail(const std::string& key, const std::string& what) const;

  // Settings listed by visitFields().
  void enter(const std::string&) override {}
  void leave() override {}
  void flag(const char* name, bool& value, const char*) override {
    value = flag(std::string(name), value);
  }
  void number(const char* name, double& value, double min, double max, const char*) override {
    value = number(std::string(name), value, min, max);
  }
  void integer(const char* name, int& value, int min, int max, const char*) override {
    value = integer(std::string(name), value, min, max);
  }
  void text(const char* name, std::string& value, const char*) override {
    value = text(std::string(name), value);
  }
  void choice(const char* name, std::string& value, const std::vector<std::string>& words,
              const char*) override {
    value = word(name, value, words);
  }

 private:
  YAML::Node get(const std::string& key);
  std::vector<double> numbers(const std::string& key, std::size_t count);

  YAML::Node node_;
  std::string where_;
  std::set<std::string> used_;
};

}  // namespace pf::simulator
