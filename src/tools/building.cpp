// SPDX-License-Identifier: BSD-3-Clause
#include "building.hpp"

#include <algorithm>
#include <cstdint>

#include "posefusion/core/error.hpp"
#include "posefusion/core/stamps.hpp"
#include "posefusion/frame/flow.hpp"
#include "posefusion/map/surfel_map.hpp"
#include "posefusion/slam/mapper.hpp"

namespace pf {
namespace {

constexpr int kRooms = 9;  // copies in a row
constexpr double kBetweenRooms_m = 0.5;

/// Where copy `number` of `count` stands; the last stands where the room is.
Eigen::Vector3d placeOf(int number, int count, const Eigen::Vector3d& size_m) {
  const int from_last = count - 1 - number;
  return {size_m.x() * (from_last % kRooms), 0, -size_m.z() * (from_last / kRooms)};
}

void addSurfels(const MappedRoom& room, const Eigen::Vector3d& at, int first_frame,
                SurfelArrays& all) {
  const std::size_t begin = all.size();
  all.append(room.stable);
  for (std::size_t i = begin; i < all.size(); ++i) {
    all.x[i] += static_cast<float>(at.x());
    all.z[i] += static_cast<float>(at.z());
    all.created[i] += first_frame;
    all.seen[i] += first_frame;
  }
}

void addKeyframes(const MappedRoom& room, const Eigen::Vector3d& at, int first_frame,
                  std::size_t count, SavedMap& map) {
  for (std::size_t k = 0; k < count; ++k) {
    const std::size_t frame = k * room.poses.size() / count;
    Keyframe keyframe;
    keyframe.id = static_cast<int>(map.keyframes.size());
    keyframe.map_frame = first_frame + static_cast<std::int32_t>(frame);
    keyframe.stamp_ns = static_cast<std::int64_t>(keyframe.map_frame) * kSecond_ns / 30;
    keyframe.T_map_camera = Eigen::Translation3d(at) * room.poses[frame].T_world_camera;
    map.keyframes.push_back(keyframe);
    if (keyframe.id == 0) continue;
    PoseConstraint step;
    step.kind = ConstraintKind::odometry;
    step.from = keyframe.id - 1;
    step.to = keyframe.id;
    const Keyframe& before = map.keyframes[map.keyframes.size() - 2];
    step.T_from_to = before.T_map_camera.inverse() * keyframe.T_map_camera;
    step.covariance = 4e-4 * Matrix6d::Identity();
    map.constraints.push_back(step);
  }
}

}  // namespace

MappedRoom mapRoom(const std::vector<RgbdFrame>& frames, const Config& config) {
  Mapper mapper(config);
  FlowTracker flow;
  for (const RgbdFrame& frame : frames) {
    mapper.process({frame, cv::Mat(), flow.advance(frame)});
    mapper.takeQuestion();
  }
  MappedRoom room;
  room.saved = mapper.saved(frames.back().camera);
  room.poses = mapper.backEnd().trajectory();
  Eigen::AlignedBox3f bounds;
  mapper.map().forEachSurfel([&](const SurfelArrays& s, std::size_t i) {
    const auto index = static_cast<std::uint32_t>(i);
    if (!mapper.map().isStable(s, i)) return;
    room.stable.append(s, &index, 1);
    bounds.extend(Eigen::Vector3f(s.x[i], s.y[i], s.z[i]));
  });
  if (room.stable.size() == 0) throw InputError("the recording gives no stable surfels");
  room.size_m = bounds.sizes().cast<double>().array() + kBetweenRooms_m;
  return room;
}

SavedMap buildingOf(const MappedRoom& room, std::size_t surfels, std::size_t keyframes) {
  SavedMap map = room.saved;
  map.keyframes.clear();
  map.constraints.clear();
  map.frames.clear();
  map.views.clear();
  const auto copies = static_cast<int>(std::max<std::size_t>(1, surfels / room.stable.size()));
  SurfelArrays all;
  for (int n = 0; n < copies; ++n) {
    const Eigen::Vector3d at = placeOf(n, copies, room.size_m);
    const int first_frame = n * (room.saved.frame + 1);
    addSurfels(room, at, first_frame, all);
    addKeyframes(room, at, first_frame, keyframes / static_cast<std::size_t>(copies), map);
  }
  map.surfels = {{kFirstFragment, std::move(all)}};
  map.frame = copies * (room.saved.frame + 1) - 1;
  return map;
}

}  // namespace pf
