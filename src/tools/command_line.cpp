// SPDX-License-Identifier: BSD-3-Clause
#include "command_line.hpp"

#include <algorithm>
#include <boost/program_options.hpp>

namespace pf {
namespace {

namespace po = boost::program_options;

// As getopt_long reads them, without the guessing of abbreviations.
constexpr int kStyle = po::command_line_style::unix_style &
                       ~po::command_line_style::allow_guessing &
                       ~po::command_line_style::allow_sticky;

bool isValueMissing(const po::error& error) {
  const auto* syntax = dynamic_cast<const po::invalid_syntax*>(&error);
  return syntax != nullptr && (syntax->kind() == po::invalid_syntax::missing_parameter ||
                               syntax->kind() == po::invalid_syntax::empty_adjacent_parameter);
}

/// Names in the left column, what they are in the right one.
using Rows = std::vector<std::pair<std::string, std::string>>;

std::string table(const std::string& title, const Rows& rows) {
  constexpr std::size_t kColumn = 28;
  std::string text = "\n" + title + ":\n";
  for (const auto& [left, right] : rows) {
    const bool is_beside = left.size() < kColumn;
    const std::size_t gap = is_beside ? kColumn - left.size() : kColumn + 2;
    text += "  " + left + (is_beside ? "" : "\n") + std::string(gap, ' ') + right + "\n";
  }
  return text;
}

}  // namespace

CommandLine::CommandLine(std::string about, std::string name)
    : about_(std::move(about)), name_(std::move(name)) {}

Option* CommandLine::add(const std::string& names, const std::string& help) {
  options_.push_back(std::unique_ptr<Option>(new Option(names, help)));
  return options_.back().get();
}

Option* CommandLine::addFlag(const std::string& names, bool& variable, const std::string& help) {
  Option* const option = add(names, help);
  option->is_flag_ = true;
  option->read_ = [&variable](const std::string&) {
    variable = true;
    return std::string();
  };
  return option;
}

CommandLine* CommandLine::addCommand(const std::string& name, const std::string& help) {
  commands_.push_back(std::make_unique<CommandLine>(help, name_ + " " + name));
  return commands_.back().get();
}

void CommandLine::act() const {
  for (const auto& command : commands_) {
    if (*command && command->action_) command->action_();
  }
}

CommandLine* CommandLine::findCommand(const std::string& name) const {
  for (const auto& command : commands_) {
    if (command->lastName() == name) return command.get();
  }
  return nullptr;
}

Option* CommandLine::findOption(const std::string& name) const {
  if (name.empty()) return nullptr;
  for (const auto& option : options_) {
    if (option->name_ == name || option->short_name_ == name) return option.get();
  }
  return nullptr;
}

Option* CommandLine::nextArgument(const std::string& word) const {
  for (const auto& option : options_) {
    if (option->isArgument() && (!option->given_ || option->is_many_)) return option.get();
  }
  const std::string expected = commands_.empty() ? "no more arguments" : "one of " + commandNames();
  throw CommandError(CommandFault::unknown, "'" + word + "' is too much, expected " + expected);
}

std::string CommandLine::commandNames() const {
  std::string names;
  for (const auto& command : commands_) names += (names.empty() ? "" : ", ") + command->lastName();
  return names;
}

std::string CommandLine::usage() const {
  std::string text = "Usage: " + name_;
  for (const auto& option : options_) {
    if (!option->isArgument()) continue;
    text += option->is_required_ ? " " + option->synopsis() : " [" + option->synopsis() + "]";
  }
  if (options_.empty() && !commands_.empty()) return text + " COMMAND [OPTIONS]\n";
  text += " [OPTIONS]\n";
  return commands_.empty() ? text : text + "       " + name_ + " COMMAND [OPTIONS]\n";
}

std::string CommandLine::help() const {
  std::vector<std::pair<std::string, Rows>> groups = {
      {"Arguments", {}}, {"Options", {{"-h,--help", "print this and stop"}}}};
  for (const auto& option : options_) {
    const auto is_its = [&](const auto& group) { return group.first == option->group_; };
    auto group = std::find_if(groups.begin(), groups.end(), is_its);
    if (group == groups.end()) group = groups.insert(group, {option->group_, {}});
    group->second.push_back({option->synopsis(), option->shownHelp()});
  }
  groups.push_back({"Commands (COMMAND --help: more)", {}});
  for (const auto& command : commands_) {
    groups.back().second.push_back({command->lastName(), command->about_});
  }
  std::string text = about_ + "\n" + usage();
  for (const auto& [title, rows] : groups) {
    if (!rows.empty()) text += table(title, rows);
  }
  return text;
}

void CommandLine::verify() const {
  if (options_.empty() && !commands_.empty()) {
    throw CommandError(CommandFault::missing,
                       "the command is missing, expected one of " + commandNames());
  }
  for (const auto& option : options_) option->verify();
}

CommandError CommandLine::missingValue(const std::string& name) const {
  const Option* const option = findOption(name);
  const std::string expected = option == nullptr ? "one" : option->expected();
  return {CommandFault::wrong_count, name + ": its value is missing, expected " + expected};
}

std::vector<CommandLine::Word> CommandLine::split(const std::vector<std::string>& words) const {
  po::options_description declared;
  declared.add_options()("help,h", "");
  for (const auto& option : options_) {
    if (option->isArgument()) continue;
    auto* const value = po::value<std::string>();
    if (option->is_flag_) value->zero_tokens();
    declared.add_options()(option->parserNames().c_str(), value, "");
  }
  std::vector<Word> split;
  try {
    const auto parsed = po::command_line_parser(words).options(declared).style(kStyle).run();
    for (const po::option& option : parsed.options) {
      if (option.original_tokens.size() == 2 && findOption(option.original_tokens[1]) != nullptr) {
        throw missingValue(option.original_tokens[0]);  // Boost takes the option for the value
      }
      split.push_back({option.string_key, option.value.empty() ? "" : option.value.front()});
    }
  } catch (const po::unknown_option& error) {
    throw CommandError(CommandFault::unknown,
                       error.get_option_name() + " is unknown, expected an option of " + name_);
  } catch (const po::error_with_option_name& error) {
    if (isValueMissing(error)) throw missingValue(error.get_option_name());
    throw CommandError(CommandFault::wrong_count, error.get_option_name() + " takes no value");
  }
  return split;
}

std::optional<std::string> CommandLine::parse(const std::vector<std::string>& words) {
  if (CommandLine* const command = words.empty() ? nullptr : findCommand(words.front())) {
    command->named_ = true;
    return command->parse({words.begin() + 1, words.end()});
  }
  const std::vector<Word> given = split(words);
  const auto asks_help = [](const Word& word) { return word.option == "help"; };
  if (std::any_of(given.begin(), given.end(), asks_help)) return help();
  for (const Word& word : given) {
    Option* const option =
        word.option.empty() ? nextArgument(word.text) : findOption("--" + word.option);
    option->take(word.text);
  }
  verify();
  return std::nullopt;
}

}  // namespace pf
