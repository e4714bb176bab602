// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <functional>
#include <stdexcept>
#include <string>
#include <utility>
#include <vector>

#include "command_value.hpp"

namespace pf {

/// What is wrong with a command line; the number is the exit code of the program.
enum class CommandFault {
  not_a_value = 104,  ///< cannot be read
  refused = 105,      ///< can be read, but is not accepted
  missing = 106,
  needs_another = 107,
  excludes_another = 108,
  unknown = 109,
  wrong_count = 114  ///< a value is missing, or one too many
};

/// A command line that is not as it was declared. Names the option and what was expected.
class CommandError : public std::runtime_error {
 public:
  CommandError(CommandFault fault, const std::string& what)
      : std::runtime_error(what), fault_(fault) {}
  CommandFault fault() const { return fault_; }

 private:
  CommandFault fault_;
};

/// One option ("--output") or argument ("input") of a CommandLine.
class Option {
 public:
  Option* required();
  /// Several are looked at in order, each value by each.
  Option* check(ValueCheck check);
  Option* needs(const Option* other);
  Option* excludes(const Option* other);
  /// Heading that it stands below in the help.
  Option* group(std::string title);

  /// Whether it was on the command line.
  explicit operator bool() const { return given_; }

 private:
  friend class CommandLine;
  Option(const std::string& names, std::string help);

  bool isArgument() const { return name_[0] != '-'; }
  /// As the user knows it: --output, INPUT.
  std::string shownName() const;
  /// How it is written: -o,--output VALUE.
  std::string synopsis() const;
  /// The same for Boost's parser: output,o.
  std::string parserNames() const;
  std::string shownHelp() const;
  /// What a value of it has to be.
  std::string expected() const;
  /// One value from the command line. Throws CommandError.
  void take(std::string text);
  /// That it is there, and what it needs too. Throws CommandError.
  void verify() const;

  std::string name_, short_name_, help_, default_, group_ = "Options";
  std::function<std::string(const std::string&)> read_;  ///< see readValue()
  std::vector<ValueCheck> checks_;
  std::vector<const Option*> needed_, excluded_;
  bool is_required_ = false, is_flag_ = false, is_many_ = false, given_ = false;
};

}  // namespace pf
