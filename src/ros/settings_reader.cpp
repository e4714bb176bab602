// SPDX-License-Identifier: BSD-3-Clause
#include <algorithm>
#include <map>
#include <set>

#include "naming_visitor.hpp"
#include "posefusion/config/field_text.hpp"
#include "posefusion/core/error.hpp"
#include "posefusion_ros/settings_messages.hpp"

namespace posefusion_ros {
namespace {

using dynamic_reconfigure::Config;
using pf::InputError;

/// Takes what a request gives.
class ValueReader : public NamingVisitor {
 public:
  explicit ValueReader(const Config& request) {
    for (const auto& each : request.bools) note(each, flags_, each.value ? "true" : "false");
    for (const auto& each : request.ints) note(each, integers_, std::to_string(each.value));
    for (const auto& each : request.doubles) note(each, numbers_, pf::numberText(each.value));
    for (const auto& each : request.strs) note(each, texts_, "'" + each.value + "'");
  }

  void flag(const char* name, bool& value, const char*) override {
    if (const auto* given = find(name, flags_, "true or false")) value = *given;
  }
  void number(const char* name, double& value, double min, double max, const char*) override {
    const std::string limits = pf::numberText(min) + " to " + pf::numberText(max);
    const auto whole_number = integers_.find(whole(name));
    if (whole_number != integers_.end()) numbers_[whole(name)] = whole_number->second;
    const auto* given = find(name, numbers_, limits);
    if (given == nullptr) return;
    if (!(*given >= min && *given <= max)) refuse(name, limits);
    value = *given;
  }
  void integer(const char* name, int& value, int min, int max, const char*) override {
    const std::string limits = std::to_string(min) + " to " + std::to_string(max);
    const auto* given = find(name, integers_, limits);
    if (given == nullptr) return;
    if (*given < min || *given > max) refuse(name, limits);
    value = *given;
  }
  void text(const char* name, std::string& value, const char*) override {
    if (const auto* given = find(name, texts_, "a text")) value = *given;
  }
  void choice(const char* name, std::string& value, const std::vector<std::string>& words,
              const char*) override {
    std::string list;
    for (const auto& word : words) list += (list.empty() ? "one of " : ", ") + word;
    const auto* given = find(name, texts_, list);
    if (given == nullptr) return;
    if (std::find(words.begin(), words.end(), *given) == words.end()) refuse(name, list);
    value = *given;
  }

  void finish() const {
    for (const auto& [name, value] : given_) {
      if (taken_.count(name) > 0) continue;
      throw InputError("there is no setting " + name + " that may change while this runs");
    }
  }

 private:
  template <typename Each, typename Values>
  void note(const Each& each, Values& values, const std::string& text) {
    values[each.name] = each.value;
    given_[each.name] = text;
  }

  /// The value of that type; null where none is given.
  template <typename Value>
  const Value* find(const char* name, const std::map<std::string, Value>& values,
                    const std::string& expected) {
    const std::string key = whole(name);
    if (given_.count(key) == 0) return nullptr;
    if (!mayChange()) {
      throw InputError(key + " is read at the start alone: start anew with another value");
    }
    const auto found = values.find(key);
    if (found == values.end()) refuse(name, expected);
    taken_.insert(key);
    return &found->second;
  }

  [[noreturn]] void refuse(const char* name, const std::string& expected) const {
    throw InputError(whole(name) + " is " + given_.at(whole(name)) + ", expected " + expected);
  }

  std::map<std::string, bool> flags_;
  std::map<std::string, int> integers_;
  std::map<std::string, double> numbers_;
  std::map<std::string, std::string> texts_;
  std::map<std::string, std::string> given_;  // name and value as text
  std::set<std::string> taken_;               // names that a field has
};

}  // namespace

void readValues(const Config& request, const VisitSettings& visit) {
  ValueReader reader(request);
  visit(reader);
  reader.finish();
}

}  // namespace posefusion_ros
