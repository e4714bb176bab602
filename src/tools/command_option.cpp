// SPDX-License-Identifier: BSD-3-Clause
#include "command_option.hpp"

#include <cctype>

namespace pf {

Option::Option(const std::string& names, std::string help) : help_(std::move(help)) {
  const std::size_t comma = names.find(',');
  name_ = comma == std::string::npos ? names : names.substr(comma + 1);
  if (comma != std::string::npos) short_name_ = names.substr(0, comma);
  if (isArgument()) group_ = "Arguments";
}

Option* Option::required() {
  is_required_ = true;
  return this;
}

Option* Option::check(ValueCheck check) {
  checks_.push_back(std::move(check));
  return this;
}

Option* Option::needs(const Option* other) {
  needed_.push_back(other);
  return this;
}

Option* Option::excludes(const Option* other) {
  excluded_.push_back(other);
  return this;
}

Option* Option::group(std::string title) {
  group_ = std::move(title);
  return this;
}

std::string Option::shownName() const {
  if (!isArgument()) return name_;
  std::string name = name_;
  for (char& c : name) c = static_cast<char>(std::toupper(static_cast<unsigned char>(c)));
  return name;
}

std::string Option::synopsis() const {
  if (isArgument()) return shownName() + (is_many_ ? "..." : "");
  return (short_name_.empty() ? "" : short_name_ + ",") + name_ + (is_flag_ ? "" : " VALUE");
}

std::string Option::parserNames() const {
  return name_.substr(2) + (short_name_.empty() ? "" : "," + short_name_.substr(1));
}

std::string Option::expected() const {
  for (const ValueCheck& check : checks_) {
    if (!check.expected.empty()) return check.expected;
  }
  return help_.empty() ? "a value" : help_;
}

std::string Option::shownHelp() const {
  std::string text = help_;
  const auto append = [&text](const std::string& more) {
    text += (text.empty() ? "" : " ") + more;
  };
  for (const ValueCheck& check : checks_) {
    if (!check.expected.empty()) append("[" + check.expected + "]");
  }
  if (!default_.empty()) append("(default " + default_ + ")");
  for (const Option* other : needed_) append("(with " + other->name_ + ")");
  for (const Option* other : excluded_) append("(not with " + other->name_ + ")");
  return text;
}

void Option::take(std::string text) {
  if (given_ && !is_many_) {
    throw CommandError(CommandFault::wrong_count, shownName() + " is given twice, expected once");
  }
  given_ = true;
  const std::string typed = text;
  const auto refuse = [&](CommandFault fault, const std::string& expected) {
    throw CommandError(fault, shownName() + ": '" + typed + "': expected " + expected);
  };
  for (const ValueCheck& check : checks_) {
    if (!check.accepts(text)) refuse(CommandFault::refused, check.expected);
  }
  const std::string expected = read_(text);
  if (!expected.empty()) refuse(CommandFault::not_a_value, expected);
}

void Option::verify() const {
  if (is_required_ && !given_) {
    throw CommandError(CommandFault::missing, shownName() + " is missing: " + help_);
  }
  if (!given_) return;
  for (const Option* other : needed_) {
    if (*other) continue;
    throw CommandError(CommandFault::needs_another, name_ + " needs " + other->shownName());
  }
  for (const Option* other : excluded_) {
    if (!*other) continue;
    throw CommandError(CommandFault::excludes_another,
                       name_ + " and " + other->shownName() + " exclude each other");
  }
}

}  // namespace pf
