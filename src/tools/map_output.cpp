// SPDX-License-Identifier: BSD-3-Clause
#include "map_output.hpp"

#include <filesystem>

#include "posefusion/core/error.hpp"
#include "posefusion/io/saved_map_file.hpp"

namespace pf {
namespace {

/// What a map is called until it is whole.
std::string partialOf(const std::string& output) { return output + ".part"; }

}  // namespace

void requireNew(const std::string& output) {
  for (const std::string& name : {output, partialOf(output)}) {
    if (!std::filesystem::exists(name)) continue;
    throw InputError(name + ": is there already, expected the name of a new map");
  }
}

void writeMap(const Mapper& mapper, const PinholeCamera& camera, const Config& settings,
              const std::string& output) {
  const std::string partial = partialOf(output);
  try {
    {
      MapRecording recording(partial, MapWriter::Mode::create, toYaml(settings), mapper);
      recording.update(camera, mapper);
      recording.finish(mapper);
    }
    renameMapFile(partial, output);
  } catch (const InputError&) {
    std::error_code ignored;
    std::filesystem::remove(partial, ignored);
    throw;
  }
}

}  // namespace pf
