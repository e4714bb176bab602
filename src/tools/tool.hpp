// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <CLI/CLI.hpp>
#include <cstddef>
#include <functional>
#include <string>
#include <vector>

#include "posefusion/core/frame.hpp"

namespace pf {

/// Reads the command line into the options of `app` and runs `work`. Returns the exit code of the
/// program: that of `work`; CLI11's for a wrong command line (and 0 for --help); 1 for any other
/// exception, which is said on stderr after the name of `app`.
int runTool(CLI::App& app, int argc, char** argv, const std::function<int()>& work);

/// The first frames of a TUM folder, those that cannot be read left out: at most `most` of them.
/// Throws InputError where there are fewer than `fewest`.
std::vector<RgbdFrame> readFrames(const std::string& folder, std::size_t fewest, std::size_t most);

}  // namespace pf
