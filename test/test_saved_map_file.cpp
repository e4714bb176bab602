// SPDX-License-Identifier: BSD-3-Clause
// A map that is saved and gone on in: mapper, loop closer and file together.
#include "posefusion/io/saved_map_file.hpp"

#include <gtest/gtest.h>
#include <sys/resource.h>

#include <algorithm>
#include <csignal>
#include <filesystem>
#include <thread>

#include "posefusion/core/error.hpp"
#include "posefusion/core/stamps.hpp"
#include "posefusion/slam/loop_thread.hpp"
#include "program.hpp"
#include "simulated_sequence.hpp"
#include "simulator/output.hpp"
#include "simulator/scenario.hpp"
#include "simulator/simulation.hpp"
#include "temporary_folder.hpp"

namespace pf {
namespace {

namespace fs = std::filesystem;
constexpr int kMapped = 40, kElsewhere = 75, kFrames = 120;

Config config() {
  Config c;
  c.frame.shrink = 1;                  // the images are small already
  c.graph.keyframe_distance_m = 0.05;  // so that there are some
  return c;
}

const SimulatedSequence& room() { return exactBox<kFrames>(); }

bool equal(SurfelArrays a, const SurfelArrays& b) {
  bool same = true;
  a.forEachArray(b, [&](const auto& x, const auto& y) { same = same && x == y; });
  return same;
}

/// A mapper with its loop closer.
struct Session {
  Mapper mapper{config()};
  LoopThread closer{config().loop, config().tracking, AnswerTime::after_lag};

  FrameStatus process(int index) {
    const FrameStatus status = mapper.process({room().frame(index).frame, {}, {}});
    closer.serve(mapper);
    return status;
  }
  /// Runs frames and tells how many poses are right (2 cm); a pose that is wrong fails.
  int follow(int begin, int end) {
    int right = 0;
    for (int i = begin; i < end; ++i) {
      const FrameStatus status = process(i);
      if (!status.located) continue;
      const double error =
          (status.T_map_camera.translation() - room().pose(i).translation()).norm();
      EXPECT_LT(error, 0.02) << "frame " << i;
      ++right;
    }
    closer.finish(mapper);
    return right;
  }
  void save(const std::string& path, MapWriter::Mode mode = MapWriter::Mode::create) {
    MapRecording recording(path, mode, toYaml(config()), mapper);
    EXPECT_EQ(recording.update(room().frame(0).frame.camera, mapper), "");
    EXPECT_TRUE(recording.finish(mapper));
  }
};

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
  const Mapper& mapper = session.mapper;
  session.save(own / "map.pfdb");
  const SavedMap saved = readSavedMap(own / "map.pfdb");
  EXPECT_TRUE(equal(saved.surfels, mapper.map().collect()));
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
  EXPECT_TRUE(equal(more.surfels, session.mapper.map().collect()));
  EXPECT_EQ(more.frames.size(), session.mapper.backEnd().frames().size());
  EXPECT_EQ(more.views.size(), graph.keyframes().size());
  EXPECT_EQ(more.constraints.size(), graph.constraints().size());
}

TEST_F(SavedMapFile, LocalisingAloneChangesNothing) {
  const std::string path = copy(), before = readFile(path);
  Session session;
  session.mapper.load(readSavedMap(path), MapUse::localize_only);
  const SurfelArrays surfels = session.mapper.map().collect();
  EXPECT_GT(session.follow(kElsewhere, kFrames), kFrames - kElsewhere - 18);
  EXPECT_TRUE(equal(surfels, session.mapper.map().collect()));
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

TEST_F(SavedMapFile, AFullDiskIsMadeUpForByTheNextWrite) {
  Session session;
  const std::string path = own / "map.pfdb";
  {
    MapRecording recording(path, MapWriter::Mode::create, "", session.mapper);
    EXPECT_FALSE(recording.finish(session.mapper)) << "there is no map yet";
    const PinholeCamera camera = room().frame(0).frame.camera;
    for (int i = 0; i < kMapped / 2; ++i) {
      session.process(i);
      EXPECT_EQ(recording.update(camera, session.mapper), "");
    }
    rlimit before{};
    getrlimit(RLIMIT_FSIZE, &before);
    signal(SIGXFSZ, SIG_IGN);
    rlimit full = before;
    full.rlim_cur = 100'000;
    setrlimit(RLIMIT_FSIZE, &full);
    std::string error;
    for (int i = 0; i < 200 && error.empty(); ++i) {
      std::this_thread::sleep_for(std::chrono::milliseconds(20));
      error = recording.update(camera, session.mapper);
    }
    setrlimit(RLIMIT_FSIZE, &before);
    EXPECT_NE(error.find(path + ": cannot be read or written"), std::string::npos) << error;
    session.follow(kMapped / 2, kMapped);
    session.closer.finish(session.mapper);
    EXPECT_TRUE(recording.finish(session.mapper));
  }
  const SavedMap saved = readSavedMap(path);
  EXPECT_TRUE(equal(saved.surfels, session.mapper.map().collect()));
  EXPECT_EQ(saved.frames.size(), static_cast<std::size_t>(kMapped));
}

TEST_F(SavedMapFile, ARecordingGoesOnAfterItWasFinished) {
  Session session;
  const std::string path = own / "map.pfdb";
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
  EXPECT_TRUE(equal(saved.surfels, session.mapper.map().collect()));
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
  Mapper mapper(config());
  EXPECT_NE(errorOf([&] { mapper.load(SavedMap{}, MapUse::extend); }), "");
}

/// The program as a user runs it.
class MapOptions : public testing::Test {
 protected:
  static void SetUpTestSuite() {
    folder_ = new TemporaryFolder;
    simulator::ScenarioChanges changes;
    changes.duration_s = 1.0;
    simulator::Simulation simulation(simulator::loadScenario("box_walker", changes));
    const auto output = simulator::openTumOutput(*folder_ / "sequence", simulation);
    for (int i = 0; i < simulation.frameCount(); ++i) output->add(simulation.frame(i));
    output->finish(simulation);
  }
  static void TearDownTestSuite() { delete folder_; }

  static std::string sequence() { return *folder_ / "sequence"; }
  std::vector<std::string> with(std::vector<std::string> more) const {
    more.insert(more.begin(), {sequence(), "--detector", "recorded", "--set", "frame.shrink=1"});
    return more;
  }
  int run(const std::vector<std::string>& arguments, const std::string& name = "posefusion_run") {
    const Program program(name, arguments, own / "log.txt");
    const int code = program.exitCode();
    said = program.said();
    return code;
  }

  TemporaryFolder own;
  std::string said;

 private:
  static TemporaryFolder* folder_;
};
TemporaryFolder* MapOptions::folder_ = nullptr;

TEST_F(MapOptions, ARunGoesOnInTheMapOfAnother) {
  const std::string out = own / "out", map = out + "/map.pfdb";
  ASSERT_EQ(run(with({"--output", out})), 0) << said;
  ASSERT_EQ(run({"check", map}, "posefusion_map"), 0) << said;
  EXPECT_FALSE(fs::exists(out + "/map.partial.pfdb"));
  const std::string before = readFile(map);
  const std::size_t frames = readSavedMap(map).frames.size();

  ASSERT_EQ(run(with({"--output", own / "l", "--map", map, "--localize-only"})), 0) << said;
  EXPECT_TRUE(readFile(map) == before);
  EXPECT_FALSE(fs::exists(own / "l/map.pfdb"));
  EXPECT_NE(said.find("0 bad"), std::string::npos) << said;
  EXPECT_NE(said.find("ATE"), std::string::npos) << said;

  ASSERT_EQ(run(with({"--output", own / "m", "--map", map})), 0) << said;
  EXPECT_TRUE(readFile(map) == before);
  EXPECT_GT(readSavedMap(own / "m/map.pfdb").frames.size(), frames);

  ASSERT_EQ(run(with({"--output", own / "c", "--map", map, "--continue"})), 0) << said;
  EXPECT_FALSE(fs::exists(own / "c/map.pfdb"));
  EXPECT_EQ(readSavedMap(map).frames.size(), readSavedMap(own / "m/map.pfdb").frames.size());
  EXPECT_TRUE(equal(readSavedMap(map).surfels, readSavedMap(own / "m/map.pfdb").surfels));
}

TEST_F(MapOptions, AKilledRunLeavesAWholeMap) {
  const std::string out = own / "out", partial = out + "/map.partial.pfdb";
  // The same frames over and over: enough for minutes.
  const std::string input = own / "long";
  fs::copy(sequence(), input, fs::copy_options::recursive);
  const auto first = [&](const std::string& kind) {
    return kind + "/" + fs::directory_iterator(input + "/" + kind)->path().filename().string();
  };
  const std::string color = first("rgb"), depth = first("depth");
  std::string list;
  for (int i = 0; i < 20000; ++i) {
    const std::string stamp = formatStamp(1'000'000'000LL + i * 33'000'000LL);
    list += stamp + " " + color + " " + stamp + " " + depth + "\n";
  }
  own.write("long/associations.txt", list);
  const Program program("posefusion_run", {input, "--detector", "none", "--output", out},
                        own / "run.txt");
  // SQLite's file is there before the first write, its log grows with it.
  for (int i = 0; i < 600; ++i) {
    std::error_code none;
    if (fs::file_size(partial + "-wal", none) > 300'000 && !none) break;
    std::this_thread::sleep_for(std::chrono::milliseconds(50));
  }
  std::this_thread::sleep_for(std::chrono::milliseconds(300));
  program.send(SIGKILL);
  EXPECT_EQ(program.exitCode(), -SIGKILL) << program.said();
  ASSERT_EQ(run({"check", partial}, "posefusion_map"), 0) << said;
  EXPECT_GT(readSavedMap(partial).frames.size(), 0U);
  // The next run keeps it under another name.
  ASSERT_EQ(run(with({"--output", out, "--max-frames", "3"})), 0) << said;
  EXPECT_EQ(run({"check", partial + ".old"}, "posefusion_map"), 0) << said;
}

TEST_F(MapOptions, ABadMapIsRefusedBeforeAnythingRuns) {
  const std::string out = own / "out", bad = own.write("bad.pfdb", std::string(5000, 'x'));
  EXPECT_EQ(run(with({"--output", out, "--map", bad})), 1);
  EXPECT_NE(said.find(bad + ": is no map of posefusion"), std::string::npos) << said;
  EXPECT_EQ(run(with({"--output", out, "--map", own / "none"})), 1);
  EXPECT_NE(said.find("none: cannot be opened"), std::string::npos) << said;
  EXPECT_NE(run(with({"--output", out, "--localize-only"})), 0);
  EXPECT_NE(run(with({"--output", out, "--map", bad, "--localize-only", "--continue"})), 0);
  ASSERT_EQ(run(with({"--output", own / "m", "--max-frames", "3"})), 0) << said;
  const std::string map = own / "m/map.pfdb";
  const std::string camera = own.write(
      "camera.yaml",
      "width: 320\nheight: 240\nfx: 200\nfy: 200\ncx: 160\ncy: 120\ndepth_factor: 5000\n");
  EXPECT_EQ(run(with({"--output", out, "--map", map, "--camera", camera})), 1);
  EXPECT_NE(said.find(map + ": is a map of another camera"), std::string::npos) << said;
  EXPECT_FALSE(fs::exists(out));
}

}  // namespace
}  // namespace pf
