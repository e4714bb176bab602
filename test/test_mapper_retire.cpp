// SPDX-License-Identifier: BSD-3-Clause
// Keyframes of a camera that goes to and fro: what the mapper and a file keep of them.
#include "mapper_scene.hpp"
#include "posefusion/io/saved_map_file.hpp"
#include "posefusion/map/surfel_map.hpp"
#include "temporary_folder.hpp"

namespace pf {
namespace {

constexpr int kWay = 30, kPasses = 6;

class MapperRetireTest : public MapperTest {
 protected:
  static Config config() {
    Config c = MapperTest::config();
    c.graph.keyframe_distance_m = c.graph.keyframe_angle_rad = 0.01;
    c.graph.keyframes_at_a_place = 2;
    return c;
  }

  FrameStatus see(Mapper& mapper, int index) {
    StaticFrame input{room().frame(index).frame, cv::Mat(), {}};
    input.frame.stamp_ns = stamp_ns_ += 33'333'333;
    const FrameStatus status = mapper.process(input);
    if (auto question = mapper.takeQuestion()) questions_.push_back(std::move(*question));
    return status;
  }

  void walk(Mapper& mapper) {
    for (int i = 0; i < kPasses * kWay; ++i) {
      const int at = i % (2 * kWay);
      see(mapper, at < kWay ? at : 2 * kWay - 1 - at);
    }
  }

  /// Each keyframe sees what the nearest of long before saw.
  static LoopAnswer loops(const Mapper& mapper) {
    LoopAnswer answer;
    const BackEnd& back_end = mapper.backEnd();
    const auto& keyframes = back_end.graph().keyframes();
    for (const Keyframe& k : keyframes) {
      const int old = back_end.nearest({k.fragment, k.T_map_camera}, k.id - 10);
      if (old < 0) continue;
      const Keyframe& from = keyframes[static_cast<std::size_t>(old)];
      answer.loops.push_back({from.id, k.id, from.T_map_camera.inverse() * k.T_map_camera,
                              1e-6 * Matrix6d::Identity()});
    }
    return answer;
  }

  std::int64_t stamp_ns_ = 0;
  std::vector<LoopQuestion> questions_;
};

TEST_F(MapperRetireTest, PicturesGoEverywhereAndPosesStay) {
  Mapper mapper(config());
  walk(mapper);
  const std::size_t keyframes = mapper.keyframeViews().size();
  ASSERT_GT(keyframes, 120U) << "the test needs more than the latest";
  const Trajectory before = mapper.backEnd().trajectory();
  const TemporaryFolder folder;
  auto recording =
      std::make_unique<MapRecording>(folder / "map.pfdb", MapWriter::Mode::create, "", mapper);
  recording->update(room().frame(0).frame.camera, mapper);
  mapper.take(loops(mapper));
  mapper.settle();
  const std::size_t left = mapper.keyframeViews().size();
  ASSERT_LT(left, keyframes);
  EXPECT_EQ(mapper.backEnd().graph().keyframes().size(), keyframes);
  for (const KeyframeView& view : mapper.keyframeViews()) {
    EXPECT_FALSE(
        mapper.backEnd().graph().keyframes()[static_cast<std::size_t>(view.id)].isRetired());
  }
  const Trajectory after = mapper.backEnd().trajectory();
  ASSERT_EQ(after.size(), before.size());
  for (std::size_t i = 0; i < after.size(); ++i) {
    EXPECT_TRUE(after[i].T_world_camera.isApprox(before[i].T_world_camera, 0.01)) << i;
  }
  // The closer gets it with the next keyframe, and so does a file.
  questions_.clear();
  for (int i = 0; i < kWay && questions_.empty(); ++i) see(mapper, i);
  ASSERT_FALSE(questions_.empty());
  EXPECT_EQ(questions_.front().retired.size(), keyframes - left);
  EXPECT_TRUE(recording->finish(mapper));
  recording.reset();
  EXPECT_EQ(MapReader(folder / "map.pfdb").counts().images, mapper.keyframeViews().size());
  Mapper again(config());
  again.load(readSavedMap(folder / "map.pfdb"), MapUse::extend);
  EXPECT_EQ(again.keyframeViews().size(), mapper.keyframeViews().size());
  EXPECT_EQ(again.backEnd().nearest({0, after.back().T_world_camera}),
            mapper.backEnd().nearest({0, after.back().T_world_camera}));
}

}  // namespace
}  // namespace pf
