// SPDX-License-Identifier: BSD-3-Clause
#include "tool.hpp"

#include <malloc.h>

#include <exception>
#include <iostream>
#include <utility>

#include "posefusion/core/error.hpp"
#include "posefusion/io/frame_source.hpp"

namespace pf {
namespace {

// glibc gives every thread a heap of its own, up to eight for each core, and none of them takes
// back what another has freed: over hours that is more than what is in use.
constexpr int kHeaps = 2;

}  // namespace

int runTool(CommandLine& app, int argc, char** argv, const std::function<int()>& work) {
  mallopt(M_ARENA_MAX, kHeaps);
  try {
    if (const auto help = app.parse({argv + 1, argv + argc})) {
      std::cout << *help;
      return 0;
    }
    return work();
  } catch (const CommandError& error) {
    std::cerr << app.name() << ": " << error.what() << " (see --help)\n";
    return static_cast<int>(error.fault());
  } catch (const std::exception& error) {
    std::cerr << app.name() << ": " << error.what() << "\n";
    return 1;
  }
}

std::vector<RgbdFrame> readFrames(const std::string& folder, std::size_t fewest, std::size_t most) {
  const auto source = openTumFolder(folder);
  std::vector<RgbdFrame> frames;
  while (frames.size() < most) {
    auto next = source->next();
    if (!next) break;
    if (next->defect.empty()) frames.push_back(std::move(next->frame));
  }
  if (frames.size() < fewest) {
    throw InputError(folder + ": has " + std::to_string(frames.size()) +
                     " frames that can be read, expected " + std::to_string(fewest) + " or more");
  }
  return frames;
}

}  // namespace pf
