// SPDX-License-Identifier: BSD-3-Clause
#include "map_refine.hpp"

#include <cstdio>
#include <filesystem>

#include "posefusion/core/error.hpp"
#include "posefusion/io/saved_map_file.hpp"

namespace pf {
namespace {

void write(const Mapper& mapper, const PinholeCamera& camera, const Config& config,
           const std::string& output) {
  const std::string partial = output + ".part";
  std::error_code ignored;
  std::filesystem::remove(partial, ignored);
  {
    MapRecording recording(partial, MapWriter::Mode::create, toYaml(config), mapper);
    recording.update(camera, mapper);
    recording.finish(mapper);
  }
  renameMapFile(partial, output);
}

}  // namespace

void refineMap(const std::string& file, const std::string& output) {
  if (std::filesystem::exists(output)) {
    throw InputError(output + ": is there already, expected the name of a new map");
  }
  const Config config = settingsOf(MapReader(file).content(), file);
  SavedMap map = readSavedMap(file);
  const PinholeCamera camera = map.camera;
  Mapper mapper(config);
  try {
    mapper.load(std::move(map), MapUse::extend);
  } catch (const InputError& error) {
    throw InputError(file + ": " + error.what());
  }
  const Mapper::Refinement done = mapper.refine();
  if (!done.reason.empty()) throw InputError(file + ": nothing to refine: " + done.reason);
  write(mapper, camera, config, output);
  std::printf("%s: %s\n", output.c_str(), done.text().c_str());
}

}  // namespace pf
