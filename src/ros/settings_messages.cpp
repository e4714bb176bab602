// SPDX-License-Identifier: BSD-3-Clause
#include "posefusion_ros/settings_messages.hpp"

#include "naming_visitor.hpp"

namespace posefusion_ros {
namespace {

using dynamic_reconfigure::Config;
using dynamic_reconfigure::ConfigDescription;
using dynamic_reconfigure::GroupState;

template <typename Values, typename Value>
void put(Values& values, const std::string& name, const Value& value) {
  values.emplace_back();
  values.back().name = name;
  values.back().value = value;
}

class ValueLister : public NamingVisitor {
 public:
  void flag(const char* name, bool& value, const char*) override {
    if (mayChange()) put(values.bools, whole(name), static_cast<unsigned char>(value));
  }
  void number(const char* name, double& value, double, double, const char*) override {
    if (mayChange()) put(values.doubles, whole(name), value);
  }
  void integer(const char* name, int& value, int, int, const char*) override {
    if (mayChange()) put(values.ints, whole(name), value);
  }
  void text(const char* name, std::string& value, const char*) override {
    if (mayChange()) put(values.strs, whole(name), value);
  }
  void choice(const char* name, std::string& value, const std::vector<std::string>&,
              const char* help) override {
    text(name, value, help);
  }

  Config values;
};

/// As dynamic_reconfigure's generator writes it, for editors that offer the words.
std::string wordList(const std::vector<std::string>& words) {
  std::string text;
  for (const auto& word : words) {
    text += (text.empty() ? "" : ", ") + ("{'name': '" + word + "', 'value': '" + word) +
            "', 'type': 'str', 'description': '" + word + "'}";
  }
  return "{'enum_description': '', 'enum': [" + text + "]}";
}

class Describer : public NamingVisitor {
 public:
  Describer() { addGroup("Default", 0); }

  void enter(const std::string& name) override {
    NamingVisitor::enter(name);
    addGroup(name, static_cast<int>(out.groups.size()));
  }
  void flag(const char* name, bool& value, const char* help) override {
    if (!add(name, "bool", help, "")) return;
    put(out.min.bools, whole(name), static_cast<unsigned char>(false));
    put(out.max.bools, whole(name), static_cast<unsigned char>(true));
    put(out.dflt.bools, whole(name), static_cast<unsigned char>(value));
  }
  void number(const char* name, double& value, double min, double max, const char* help) override {
    if (!add(name, "double", help, "")) return;
    put(out.min.doubles, whole(name), min);
    put(out.max.doubles, whole(name), max);
    put(out.dflt.doubles, whole(name), value);
  }
  void integer(const char* name, int& value, int min, int max, const char* help) override {
    if (!add(name, "int", help, "")) return;
    put(out.min.ints, whole(name), min);
    put(out.max.ints, whole(name), max);
    put(out.dflt.ints, whole(name), value);
  }
  void text(const char* name, std::string& value, const char* help) override {
    addText(name, value, help, "");
  }
  void choice(const char* name, std::string& value, const std::vector<std::string>& words,
              const char* help) override {
    addText(name, value, help, wordList(words));
  }

  ConfigDescription out;

 private:
  void addGroup(const std::string& name, int id) {
    dynamic_reconfigure::Group group;
    group.name = name;
    group.id = id;
    out.groups.push_back(group);
    GroupState state;
    state.name = name;
    state.state = 1;
    state.id = id;
    for (Config* each : {&out.min, &out.max, &out.dflt}) each->groups.push_back(state);
  }
  bool add(const char* name, const char* type, const char* help, const std::string& words) {
    if (!mayChange()) return false;
    dynamic_reconfigure::ParamDescription parameter;
    parameter.name = whole(name);
    parameter.type = type;
    parameter.description = help;
    parameter.edit_method = words;
    out.groups[group().empty() ? 0 : out.groups.size() - 1].parameters.push_back(parameter);
    return true;
  }
  void addText(const char* name, const std::string& value, const char* help,
               const std::string& words) {
    if (!add(name, "str", help, words)) return;
    put(out.min.strs, whole(name), std::string());
    put(out.max.strs, whole(name), std::string());
    put(out.dflt.strs, whole(name), value);
  }
};

}  // namespace

ConfigDescription describe(const VisitSettings& visit) {
  Describer describer;
  visit(describer);
  return describer.out;
}

Config valuesOf(const VisitSettings& visit) {
  ValueLister lister;
  visit(lister);
  // Readers expect the groups with the values.
  lister.values.groups = describe(visit).dflt.groups;
  return lister.values;
}

}  // namespace posefusion_ros
