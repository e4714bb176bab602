// SPDX-License-Identifier: BSD-3-Clause
#include "map_refine.hpp"

#include <cstdio>

#include "map_output.hpp"
#include "posefusion/core/error.hpp"
#include "posefusion/io/saved_map_file.hpp"

namespace pf {

void refineMap(const std::string& file, const std::string& output) {
  requireNew(output);
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
  writeMap(mapper, camera, config, output);
  std::printf("%s: %s\n", output.c_str(), done.text().c_str());
}

}  // namespace pf
