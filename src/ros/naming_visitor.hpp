// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string>

#include "posefusion/config/fields.hpp"

namespace posefusion_ros {

/// Knows the whole name of a field and whether it may change.
class NamingVisitor : public pf::FieldVisitor {
 public:
  void enter(const std::string& group) override {
    group_ = group;
    at_start_ = false;
  }
  void leave() override {
    group_.clear();
    at_start_ = false;
  }
  void atStart() override { at_start_ = true; }

 protected:
  std::string whole(const char* name) const { return (group_.empty() ? "" : group_ + "/") + name; }
  bool mayChange() const { return !at_start_; }
  const std::string& group() const { return group_; }

 private:
  std::string group_;
  bool at_start_ = false;
};

}  // namespace posefusion_ros
