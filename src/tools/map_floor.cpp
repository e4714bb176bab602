// SPDX-License-Identifier: BSD-3-Clause
#include "map_floor.hpp"

#include "map_surfels.hpp"
#include "posefusion/core/error.hpp"

namespace pf {

FloorMap readFloorMap(const std::string& file) {
  try {
    const MapReader reader(file);
    const MapContent content = reader.content();
    const SurfelMap map = mapOf(reader, content, file);
    return floorMapOf({map, content.camera, content.keyframes, worldOf(content)});
  } catch (const InputError& error) {
    const std::string text = error.what();
    throw InputError(text.rfind(file, 0) == 0 ? text : file + ": " + text);
  }
}

}  // namespace pf
