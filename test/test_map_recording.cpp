// SPDX-License-Identifier: BSD-3-Clause
// A map file that is written while the map grows.
#include <gtest/gtest.h>

#include <chrono>
#include <thread>

#include "full_disk.hpp"
#include "posefusion/io/saved_map_file.hpp"
#include "saved_map_scene.hpp"
#include "temporary_folder.hpp"

namespace pf {
namespace {

using namespace saved_map_scene;

TEST(MapRecording, AFullDiskIsMadeUpForByTheNextWrite) {
  const TemporaryFolder folder;
  Session session;
  const std::string path = folder / "map.pfdb";
  {
    MapRecording recording(path, MapWriter::Mode::create, "", session.mapper);
    EXPECT_FALSE(recording.finish(session.mapper)) << "there is no map yet";
    const PinholeCamera camera = room().frame(0).frame.camera;
    for (int i = 0; i < kMapped / 2; ++i) {
      session.process(i);
      EXPECT_EQ(recording.update(camera, session.mapper), "");
    }
    std::string error;
    {
      const FullDisk full(100'000);
      for (int i = 0; i < 200 && error.empty(); ++i) {
        std::this_thread::sleep_for(std::chrono::milliseconds(20));
        error = recording.update(camera, session.mapper);
      }
    }
    EXPECT_NE(error.find(path + ": cannot be read or written"), std::string::npos) << error;
    session.follow(kMapped / 2, kMapped);
    session.closer.finish(session.mapper);
    EXPECT_TRUE(recording.finish(session.mapper));
  }
  const SavedMap saved = readSavedMap(path);
  EXPECT_TRUE(equal(saved.surfels, session.mapper.map().parts()));
  EXPECT_EQ(saved.frames.size(), static_cast<std::size_t>(kMapped));
}

TEST(MapRecording, ARecordingGoesOnAfterItWasFinished) {
  const TemporaryFolder folder;
  Session session;
  const std::string path = folder / "map.pfdb";
  {
    MapRecording recording(path, MapWriter::Mode::create, "", session.mapper);
    for (const int end : {5, 10}) {
      session.follow(end - 5, end);
      recording.update(room().frame(0).frame.camera, session.mapper);
      EXPECT_TRUE(recording.finish(session.mapper));
    }
  }
  const SavedMap saved = readSavedMap(path);
  EXPECT_EQ(saved.frames.size(), 10U);
  EXPECT_TRUE(equal(saved.surfels, session.mapper.map().parts()));
}

}  // namespace
}  // namespace pf
