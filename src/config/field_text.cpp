// SPDX-License-Identifier: BSD-3-Clause
#include "posefusion/config/field_text.hpp"

#include <yaml-cpp/yaml.h>

namespace pf {

std::string numberText(double value) {
  for (int precision = 6; precision <= 17; ++precision) {
    std::ostringstream out;
    out.precision(precision);
    out << value;
    if (std::stod(out.str()) == value) return out.str();
  }
  return std::to_string(value);
}

void FieldLister::flag(const char* name, bool& value, const char*) {
  add(name, value ? "true" : "false");
}
void FieldLister::number(const char* name, double& value, double, double, const char*) {
  add(name, numberText(value));
}
void FieldLister::integer(const char* name, int& value, int, int, const char*) {
  add(name, std::to_string(value));
}
void FieldLister::text(const char* name, std::string& value, const char*) { add(name, value); }
void FieldLister::choice(const char* name, std::string& value, const std::vector<std::string>&,
                         const char*) {
  add(name, value);
}

void FieldLister::add(const char* name, const std::string& value) {
  std::string key;
  for (const auto& group : groups_) key += group + ".";
  fields.emplace_back(key + name, value);
}

void YamlWriter::enter(const std::string& group) {
  out_ << (out_.tellp() > 0 ? "\n" : "") << indent_ << group << ":\n";
  indent_ += "  ";
}
void YamlWriter::leave() { indent_.resize(indent_.size() - 2); }

void YamlWriter::flag(const char* name, bool& value, const char* help) {
  line(name, value ? "true" : "false", help);
}
void YamlWriter::number(const char* name, double& value, double min, double max, const char* help) {
  std::string text = numberText(value);
  if (text.find_first_of(".e") == std::string::npos) text += ".0";
  line(name, text, std::string(help) + " [" + numberText(min) + " to " + numberText(max) + "]");
}
void YamlWriter::integer(const char* name, int& value, int min, int max, const char* help) {
  line(name, std::to_string(value),
       std::string(help) + " [" + std::to_string(min) + " to " + std::to_string(max) + "]");
}
void YamlWriter::text(const char* name, std::string& value, const char* help) {
  std::ostringstream quoted;
  quoted << YAML::Node(value);
  line(name, value.empty() ? "\"\"" : quoted.str(), help);
}
void YamlWriter::choice(const char* name, std::string& value, const std::vector<std::string>& words,
                        const char* help) {
  std::string known;
  for (const auto& word : words) known += (known.empty() ? "" : ", ") + word;
  line(name, value, std::string(help) + " [" + known + "]");
}

void YamlWriter::line(const std::string& name, const std::string& value, const std::string& help) {
  out_ << indent_ << "# " << help << "\n" << indent_ << name << ": " << value << "\n";
}

}  // namespace pf
