// SPDX-License-Identifier: BSD-3-Clause
#include <yaml-cpp/yaml.h>

#include <algorithm>
#include <set>
#include <sstream>

#include "posefusion/config/field_path.hpp"
#include "posefusion/core/error.hpp"
#include "posefusion/slam/config.hpp"

namespace pf {
namespace {

std::string joined(const std::vector<std::string>& words) {
  std::string text;
  for (const auto& word : words) text += (text.empty() ? "" : ", ") + word;
  return text;
}

/// Sets fields from a YAML tree and remembers which of its keys were used.
class YamlReader : public PathVisitor {
 public:
  YamlReader(const YAML::Node& root, std::string origin)
      : root_(root), origin_(std::move(origin)) {}

  void flag(const char* name, bool& value, const char*) override {
    read(name, value, "true or false");
  }
  void number(const char* name, double& value, double min, double max, const char*) override {
    if (read(name, value, "a number")) check(name, value, min, max);
  }
  void integer(const char* name, int& value, int min, int max, const char*) override {
    if (read(name, value, "a whole number")) check(name, value, min, max);
  }
  void text(const char* name, std::string& value, const char*) override {
    read(name, value, "a text");
  }
  void choice(const char* name, std::string& value, const std::vector<std::string>& words,
              const char*) override {
    if (!read(name, value, "a word")) return;
    if (std::find(words.begin(), words.end(), value) == words.end()) {
      fail(key(name), "is '" + value + "', expected one of " + joined(words));
    }
  }

  /// Throws for a key that no field has.
  void rejectUnknown() const { rejectUnknown(root_, ""); }

 private:
  template <typename Value>
  bool read(const char* name, Value& value, const std::string& expected) {
    known_.insert(key(name));
    YAML::Node node = YAML::Clone(root_);
    for (const auto& group : groups()) {
      if (!node.IsMap()) return false;
      node.reset(node[group]);
      if (!node) return false;
    }
    if (!node.IsMap() || !node[name]) return false;
    const YAML::Node leaf = node[name];
    try {
      value = leaf.as<Value>();
    } catch (const YAML::Exception&) {
      std::ostringstream found;
      found << leaf;
      fail(key(name), "is '" + found.str() + "', expected " + expected);
    }
    return true;
  }

  template <typename Value>
  void check(const char* name, Value value, Value min, Value max) const {
    if (value >= min && value <= max) return;  // NaN is refused too
    fail(key(name),
         "is " + numberText(value) + ", expected " + numberText(min) + " to " + numberText(max));
  }

  void rejectUnknown(const YAML::Node& node, const std::string& prefix) const {
    for (const auto& entry : node) {
      const std::string path = prefix + entry.first.as<std::string>();
      if (known_.count(path) > 0) continue;
      const auto below = known_.lower_bound(path + ".");
      const bool group = below != known_.end() && below->rfind(path + ".", 0) == 0;
      if (!group) fail(path, "is no setting of posefusion");
      if (entry.second.IsNull()) continue;
      if (!entry.second.IsMap()) fail(path, "is a group, expected 'name: value' lines in it");
      rejectUnknown(entry.second, path + ".");
    }
  }

  [[noreturn]] void fail(const std::string& path, const std::string& what) const {
    throw InputError(origin_ + ": " + path + " " + what);
  }

  YAML::Node root_;
  std::string origin_;
  std::set<std::string> known_;
};

/// Writes all fields as commented YAML.
class YamlWriter : public FieldVisitor {
 public:
  void enter(const std::string& group) override {
    out_ << (out_.tellp() > 0 ? "\n" : "") << indent_ << group << ":\n";
    indent_ += "  ";
  }
  void leave() override { indent_.resize(indent_.size() - 2); }
  void flag(const char* name, bool& value, const char* help) override {
    line(name, value ? "true" : "false", help);
  }
  void number(const char* name, double& value, double min, double max, const char* help) override {
    std::string text = numberText(value);
    if (text.find_first_of(".e") == std::string::npos) text += ".0";
    line(name, text, std::string(help) + " [" + numberText(min) + " to " + numberText(max) + "]");
  }
  void integer(const char* name, int& value, int min, int max, const char* help) override {
    line(name, std::to_string(value),
         std::string(help) + " [" + std::to_string(min) + " to " + std::to_string(max) + "]");
  }
  void text(const char* name, std::string& value, const char* help) override {
    std::ostringstream quoted;
    quoted << YAML::Node(value);
    line(name, value.empty() ? "\"\"" : quoted.str(), help);
  }
  void choice(const char* name, std::string& value, const std::vector<std::string>& words,
              const char* help) override {
    line(name, value, std::string(help) + " [" + joined(words) + "]");
  }
  std::string result() const { return out_.str(); }

 private:
  void line(const std::string& name, const std::string& value, const std::string& help) {
    out_ << indent_ << "# " << help << "\n" << indent_ << name << ": " << value << "\n";
  }

  std::ostringstream out_;
  std::string indent_;
};

}  // namespace

std::string numberText(double value) {
  for (int precision = 6; precision <= 17; ++precision) {
    std::ostringstream out;
    out.precision(precision);
    out << value;
    if (std::stod(out.str()) == value) return out.str();
  }
  return std::to_string(value);
}

void applyYaml(Config& config, const YAML::Node& node, const std::string& origin) {
  if (!node || node.IsNull()) return;
  if (!node.IsMap()) throw InputError(origin + ": expected groups of 'name: value' lines");
  Config changed = config;
  YamlReader reader(node, origin);
  visitFields(changed, reader);
  reader.rejectUnknown();
  config = changed;
}

std::string toYaml(const Config& config) {
  Config copy = config;
  YamlWriter writer;
  visitFields(copy, writer);
  return writer.result();
}

}  // namespace pf
