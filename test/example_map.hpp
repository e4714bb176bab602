// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string>

#include "posefusion/io/map_database.hpp"
#include "temporary_folder.hpp"

namespace pf {

/// A map with something of everything: two keyframes with images, a loop, a trajectory, a wall of
/// stable surfels in several blocks made by frames 0 to 9.
struct ExampleMap {
  SurfelMap map{MapConfig{}};
  MapUpdate update;

  ExampleMap() {
    SurfelArrays s;
    s.resize(4000);
    for (std::size_t i = 0; i < s.size(); ++i) {
      s.x[i] = 0.03F * static_cast<float>(i % 80) - 1.2F;
      s.y[i] = 0.03F * static_cast<float>(i / 80) - 0.7F;
      s.z[i] = 2.0F;
      s.nz[i] = -1.0F;
      s.r[i] = s.g[i] = s.b[i] = static_cast<float>(i % 256);
      s.radius[i] = 0.02F;
      s.weight[i] = 20;
      s.odds[i] = 20 * static_odds::kFrame;
      s.created[i] = s.seen[i] = static_cast<std::int32_t>(i / 400);
    }
    map.restore({{kFirstFragment, s}}, 9);
    addContent();
    update.block_count = static_cast<std::uint32_t>(map.blocks().size());
    update.blocks = changedBlocks(map, -1);
  }

 private:
  void addContent() {
    update.camera.width = 32;
    update.camera.height = 24;
    update.camera.fx = update.camera.fy = 26;
    update.camera.cx = 15.5;
    update.camera.cy = 11.5;
    update.camera.distortion = {0.1, -0.2, 0.01, 0.02, 0.03};
    update.settings = "tracking:\n  max_iterations: 12\n";
    update.brightness.gain = 1.25F;
    update.brightness.offset = -3.0F;
    update.frame = 9;
    update.graph_version = 1;
    for (int i = 0; i < 2; ++i) {
      Keyframe k;
      k.id = i;
      k.stamp_ns = 1'000'000'000'000LL + i;
      k.map_frame = 5 * i;
      Vector6d twist;
      twist << 0.5 * i, 0.1, 0, 0, 0.2 * i, 0.1;
      k.T_map_camera = expSe3(twist);
      update.keyframes.push_back(k);
      KeyframeImages images;
      images.keyframe = i;
      images.grey = cv::Mat(24, 32, CV_8UC1, cv::Scalar(50 + i));
      images.depth_mm = cv::Mat(24, 32, CV_16UC1, cv::Scalar(2000 + i));
      update.images.push_back(images);
    }
    for (const auto kind : {ConstraintKind::odometry, ConstraintKind::loop}) {
      PoseConstraint c;
      c.from = 0;
      c.to = 1;
      c.kind = kind;
      c.T_from_to = update.keyframes[0].T_map_camera.inverse() * update.keyframes[1].T_map_camera;
      c.covariance = 1e-4 * Matrix6d::Identity();
      update.constraints.push_back(c);
    }
    for (int i = 0; i < 10; ++i) {
      FrameRecord frame;
      frame.stamp_ns = 1'000'000'000'000LL + i * 33'000'000LL;
      frame.pose.keyframe = i / 5;
      frame.pose.T_keyframe_camera.translation().x() = 0.01 * i;
      update.frames.push_back(frame);
    }
    update.blobs = {{"ferns", std::string("\0\1\2", 3)}, {"empty", ""}};
  }
};

/// A new map file with this in it; returns its path.
inline std::string saved(const TemporaryFolder& folder, const MapUpdate& update,
                         const std::string& name = "map.pfdb") {
  MapWriter(folder / name, MapWriter::Mode::create).write(update);
  return folder / name;
}

/// All that a map file holds.
inline void readAll(const std::string& path) {
  const MapReader reader(path);
  const MapContent content = reader.content();
  reader.surfels();
  for (const Keyframe& k : content.keyframes) reader.images(k.id);
}

}  // namespace pf
