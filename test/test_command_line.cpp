// SPDX-License-Identifier: BSD-3-Clause
// Command lines as a user types them: what is read, and the messages on wrong ones.
#include <gtest/gtest.h>

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "tools/command_line.hpp"

namespace pf {
namespace {

using Words = std::vector<std::string>;

/// A program with one option of each kind.
struct Program {
  CommandLine app{"Does something.", "program"};
  std::string input, output = "there", mode;
  double offset_s = 0;
  int threads = 0;
  std::size_t frames = 100;
  std::optional<std::uint32_t> seed;
  std::vector<std::string> settings;
  bool fast = false, slow = false;
  const Option* input_option;
  const Option* mode_option;

  Program() {
    input_option = app.addOption("input", input, "TUM folder or bag")->required();
    app.addOption("-o,--output", output, "folder to write into");
    mode_option = app.addOption("--mode", mode, "how")->check(oneOf({"one", "two"}));
    app.addOption("--offset-s", offset_s, "of depth")->check(range(-10.0, 10.0))->group("Bags");
    app.addOption("--threads", threads, "0: all")->check(range(0, 1024));
    app.addOption("--frames", frames)->check(positive());
    app.addOption("--seed", seed, "of chance");
    app.addOption("--set", settings, "may be repeated");
    Option* const fast_option = app.addFlag("--fast", fast, "be fast");
    app.addFlag("--slow", slow, "be slow")->needs(mode_option)->excludes(fast_option);
  }

  /// The exit code, and in `said` the message; 0: none.
  int fault(const Words& words) {
    said.clear();
    try {
      if (const auto help = app.parse(words)) said = *help;
      return 0;
    } catch (const CommandError& error) {
      said = error.what();
      return static_cast<int>(error.fault());
    }
  }
  std::string said;
};

int faultOf(const Words& words, std::string& said) {
  Program program;
  const int fault = program.fault(words);
  said = program.said;
  return fault;
}

TEST(CommandLine, ReadsOptionsInEachForm) {
  Program p;
  ASSERT_EQ(p.fault({"-o", "here", "--mode=two", "in", "--threads", "3", "--seed=4294967295",
                     "--frames", "7", "--fast"}),
            0)
      << p.said;
  EXPECT_EQ(p.input, "in");
  EXPECT_EQ(p.output, "here");
  EXPECT_EQ(p.mode, "two");
  EXPECT_EQ(p.threads, 3);
  EXPECT_EQ(p.seed, 4294967295U);
  EXPECT_EQ(p.frames, 7U);
  EXPECT_TRUE(p.fast);
  EXPECT_FALSE(p.slow);
  EXPECT_TRUE(*p.mode_option);
}

TEST(CommandLine, LeavesDefaultsAlone) {
  Program p;
  ASSERT_EQ(p.fault({"in"}), 0) << p.said;
  EXPECT_EQ(p.output, "there");
  EXPECT_EQ(p.frames, 100U);
  EXPECT_FALSE(p.seed);
  EXPECT_FALSE(*p.mode_option);
}

TEST(CommandLine, NegativeNumbersAndEmptyTextsAreValues) {
  Program p;
  ASSERT_EQ(p.fault({"--offset-s", "-0.5", "--output", "", "in"}), 0) << p.said;
  EXPECT_EQ(p.offset_s, -0.5);
  EXPECT_EQ(p.output, "");
}

TEST(CommandLine, RepeatsOnlyWhatIsMeantTo) {
  Program p;
  ASSERT_EQ(p.fault({"--set", "a=1", "in", "--set=b=2"}), 0) << p.said;
  EXPECT_EQ(p.settings, (Words{"a=1", "b=2"}));
  std::string said;
  EXPECT_EQ(faultOf({"in", "--mode", "one", "--mode", "two"}, said), 114);
  EXPECT_EQ(said, "--mode is given twice, expected once");
}

TEST(CommandLine, WhatFollowsTwoDashesAreArguments) {
  Program p;
  ASSERT_EQ(p.fault({"--fast", "--", "--mode"}), 0) << p.said;
  EXPECT_EQ(p.input, "--mode");
  EXPECT_FALSE(*p.mode_option);
}

TEST(CommandLine, UnknownOptionsAreNamed) {
  std::string said;
  EXPECT_EQ(faultOf({"in", "--modus", "one"}, said), 109);
  EXPECT_EQ(said, "--modus is unknown, expected an option of program");
  EXPECT_EQ(faultOf({"in", "--mod", "one"}, said), 109) << "abbreviations are not guessed";
  EXPECT_EQ(said, "--mod is unknown, expected an option of program");
  EXPECT_EQ(faultOf({"in", "-x"}, said), 109);
  EXPECT_EQ(said, "-x is unknown, expected an option of program");
  EXPECT_EQ(faultOf({"in", "more"}, said), 109);
  EXPECT_EQ(said, "'more' is too much, expected no more arguments");
}

TEST(CommandLine, MissingOnesAreNamed) {
  std::string said;
  EXPECT_EQ(faultOf({}, said), 106);
  EXPECT_EQ(said, "INPUT is missing: TUM folder or bag");
  EXPECT_EQ(faultOf({"in", "--mode"}, said), 114);
  EXPECT_EQ(said, "--mode: its value is missing, expected one of one, two");
  EXPECT_EQ(faultOf({"in", "--output="}, said), 114);
  EXPECT_EQ(said, "--output: its value is missing, expected folder to write into");
  EXPECT_EQ(faultOf({"in", "--mode", "--fast"}, said), 114) << "an option is no value";
  EXPECT_EQ(said, "--mode: its value is missing, expected one of one, two");
  EXPECT_EQ(faultOf({"in", "-o", "--fast"}, said), 114);
  EXPECT_EQ(faultOf({"in", "--output=--fast"}, said), 0) << said;
  EXPECT_EQ(faultOf({"in", "--fast=yes"}, said), 114);
  EXPECT_EQ(said, "--fast takes no value");
}

TEST(CommandLine, WrongValuesAreNamedWithWhatWasExpected) {
  std::string said;
  EXPECT_EQ(faultOf({"in", "--threads", "-3"}, said), 105);
  EXPECT_EQ(said, "--threads: '-3': expected a whole number, 0 to 1024");
  EXPECT_EQ(faultOf({"in", "--threads", "3x"}, said), 105);
  EXPECT_EQ(faultOf({"in", "--threads", "3.5"}, said), 105);
  EXPECT_EQ(faultOf({"in", "--threads", ""}, said), 105);
  EXPECT_EQ(faultOf({"in", "--offset-s", "10.5"}, said), 105);
  EXPECT_EQ(said, "--offset-s: '10.5': expected a number, -10 to 10");
  EXPECT_EQ(faultOf({"in", "--offset-s", "nan"}, said), 105);
  EXPECT_EQ(faultOf({"in", "--mode", "three"}, said), 105);
  EXPECT_EQ(said, "--mode: 'three': expected one of one, two");
  EXPECT_EQ(faultOf({"in", "--frames", "0"}, said), 105);
  EXPECT_EQ(said, "--frames: '0': expected a number above 0");
  EXPECT_EQ(faultOf({"in", "--seed", "-1"}, said), 104);
  EXPECT_EQ(said, "--seed: '-1': expected a whole number, 0 to 4294967295");
  EXPECT_EQ(faultOf({"in", "--seed", "4294967296"}, said), 104) << "numbers do not wrap around";
}

TEST(CommandLine, OptionsNeedAndExcludeOthers) {
  std::string said;
  EXPECT_EQ(faultOf({"in", "--slow", "--mode", "one"}, said), 0) << said;
  EXPECT_EQ(faultOf({"in", "--slow"}, said), 107);
  EXPECT_EQ(said, "--slow needs --mode");
  EXPECT_EQ(faultOf({"in", "--slow", "--mode", "one", "--fast"}, said), 108);
  EXPECT_EQ(said, "--slow and --fast exclude each other");
}

TEST(CommandLine, HelpListsEveryOptionAndSetsNone) {
  Program p;
  ASSERT_EQ(p.fault({"--help", "--output", "here"}), 0)
      << "nothing is missing where help is requested";
  EXPECT_EQ(p.output, "there");
  for (const char* part :
       {"Does something.", "Usage: program INPUT [OPTIONS]", "TUM folder or bag", "-h,--help",
        "-o,--output VALUE", "folder to write into (default there)", "[one of one, two]",
        "\nBags:\n", "[a number, -10 to 10]", "(with --mode) (not with --fast)"}) {
    EXPECT_NE(p.said.find(part), std::string::npos) << part << "\nin\n" << p.said;
  }
}

TEST(CommandLine, ManyArgumentsAreTakenByAVector) {
  CommandLine app{"Looks at scenarios.", "look"};
  std::vector<std::string> names;
  int every = 1;
  app.addOption("names", names, "of scenarios")->required();
  app.addOption("--every", every);
  EXPECT_EQ(app.parse({"a", "--every", "2", "b", "c"}), std::nullopt);
  EXPECT_EQ(names, (Words{"a", "b", "c"}));
  EXPECT_EQ(every, 2);
}

/// A program of subcommands, which has arguments of its own too.
struct Commands {
  CommandLine app{"Evaluates.", "evaluate"};
  std::string truth, file;
  bool json = false;
  CommandLine* info = app.addCommand("info", "prints what is in it");
  CommandLine* check = app.addCommand("check", "reads all of it");

  explicit Commands(bool with_arguments) {
    for (CommandLine* command : {info, check}) command->addOption("file", file)->required();
    check->addFlag("--json", json, "print JSON");
    if (with_arguments) app.addOption("truth", truth, "a trajectory");
  }
};

TEST(CommandLine, TheFirstWordNamesTheSubcommand) {
  Commands c(false);
  EXPECT_EQ(c.app.parse({"check", "info", "--json"}), std::nullopt);
  EXPECT_TRUE(*c.check);
  EXPECT_FALSE(*c.info);
  EXPECT_EQ(c.file, "info");
  EXPECT_TRUE(c.json);
}

TEST(CommandLine, SubcommandsHaveHelpAndOptionsOfTheirOwn) {
  Commands c(false);
  const auto all = c.app.parse({"--help"});
  ASSERT_TRUE(all);
  EXPECT_NE(all->find("Usage: evaluate COMMAND"), std::string::npos) << *all;
  EXPECT_NE(all->find("prints what is in it"), std::string::npos) << *all;
  const auto one = Commands(false).app.parse({"check", "--help"});
  ASSERT_TRUE(one);
  EXPECT_NE(one->find("Usage: evaluate check FILE [OPTIONS]"), std::string::npos) << *one;
  EXPECT_NE(one->find("--json"), std::string::npos) << *one;
  EXPECT_THROW(Commands(false).app.parse({"info", "map", "--json"}), CommandError);
}

TEST(CommandLine, AMissingOrUnknownSubcommandIsReportedWithTheKnownOnes) {
  for (const Words& words : {Words{}, Words{"chek", "file"}}) {
    Commands c(false);
    try {
      c.app.parse(words);
      ADD_FAILURE() << "no message";
    } catch (const CommandError& error) {
      EXPECT_NE(std::string(error.what()).find("expected one of info, check"), std::string::npos)
          << error.what();
    }
  }
}

TEST(CommandLine, AProgramWithArgumentsDoesNotRequireItsSubcommands) {
  Commands c(true);
  EXPECT_EQ(c.app.parse({"path"}), std::nullopt);
  EXPECT_EQ(c.truth, "path");
  Commands d(true);
  EXPECT_EQ(d.app.parse({"--", "info"}), std::nullopt) << "a file may be called like a command";
  EXPECT_EQ(d.truth, "info");
  EXPECT_FALSE(*d.info);
}

}  // namespace
}  // namespace pf
