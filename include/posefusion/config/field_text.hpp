// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <sstream>
#include <string>
#include <utility>
#include <vector>

#include "posefusion/config/fields.hpp"

namespace pf {

/// The shortest text that reads back as the same number.
std::string numberText(double value);

/// Lists key ("tracking.max_distance_m") and value of each field, in order.
class FieldLister : public FieldVisitor {
 public:
  void enter(const std::string& group) override { groups_.push_back(group); }
  void leave() override { groups_.pop_back(); }
  void flag(const char* name, bool& value, const char* help) override;
  void number(const char* name, double& value, double min, double max, const char* help) override;
  void integer(const char* name, int& value, int min, int max, const char* help) override;
  void text(const char* name, std::string& value, const char* help) override;
  void choice(const char* name, std::string& value, const std::vector<std::string>& words,
              const char* help) override;

  std::vector<std::pair<std::string, std::string>> fields;

 private:
  void add(const char* name, const std::string& value);

  std::vector<std::string> groups_;
};

/// Writes all fields as YAML with help and limits above each. By hand: the Emitter of yaml-cpp
/// neither indents the comment of a map's first key nor gives the others a line of their own.
class YamlWriter : public FieldVisitor {
 public:
  void enter(const std::string& group) override;
  void leave() override;
  void flag(const char* name, bool& value, const char* help) override;
  void number(const char* name, double& value, double min, double max, const char* help) override;
  void integer(const char* name, int& value, int min, int max, const char* help) override;
  void text(const char* name, std::string& value, const char* help) override;
  void choice(const char* name, std::string& value, const std::vector<std::string>& words,
              const char* help) override;

  std::string result() const { return out_.str(); }

 private:
  void line(const std::string& name, const std::string& value, const std::string& help);

  std::ostringstream out_;
  std::string indent_;
};

}  // namespace pf
