// SPDX-License-Identifier: BSD-3-Clause
// The programs from the command line: exit codes, messages, files.
#include <gtest/gtest.h>

#include "posefusion/io/images.hpp"
#include "posefusion/io/map_file.hpp"
#include "posefusion/io/trajectory_file.hpp"
#include "tools_scene.hpp"

namespace pf {
namespace {

namespace fs = std::filesystem;

TEST_F(ToolsTest, RunWritesEverythingAndIsTheSameForAnyNumberOfThreads) {
  const std::string one = own / "one", two = own / "two", first = one + "/latest/";
  const std::vector<std::string> common = {sequence(), "--detector", "recorded", "--save-masks",
                                           "--view"};
  const auto with = [&](const std::string& output, const std::string& threads) {
    auto arguments = common;
    arguments.insert(arguments.end(), {"--output", output, "--threads", threads});
    return arguments;
  };
  ASSERT_EQ(run(with(one, "1")), 0) << said;
  EXPECT_TRUE(hasSaid("12 read, 12 tracked, 0 lost")) << said;
  ASSERT_EQ(run(with(two, "2")), 0) << said;
  for (const char* file :
       {"trajectory.txt", "map.ply", "map.png", "people.png", "people.json", "view.html"}) {
    EXPECT_EQ(readFile(first + file), readFile(two + "/latest/" + file)) << file;
    EXPECT_FALSE(readFile(first + file).empty()) << file;
  }
  EXPECT_EQ(readFile(first + "people.json"), readFile(sequence() + "/people.json"));
  const auto summary = summaryOf(one);
  EXPECT_LT(summary.at("ate_rmse_m").get<double>(), 0.02);
  EXPECT_EQ(summary.at("surfels"), loadMap(first + "map.ply").size());
  for (const auto& mask : fs::directory_iterator(sequence() + "/mask")) {
    EXPECT_TRUE(fs::exists(fs::path(first) / "mask" / mask.path().filename())) << mask.path();
  }
  EXPECT_EQ(run({one, two}, "posefusion_evaluate"), 1);
  EXPECT_EQ(run({sequence() + "/groundtruth.txt", first + "trajectory.txt", "--json", "--plot",
                 own / "plot.png"},
                "posefusion_evaluate"),
            0)
      << said;
  EXPECT_NEAR(nlohmann::json::parse(said).at("ate_m").at("rmse").get<double>(),
              summary.at("ate_rmse_m").get<double>(), 1e-6);
  EXPECT_GT(fs::file_size(own / "plot.png"), 1000U);
  EXPECT_EQ(run({"run", one, sequence(), "--first-frame", "1", "--json"}, "posefusion_evaluate"),
            0);
  const auto check = nlohmann::json::parse(said);
  EXPECT_EQ(check.at("people_in_map").at("frames_with_masks"), kFrames);
  EXPECT_EQ(check.at("beside_people").at("frames"), kFrames);
  EXPECT_EQ(check.at("beside_people").at("with_a_pose"), kFrames);
  EXPECT_LT(check.at("depth").at("median_abs_difference_m").get<double>(), 0.02);

  ASSERT_EQ(run({"surface", one, sequence(), "--json"}, "posefusion_evaluate"), 0) << said;
  const auto surface = nlohmann::json::parse(said);
  EXPECT_EQ(surface.at("surfels"), summary.at("surfels"));
  EXPECT_LT(surface.at("median_m").get<double>(), 0.02);
  EXPECT_LT(surface.at("two_layers").get<double>(), 0.1);
  EXPECT_EQ(run({"surface", one, one}, "posefusion_evaluate"), 1) << "there is no truth";
}

TEST_F(ToolsTest, EvaluateReportsCoverageWrongPosesAndCovariance) {
  const std::string out = own / "out", status = own / "status.csv";
  ASSERT_EQ(run({sequence(), "--detector", "recorded", "--output", out, "--save-status", status}),
            0)
      << said;
  ASSERT_EQ(run({sequence(), out, "--json", "--plan", own / "plan.png"}, "posefusion_evaluate"), 0)
      << said;
  auto track = nlohmann::json::parse(said);
  EXPECT_EQ(track.at("coverage").at("frames"), kFrames);
  EXPECT_EQ(track.at("coverage").at("share"), 1.0);
  EXPECT_EQ(track.at("coverage").at("share_of_passed"), 1.0);
  EXPECT_EQ(track.at("wrong_poses"), 0);
  EXPECT_EQ(track.at("wrong_poses"), summaryOf(out).at("wrong_poses"));
  EXPECT_NEAR(track.at("ate_held_m").at("rmse").get<double>(),
              summaryOf(out).at("ate_held_rmse_m").get<double>(), 1e-6);
  EXPECT_GT(fs::file_size(own / "plan.png"), 10'000U);
  EXPECT_EQ(track.at("false_poses"), 0);
  EXPECT_EQ(track.at("live").at("false_poses"), 0);

  // The live trajectory is read from the run's folder.
  const std::string live_file = out + "/latest/trajectory_live.txt";
  Trajectory live = loadTrajectory(live_file);
  live.back().T_world_camera.translation().x() += 0.5;
  saveTrajectory(live_file, live, "");
  ASSERT_EQ(run({sequence(), out, "--json"}, "posefusion_evaluate"), 0) << said;
  track = nlohmann::json::parse(said);
  EXPECT_EQ(track.at("false_poses"), 0);
  EXPECT_EQ(track.at("live").at("false_poses"), 1);
  EXPECT_EQ(track.at("live").at("wrong_poses"), 1);
  EXPECT_NEAR(track.at("live").at("worst_m").get<double>(), 0.5, 0.05);
  ASSERT_EQ(run({sequence(), out}, "posefusion_evaluate"), 0) << said;
  EXPECT_TRUE(hasSaid("final, loops corrected")) << said;
  EXPECT_TRUE(hasSaid("live, as reported")) << said;
  ASSERT_EQ(run({sequence(), live_file, "--json"}, "posefusion_evaluate"), 0) << said;
  EXPECT_FALSE(nlohmann::json::parse(said).contains("live")) << "a file is what it is";

  // Half of the poses taken away, and a jump in what is left.
  Trajectory half = loadTrajectory(out + "/latest/trajectory.txt");
  half.resize(kFrames / 2);
  half.back().T_world_camera.translation().x() += 1.0;
  saveTrajectory(own / "half.txt", half, "");
  ASSERT_EQ(run({sequence(), own / "half.txt", "--json"}, "posefusion_evaluate"), 0) << said;
  track = nlohmann::json::parse(said);
  EXPECT_EQ(track.at("coverage").at("share"), 0.5);
  EXPECT_FALSE(track.at("coverage").contains("share_of_passed")) << "no summary beside it";
  EXPECT_EQ(track.at("wrong_poses"), 1);

  ASSERT_EQ(run({"covariance", sequence(), status, "--json"}, "posefusion_evaluate"), 0) << said;
  EXPECT_EQ(nlohmann::json::parse(said).at("motions"), kFrames - 1);
  EXPECT_EQ(nlohmann::json::parse(said).at("nees_5_s").at("windows"), 0) << "it is too short";
  EXPECT_EQ(run({"covariance", sequence(), out + "/latest/trajectory.txt"}, "posefusion_evaluate"),
            1);
  EXPECT_TRUE(hasSaid("is no table of posefusion_run --save-status")) << said;
  EXPECT_EQ(run({own.str(), out}, "posefusion_evaluate"), 1);
  EXPECT_TRUE(hasSaid("has no groundtruth.txt")) << said;
}

TEST_F(ToolsTest, SettingsComeFromFileModeAndOptions) {
  const std::string file = own.write("c.yaml", "frame: {max_depth_m: 3.5}\nblur: {threshold: 7}");
  ASSERT_EQ(run({"--print-config", "--config", file, "--set", "blur.threshold=9", "--detector",
                 "none", "--mode", "posefusion"}),
            0);
  EXPECT_TRUE(hasSaid("max_depth_m: 3.5"));
  EXPECT_TRUE(hasSaid("threshold: 9.0"));
  EXPECT_TRUE(hasSaid("detector: none"));
  EXPECT_EQ(run({sequence(), "--set", "blur.treshold=9"}), 1);
  EXPECT_TRUE(hasSaid("blur.treshold is unknown, expected one of")) << said;
  EXPECT_EQ(run({sequence(), "--set", "blur.threshold=-1"}), 1);
  EXPECT_TRUE(hasSaid("blur.threshold is -1, expected 0 to")) << said;
  EXPECT_EQ(run({sequence(), "--mode", "fast"}), 1);
  EXPECT_TRUE(hasSaid("mode is 'fast', expected one of elastic, posefusion, pfh")) << said;
  EXPECT_NE(run({sequence(), "--max-frames", "-3"}), 0);
  EXPECT_TRUE(hasSaid("'-3': expected a whole number, 0 to 1000000000")) << said;
  EXPECT_NE(run({sequence(), "--threads", "-1"}), 0);
  EXPECT_TRUE(hasSaid("'-1': expected a whole number, 0 to 1024")) << said;
  EXPECT_NE(run({sequence(), "--threads", "two"}), 0);
  EXPECT_NE(run({sequence(), "--faster"}), 0);
  EXPECT_TRUE(hasSaid("--faster")) << said;
}

TEST_F(ToolsTest, WrongInputIsAnErrorThatNamesIt) {
  EXPECT_EQ(run({}), 1);
  EXPECT_TRUE(hasSaid("INPUT is missing")) << said;
  EXPECT_EQ(run({own / "none", "--detector", "none"}), 1);
  EXPECT_TRUE(hasSaid("none: does not exist, expected a TUM folder or a bag")) << said;
  fs::create_directory(own / "empty");
  EXPECT_EQ(run({own / "empty", "--detector", "none"}), 1);
  EXPECT_TRUE(hasSaid("empty: is no TUM folder, expected associations.txt")) << said;
  EXPECT_EQ(run({own.write("x.bag", "no bag"), "--detector", "none"}), 1);
  EXPECT_TRUE(hasSaid("x.bag: the bag cannot be read")) << said;
  EXPECT_EQ(run({sequence(), "--detector", "none", "--truth", own / "t.txt"}), 1);
  EXPECT_TRUE(hasSaid("t.txt: cannot be opened")) << said;
  fs::remove(copy("alone") + "/people.json");
  EXPECT_EQ(run({own / "alone", "--detector", "recorded"}), 1);
  EXPECT_TRUE(hasSaid("alone has no recorded people")) << said;
  EXPECT_EQ(run({sequence(), "--model", own / "net.pb", "--output", own / "out"}), 1);
  EXPECT_TRUE(hasSaid("net.pb")) << said;
}

TEST_F(ToolsTest, AnOutputFolderThatCannotBeWrittenStopsItBeforeTheFirstFrame) {
  own.write("file", "");
  EXPECT_EQ(run({sequence(), "--detector", "none", "--output", own / "file/out"}), 1);
  EXPECT_TRUE(hasSaid("file/out: the folder cannot be made")) << said;
  EXPECT_FALSE(hasSaid("frames per second")) << said;
  EXPECT_EQ(run({sequence(), "--detector", "none", "--output", sequence()}), 1);
  EXPECT_TRUE(hasSaid("is the input, expected another folder")) << said;
}

TEST_F(ToolsTest, DamagedFramesAreCountedAndTheRestIsDone) {
  const std::string input = copy("damaged");
  const auto depth = filesIn(input + "/depth");
  const std::string whole = readFile(depth[3]);
  own.write("damaged/depth/" + depth[3].filename().string(), whole.substr(0, whole.size() / 2));
  savePng(depth[5], cv::Mat::zeros(240, 320, CV_16UC1));
  savePng(depth[6], cv::Mat(120, 160, CV_16UC1, cv::Scalar(1000)));
  fs::remove(depth[8]);
  ASSERT_EQ(run({input, "--detector", "none", "--output", own / "out"}), 0) << said;
  EXPECT_TRUE(hasSaid("is not a whole image")) << said;
  EXPECT_TRUE(hasSaid("colour is 320x240 but depth is 160x120")) << said;
  const auto frames = summaryOf(own / "out").at("frames");
  EXPECT_EQ(frames.at("read"), kFrames);
  EXPECT_EQ(frames.at("bad"), 3);
  EXPECT_EQ(frames.at("lost"), 1);
  EXPECT_EQ(frames.at("tracked"), kFrames - 4);
}

}  // namespace
}  // namespace pf
