// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <type_traits>
#include <utility>
#include <vector>

#include "command_option.hpp"

namespace pf {

template <class T>
struct IsVector : std::false_type {};
template <class T>
struct IsVector<std::vector<T>> : std::true_type {};

/// The options of a program, bound to variables, and its subcommands, each a command line of its
/// own. Long options are written out ("--out" is not "--output"), values follow or are attached
/// ("--seed 3", "--seed=3"); an option is given once unless its variable is a vector; what comes
/// after "--" are arguments. Declared objects live as long as the command line.
class CommandLine {
 public:
  CommandLine(std::string about, std::string name);

  /// `names`: "--long", "-l,--long", or a name without dashes: a positional argument.
  /// A vector takes all arguments that are left, or one value each time. The value of the variable
  /// is shown as the default.
  template <class T>
  Option* addOption(const std::string& names, T& variable, const std::string& help = "");
  Option* addFlag(const std::string& names, bool& variable, const std::string& help = "");
  /// Its name is the first word of the command line. A program without options of its own requires
  /// one of its subcommands.
  CommandLine* addCommand(const std::string& name, const std::string& help);

  /// What act() does where this subcommand is named.
  void does(std::function<void()> action) { action_ = std::move(action); }
  /// Does it. Nothing where the subcommand that was named has none.
  void act() const;

  /// Whether this subcommand is the one that was named.
  explicit operator bool() const { return named_; }
  const std::string& name() const { return name_; }

  /// Sets the variables. Returns the text that --help asks for, where it does: then no variable is
  /// set. Throws CommandError.
  std::optional<std::string> parse(const std::vector<std::string>& words);

 private:
  /// A word of the command line, and the option ("output") that it is a value of; empty: an
  /// argument.
  struct Word {
    std::string option, text;
  };

  Option* add(const std::string& names, const std::string& help);
  std::string help() const;
  std::string usage() const;
  /// The word that a subcommand is called by.
  std::string lastName() const { return name_.substr(name_.rfind(' ') + 1); }
  std::string commandNames() const;
  CommandLine* findCommand(const std::string& name) const;
  Option* findOption(const std::string& name) const;
  /// The option that the next argument is for. Throws CommandError where no more are expected.
  Option* nextArgument(const std::string& word) const;
  CommandError missingValue(const std::string& name) const;
  /// Throws CommandError for options that are not declared, and values that are missing.
  std::vector<Word> split(const std::vector<std::string>& words) const;
  void verify() const;

  std::string about_, name_;
  std::vector<std::unique_ptr<Option>> options_;
  std::vector<std::unique_ptr<CommandLine>> commands_;
  std::function<void()> action_;
  bool named_ = false;
};

template <class T>
Option* CommandLine::addOption(const std::string& names, T& variable, const std::string& help) {
  Option* const option = add(names, help);
  option->read_ = [&variable](const std::string& text) { return readValue(text, variable); };
  option->default_ = showValue(variable);
  option->is_many_ = IsVector<T>::value;
  return option;
}

}  // namespace pf
