// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string>
#include <vector>

#include "posefusion/config/fields.hpp"

namespace pf {

/// The shortest text that reads back as the same number.
std::string numberText(double value);

/// Keeps the group names above the current field: "tracking.".
class PathVisitor : public FieldVisitor {
 public:
  void enter(const std::string& group) override { groups_.push_back(group); }
  void leave() override { groups_.pop_back(); }

 protected:
  std::string key(const char* name) const {
    std::string path;
    for (const auto& group : groups_) path += group + ".";
    return path + name;
  }

  const std::vector<std::string>& groups() const { return groups_; }

 private:
  std::vector<std::string> groups_;
};

}  // namespace pf
