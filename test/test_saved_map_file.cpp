// SPDX-License-Identifier: BSD-3-Clause
// A map that is saved and continued: mapper, loop closer and file together.
#include "posefusion/io/saved_map_file.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <filesystem>

#include "first_map_version.hpp"
#include "posefusion/core/error.hpp"
#include "posefusion/io/files.hpp"
#include "saved_map_scene.hpp"
#include "temporary_folder.hpp"

namespace pf {
namespace {

namespace fs = std::filesystem;
using namespace saved_map_scene;

class SavedMapFile : public testing::Test {
 protected:
  static void SetUpTestSuite() {
    folder_ = new TemporaryFolder;
    Session session;
    session.follow(0, kMapped);
    session.save(*folder_ / "map.pfdb");
  }
  static void TearDownTestSuite() { delete folder_; }

  std::string copy() const {
    fs::copy(*folder_ / "map.pfdb", own / "map.pfdb");
    return own / "map.pfdb";
  }

  TemporaryFolder own;

 private:
  static TemporaryFolder* folder_;
};
TemporaryFolder* SavedMapFile::folder_ = nullptr;

TEST_F(SavedMapFile, GivesBackWhatAMapperHas) {
  Session session;
  session.follow(0, kMapped);
  Mapper& mapper = session.mapper;
  EXPECT_FALSE(mapper.placed());
  EXPECT_TRUE(mapper.worldFromMap().isApprox(bodyFromOptical()));
  const Eigen::Isometry3d T_world_map = Eigen::Translation3d(1, 2, 3) * bodyFromOptical();
  mapper.place(T_world_map);
  session.save(own / "map.pfdb");
  const SavedMap saved = readSavedMap(own / "map.pfdb");
  ASSERT_TRUE(saved.T_world_map);
  EXPECT_EQ(saved.T_world_map->matrix(), T_world_map.matrix());
  EXPECT_TRUE(equal(saved.surfels, mapper.map().parts()));
  EXPECT_EQ(saved.frame, mapper.map().frame());
  EXPECT_EQ(saved.frames.size(), mapper.backEnd().frames().size());
  EXPECT_EQ(saved.brightness.gain, mapper.brightness().gain);
  ASSERT_GE(saved.keyframes.size(), 2U);
  ASSERT_EQ(saved.views.size(), saved.keyframes.size());
  for (std::size_t i = 0; i < saved.views.size(); ++i) {
    const KeyframeView& a = saved.views[i];
    const KeyframeView& b = mapper.keyframeViews()[i];
    EXPECT_EQ(a.id, b.id);
    EXPECT_EQ(a.nobody_in_view, b.nobody_in_view);
    EXPECT_EQ(cv::norm(a.intensity, b.intensity, cv::NORM_INF), 0);
    EXPECT_EQ(cv::norm(a.depth_mm, b.depth_mm, cv::NORM_INF), 0);
    EXPECT_EQ(cv::norm(a.thumbnail.color, b.thumbnail.color, cv::NORM_INF), 0);
    EXPECT_EQ(cv::norm(a.thumbnail.depth_m, b.thumbnail.depth_m, cv::NORM_INF), 0);
  }
}

TEST_F(SavedMapFile, PicturesOfAnotherShrinkAreTakenOver) {
  for (const int shrink : {2, 4}) {
    Config coarse = config();
    coarse.frame.shrink = shrink;
    Mapper mapper(coarse);
    const SavedMap saved = readSavedMap(copy());
    mapper.load(saved, MapUse::extend);
    const PinholeCamera camera = saved.camera.shrunk(shrink);
    ASSERT_EQ(mapper.keyframeViews().size(), saved.keyframes.size());
    for (const KeyframeView& view : mapper.keyframeViews()) {
      EXPECT_EQ(view.intensity.size(), cv::Size(camera.width, camera.height));
      EXPECT_EQ(view.depth_mm.size(), view.intensity.size());
      EXPECT_TRUE(view.camera == camera);
      EXPECT_GT(cv::countNonZero(view.depth_mm), camera.width * camera.height / 2);
    }
    // And back, into a session of full size.
    Mapper fine(config());
    SavedMap again = mapper.saved(saved.camera);
    fine.load(std::move(again), MapUse::extend);
    EXPECT_EQ(fine.keyframeViews().back().intensity.size(),
              cv::Size(saved.camera.width, saved.camera.height));
    fs::remove(own / "map.pfdb");
  }
}

TEST_F(SavedMapFile, AMapKeepsWhereItStands) {
  const Eigen::Isometry3d T_world_map = Eigen::Translation3d(1, 2, 3) * bodyFromOptical();
  Session session;
  session.mapper.load(readSavedMap(copy()), MapUse::extend);
  EXPECT_FALSE(session.mapper.placed()) << "made without a known place";
  session.mapper.place(T_world_map);
  Mapper again(config());
  again.load(session.mapper.saved(room().frame(0).frame.camera), MapUse::extend);
  ASSERT_TRUE(again.placed());
  EXPECT_EQ(again.worldFromMap().matrix(), T_world_map.matrix());
  again.reset();
  EXPECT_FALSE(again.placed()) << "another map";
}

TEST_F(SavedMapFile, ACameraElsewhereIsFoundAndTheMapGrows) {
  const std::string path = copy();
  Session session;
  session.mapper.load(readSavedMap(path), MapUse::extend);
  const auto keyframes = session.mapper.backEnd().graph().keyframes().size();
  const std::size_t surfels = session.mapper.map().size();
  EXPECT_EQ(session.mapper.skip(0, FrameOutcome::blurred).state, TrackingState::lost);
  EXPECT_GT((room().pose(kElsewhere).translation() - room().pose(kMapped).translation()).norm(),
            0.2);
  const FrameStatus first = session.process(kElsewhere);
  EXPECT_EQ(first.state, TrackingState::lost);
  EXPECT_FALSE(first.located);
  EXPECT_EQ(session.mapper.map().size(), surfels) << "nothing is fused before it is found";
  EXPECT_GT(session.follow(kElsewhere + 1, kFrames), kFrames - kElsewhere - 18);
  EXPECT_GT(session.mapper.map().size(), surfels);
  const auto& graph = session.mapper.backEnd().graph();
  ASSERT_GT(graph.keyframes().size(), keyframes);
  EXPECT_EQ(session.mapper.backEnd().trajectory().front().stamp_ns,
            session.mapper.backEnd().frames()[kMapped].stamp_ns)
      << "the trajectory is this session's";

  session.save(path, MapWriter::Mode::extend);
  const SavedMap more = readSavedMap(path);
  EXPECT_TRUE(equal(more.surfels, session.mapper.map().parts()));
  EXPECT_EQ(more.frames.size(), session.mapper.backEnd().frames().size());
  EXPECT_EQ(more.views.size(), graph.keyframes().size());
  EXPECT_EQ(more.constraints.size(), graph.constraints().size());
}

TEST_F(SavedMapFile, AMapOfVersion1GoesOnAsOneOfTheLatest) {
  const std::string path = copy();
  makeFirstVersion(path);
  Session session;
  session.mapper.load(readSavedMap(path), MapUse::extend);
  EXPECT_GT(session.follow(kElsewhere, kElsewhere + 25), 5);
  session.save(path, MapWriter::Mode::extend);
  const SavedMap more = readSavedMap(path);
  EXPECT_TRUE(equal(more.surfels, session.mapper.map().parts()));
  EXPECT_EQ(more.frames.size(), session.mapper.backEnd().frames().size());
  EXPECT_EQ(more.views.size(), session.mapper.backEnd().graph().keyframes().size());
}

TEST_F(SavedMapFile, LocalisingAloneChangesNothing) {
  const std::string path = copy(), before = readFile(path);
  Session session;
  session.mapper.load(readSavedMap(path), MapUse::localize_only);
  const auto surfels = session.mapper.map().parts();
  EXPECT_GT(session.follow(kElsewhere, kFrames), kFrames - kElsewhere - 18);
  EXPECT_TRUE(equal(surfels, session.mapper.map().parts()));
  EXPECT_EQ(session.mapper.map().frame(), kMapped - 1);
  EXPECT_EQ(session.mapper.backEnd().graph().version(), 0);
  EXPECT_TRUE(readFile(path) == before);
  EXPECT_GT(session.mapper.backEnd().trajectory().size(), 0U);
}

TEST_F(SavedMapFile, AFrameOfAnotherRoomIsNotFound) {
  Session session;
  session.mapper.load(readSavedMap(copy()), MapUse::extend);
  const std::size_t surfels = session.mapper.map().size();
  const SimulatedSequence other("empty_box", 25,
                                {"camera.at_m=[3.2,1.6,1.35]", "camera.look_at_m=[0.2,1.2,1.2]"});
  for (int i = 0; i < other.frameCount(); ++i) {
    EXPECT_FALSE(session.mapper.process({other.frame(i).frame, {}, {}}).located) << i;
    session.closer.serve(session.mapper);
  }
  EXPECT_EQ(session.mapper.map().size(), surfels);
}

TEST_F(SavedMapFile, WhatCannotBeUsedIsRefusedByItsName) {
  const std::string path = own / "x.pfdb";
  own.write("x.pfdb", "no map");
  EXPECT_EQ(errorOf([&] { readSavedMap(path); }), path + ": is no map of posefusion");
  fs::remove(path);
  const std::string whole = copy();
  MapContent content = MapReader(whole).content();
  MapUpdate update;
  static_cast<MapContent&>(update) = content;
  update.frames.clear();
  update.block_count = static_cast<std::uint32_t>(MapReader(whole).counts().blocks);
  update.blobs["keyframe/1"] = "short";
  MapWriter(whole, MapWriter::Mode::extend).write(update);
  EXPECT_EQ(errorOf([&] { readSavedMap(whole); }),
            whole + ": the small picture of keyframe 1 has 5 bytes, expected 33601");
  update.blobs["T_world_map"] = std::string(12 * sizeof(double), '\0');  // a rotation of zeros
  MapWriter(whole, MapWriter::Mode::extend).write(update);
  EXPECT_EQ(errorOf([&] { readSavedMap(whole); }),
            whole + ": where the map stands is no rigid motion");
  Mapper mapper(config());
  EXPECT_NE(errorOf([&] { mapper.load(SavedMap{}, MapUse::extend); }), "");
}

}  // namespace
}  // namespace pf
