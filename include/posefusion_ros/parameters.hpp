// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <XmlRpcValue.h>
#include <ros/node_handle.h>
#include <yaml-cpp/yaml.h>

#include <sstream>
#include <string>
#include <vector>

#include "posefusion/config/yaml_map.hpp"
#include "posefusion/slam/config.hpp"

namespace posefusion_ros {

/// Limits of a number parameter.
struct Range {
  double min = 0.0;
  double max = 0.0;
};

/// Private parameters of each nodelet of the chain, which unknown() leaves out: see ChainNodelet.
constexpr char kEndOnError[] = "end_on_error";
constexpr char kDiagnosticPeriod[] = "diagnostic_period";

/// The private parameters of one nodelet: its own ones, and the groups of pf::Config
/// (`blur`, `pose`, ...). Every parameter that is read is checked; unknown() finds those that are
/// not read. Errors are InputError naming parameter, value and what was expected.
class Parameters {
 public:
  explicit Parameters(const ros::NodeHandle& private_handle);
  /// `values` is a struct of parameters, or anything else for none; `origin` goes into messages.
  Parameters(XmlRpc::XmlRpcValue values, std::string origin);

  bool flag(const std::string& name, bool fallback);
  int integer(const std::string& name, int fallback, const Range& range);
  double number(const std::string& name, double fallback, const Range& range);
  std::string text(const std::string& name, const std::string& fallback);
  std::string choice(const std::string& name, const std::string& fallback,
                     const std::vector<std::string>& words);

  /// The chain's configuration: defaults, then the file that `config` names, then the settings of
  /// that of `camera_settings` (see input_settings.hpp), then the groups, then `mode`; each where
  /// it is not empty. `groups` are those that this nodelet uses, for effective().
  pf::Config config(const std::vector<std::string>& groups);

  /// Parameters that were set but never read.
  std::vector<std::string> unknown() const;

  /// All parameters read, with the values in force, "name=value name=value".
  std::string effective() const { return effective_.str(); }

  /// Of these, those that are not the defaults, as a sentence.
  std::string changed() const;

 private:
  template <typename Value>
  Value note(const std::string& name, const Value& value, const Value& fallback);

  YAML::Node tree_;
  std::string origin_;
  pf::YamlMap values_;  ///< of tree_
  std::ostringstream effective_, changed_;
};

/// Reads the fields of a list without groups as parameters of the nodelet itself.
class ParameterFields : public pf::FieldVisitor {
 public:
  explicit ParameterFields(Parameters& parameters) : parameters_(parameters) {}

  void enter(const std::string& /*group*/) override {}
  void leave() override {}
  void flag(const char* name, bool& value, const char*) override {
    value = parameters_.flag(name, value);
  }
  void number(const char* name, double& value, double min, double max, const char*) override {
    value = parameters_.number(name, value, {min, max});
  }
  void integer(const char* name, int& value, int min, int max, const char*) override {
    value = parameters_.integer(name, value, {static_cast<double>(min), static_cast<double>(max)});
  }
  void text(const char* name, std::string& value, const char*) override {
    value = parameters_.text(name, value);
  }
  void choice(const char* name, std::string& value, const std::vector<std::string>& words,
              const char*) override {
    value = parameters_.choice(name, value, words);
  }

 private:
  Parameters& parameters_;
};

/// A parameter tree as YAML, for the loader that files and command lines use too.
YAML::Node toYaml(XmlRpc::XmlRpcValue value);

}  // namespace posefusion_ros
