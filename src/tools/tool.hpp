// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <functional>
#include <string>
#include <vector>

#include "command_line.hpp"
#include "posefusion/core/frame.hpp"

namespace pf {

/// Reads the command line into the options of `app` and runs `work`. Returns the exit code of the
/// program: that of `work`; 0 for --help; that of CommandFault for a wrong command line; 1 for any
/// other exception. What is wrong is said on stderr after the name of `app`.
int runTool(CommandLine& app, int argc, char** argv, const std::function<int()>& work);

/// The first frames of a TUM folder, those that cannot be read left out: at most `most` of them.
/// Throws InputError where there are fewer than `fewest`.
std::vector<RgbdFrame> readFrames(const std::string& folder, std::size_t fewest, std::size_t most);

}  // namespace pf
