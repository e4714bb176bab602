// SPDX-License-Identifier: BSD-3-Clause
#include "simulator/furniture.hpp"

#include <functional>
#include <map>

#include "posefusion/core/error.hpp"
#include "simulator/furniture_parts.hpp"

namespace pf::simulator {
namespace {

using Eigen::Vector3f;

/// How a kind is made, its usual size and material, and whether it stands in the way.
struct Kind {
  void (*add)(const Part&);
  Vector3f size;
  const char* texture;
  bool stands;
};

const std::map<std::string, Kind>& kinds() {
  static const std::map<std::string, Kind> map = {
      {"table", {addTable, {0.8F, 1.6F, 0.73F}, "board", true}},
      {"desk", {addDesk, {0.8F, 1.6F, 0.73F}, "board", true}},
      {"chair", {addChair, {0.46F, 0.46F, 0.86F}, "wood", true}},
      {"office_chair", {addOfficeChair, {0.52F, 0.52F, 0.95F}, "cloth", true}},
      {"sofa", {addSofa, {0.85F, 1.8F, 0.8F}, "cloth", true}},
      {"shelf", {addShelf, {0.3F, 0.9F, 1.8F}, "board", true}},
      {"cabinet", {addCabinet, {0.5F, 0.8F, 1.1F}, "panel", true}},
      {"box", {addPlainBox, {0.4F, 0.4F, 0.35F}, "carton", true}},
      {"stack", {addStack, {0.45F, 0.45F, 1.1F}, "carton", true}},
      {"plant", {addPlant, {0.5F, 0.5F, 1.3F}, "leaves", true}},
      {"bin", {addBin, {0.3F, 0.3F, 0.35F}, "plastic", true}},
      {"pillar", {addPillar, {0.35F, 0.35F, 2.7F}, "concrete", true}},
      {"partition", {addPlainBox, {0.06F, 1.6F, 1.5F}, "cloth", true}},
      {"stool", {addStool, {0.36F, 0.36F, 0.47F}, "wood", true}},
      {"slat_chair", {addSlatChair, {0.46F, 0.46F, 0.92F}, "wood", true}},
      {"armchair", {addArmchair, {0.75F, 0.75F, 0.95F}, "cloth", true}},
      {"coat_rack", {addCoatRack, {0.6F, 0.6F, 1.75F}, "cloth", true}},
      {"lamp", {addLamp, {0.35F, 0.35F, 1.6F}, "plastic", true}},
      {"curtain", {addCurtain, {0.1F, 1.4F, 2.2F}, "cloth", false}},
      {"bag", {addBag, {0.2F, 0.32F, 0.45F}, "cloth", true}},
      {"stairs", {addStairs, {0.84F, 1.6F, 0.68F}, "concrete", true}},
      {"trolley", {addTrolley, {0.75F, 0.48F, 0.95F}, "metal", true}},
      {"monitor", {addMonitor, {0.2F, 0.52F, 0.42F}, "screen", false}},
      {"clutter", {addClutter, {0.5F, 0.8F, 0.25F}, "plastic", false}},
      {"poster", {addHanging, {0.006F, 0.6F, 0.85F}, "poster", false}},
      {"photo", {addHanging, {0.025F, 0.7F, 0.5F}, "photo", false}},
      {"whiteboard", {addHanging, {0.025F, 1.6F, 1.0F}, "whiteboard", false}},
      {"window", {addWindow, {0.04F, 1.4F, 1.3F}, "view", false}},
      {"door", {addHanging, {0.045F, 0.92F, 2.05F}, "door", false}},
      {"radiator", {addRadiator, {0.1F, 1.1F, 0.55F}, "metal", false}}};
  return map;
}

}  // namespace

std::vector<std::string> objectKinds() {
  std::vector<std::string> names;
  for (const auto& entry : kinds()) names.push_back(entry.first);
  return names;
}

void addObject(World& world, const ObjectSpec& spec) {
  const auto it = kinds().find(spec.kind);
  if (it == kinds().end()) {
    std::string known;
    for (const auto& word : objectKinds()) known += (known.empty() ? "" : ", ") + word;
    throw InputError("object '" + spec.kind + "' is unknown, expected one of " + known);
  }
  const Kind& kind = it->second;
  Dice dice(spec.seed);
  const Vector3f at = spec.at_m.cast<float>();
  const Vector3f size = spec.size_m ? Vector3f(spec.size_m->cast<float>()) : kind.size;
  const Vector3f tint = spec.color ? Vector3f(spec.color->cast<float>()) : Vector3f::Ones();
  const Part part{world, placed(at.x(), at.y(), at.z(), static_cast<float>(spec.yaw_rad)),
                  size,  spec.texture.empty() ? kind.texture : spec.texture,
                  tint,  dice};
  kind.add(part);
  if (kind.stands && at.z() < 0.4F) {
    const Eigen::Vector2d half = 0.5 * size.head<2>().cast<double>();
    world.footprints.push_back({spec.at_m.head<2>(), half, spec.yaw_rad});
  }
}

}  // namespace pf::simulator
