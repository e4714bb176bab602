// SPDX-License-Identifier: BSD-3-Clause
// posefusion_person_data: training pictures for the embedded person model, to stdout.
#include <tbb/global_control.h>

#include <algorithm>
#include <cstdio>
#include <memory>
#include <string>
#include <vector>

#include "posefusion/core/error.hpp"
#include "posefusion/core/parallel.hpp"
#include "simulator/person_samples.hpp"
#include "tool.hpp"

namespace {

using namespace pf;
using namespace pf::simulator;

struct Options {
  std::uint32_t seed = 1;
  std::uint32_t first_room = 0;
  std::uint32_t rooms = 1;
  int threads = 0;
};

void addOptions(CommandLine& app, Options& o) {
  app.addOption("--seed", o.seed, "everything random; same seed, same bytes");
  app.addOption("--first-room", o.first_room, "number of the first room");
  app.addOption("--rooms", o.rooms,
                "so many rooms, " + std::to_string(kSamplesPerRoom) + " pictures of each");
  app.addOption("--threads", o.threads, "at most so many, 0: as many as there are cores")
      ->check(nonNegative());
}

int stream(const Options& o) {
  std::unique_ptr<tbb::global_control> limit;
  if (o.threads > 0) {
    limit = std::make_unique<tbb::global_control>(tbb::global_control::max_allowed_parallelism,
                                                  static_cast<std::size_t>(o.threads));
  }
  const std::uint32_t batch =
      std::max(1U, o.threads > 0 ? 2U * static_cast<unsigned>(o.threads) : 8U);
  for (std::uint32_t done = 0; done < o.rooms; done += batch) {
    const std::uint32_t count = std::min(batch, o.rooms - done);
    std::vector<std::vector<char>> bytes(count);
    parallelFor(count, 1, [&](std::size_t begin, std::size_t end) {
      for (std::size_t i = begin; i < end; ++i) {
        const std::uint32_t room = o.first_room + done + static_cast<std::uint32_t>(i);
        bytes[i].reserve(kSamplesPerRoom * kSampleBytes);
        for (const auto& sample : drawSamples(o.seed, room)) appendBytes(sample, bytes[i]);
      }
    });
    for (const auto& room : bytes) {
      if (std::fwrite(room.data(), 1, room.size(), stdout) != room.size()) {
        throw InputError("stdout: cannot be written, expected a pipe or file that takes all");
      }
    }
  }
  return std::fflush(stdout) == 0 ? 0 : 1;
}

}  // namespace

int main(int argc, char** argv) {
  CommandLine app{
      "Writes training pictures for the person model to stdout: simulated depth, people, joints.",
      "posefusion_person_data"};
  Options options;
  addOptions(app, options);
  return pf::runTool(app, argc, argv, [&] { return stream(options); });
}
