// SPDX-License-Identifier: BSD-3-Clause
#include <gtest/gtest.h>

#include <cmath>
#include <filesystem>
#include <nlohmann/json.hpp>

#include "posefusion/core/error.hpp"
#include "posefusion/io/files.hpp"
#include "posefusion/io/map_file.hpp"
#include "posefusion/io/trajectory_file.hpp"
#include "posefusion/run/run_report.hpp"
#include "random_pose.hpp"
#include "temporary_folder.hpp"

namespace pf {
namespace {

ProcessedFrame frameAt(int i, FrameOutcome outcome) {
  ProcessedFrame frame;
  RgbdFrame& input = frame.seen.frame;
  input.stamp_ns = i * 100 * kMs;
  input.camera.width = 64;
  input.camera.height = 48;
  input.camera.fx = input.camera.fy = 60;
  input.camera.cx = 32;
  input.camera.cy = 24;
  input.color = cv::Mat(48, 64, CV_8UC3, cv::Scalar(10, 20, 30));
  input.depth = cv::Mat(48, 64, CV_16UC1, cv::Scalar(1000));
  frame.status.stamp_ns = input.stamp_ns;
  frame.status.outcome = outcome;
  frame.status.located = outcome == FrameOutcome::fused || outcome == FrameOutcome::forced;
  frame.status.T_map_camera.translation().x() = 0.01 * i * i;
  frame.status.tracking_ms = i;
  frame.status.fusion_ms = 1;
  return frame;
}

TEST(RunStatistics, CountsEachFrameOnce) {
  RunStatistics statistics;
  statistics.add(frameAt(0, FrameOutcome::fused));
  statistics.add(frameAt(1, FrameOutcome::blurred));
  statistics.add(frameAt(2, FrameOutcome::bad_input));
  statistics.add(frameAt(3, FrameOutcome::few_inliers));
  statistics.add(frameAt(4, FrameOutcome::no_depth));
  statistics.add(frameAt(5, FrameOutcome::fused));
  statistics.add(frameAt(6, FrameOutcome::forced));
  ProcessedFrame while_lost = frameAt(7, FrameOutcome::forced);
  while_lost.status.located = false;
  statistics.add(while_lost);
  const FrameCounts& f = statistics.frames();
  EXPECT_EQ(f.read, 8U);
  EXPECT_EQ(f.tracked, 3U) << "the blurred one that passed by force was located";
  EXPECT_EQ(f.blurred, 1U);
  EXPECT_EQ(f.bad, 1U);
  EXPECT_EQ(f.lost, 3U);
  EXPECT_DOUBLE_EQ(f.poseShare(), 3.0 / 8);
  EXPECT_DOUBLE_EQ(f.sharpPoseShare(), 3.0 / 7);
  EXPECT_EQ(f.by_outcome.at("fused"), 2U);
  EXPECT_EQ(f.by_outcome.at("few_inliers"), 1U);
  EXPECT_EQ(f.by_state.at("initializing"), 8U);
}

TEST(RunStatistics, MedianAndTailOfAStage) {
  RunStatistics statistics;
  for (int i = 0; i < 101; ++i) statistics.add(frameAt(i, FrameOutcome::fused));
  const auto stages = statistics.stages();
  EXPECT_EQ(stages.at("tracking").median_ms, 50);
  EXPECT_EQ(stages.at("tracking").p95_ms, 95);
  EXPECT_EQ(stages.at("tracking").p99_ms, 99);
  EXPECT_EQ(stages.at("tracking").p999_ms, 100);
  EXPECT_EQ(stages.at("tracking").most_ms, 100);
  EXPECT_EQ(stages.at("tracking_and_fusion").median_ms, 51);
  EXPECT_EQ(stages.count("pose"), 0U) << "the detector looked at no frame";
}

TEST(RunStatistics, MinutesOfTheRecordingHaveTheirTimesAndLoopsCount) {
  RunStatistics statistics;
  for (int i = 0; i < 600; ++i) {  // a tenth of a second apart; nothing in the second minute
    ProcessedFrame frame = frameAt(i, FrameOutcome::fused);
    frame.status.tracking_ms = 10;
    if (i >= 300) frame.status.stamp_ns += 120'000 * kMs;
    frame.seen.gate_ms = i >= 300 ? 2 : 1;
    frame.segmentation_ms = 4;
    if (i >= 300) frame.loop_ms = i % 30 == 0 ? 500 : 3;
    statistics.add(frame);
  }
  const std::vector<StageTime> minutes = statistics.minutes();
  ASSERT_EQ(minutes.size(), 3U);
  EXPECT_EQ(minutes[0].median_ms, 16);
  EXPECT_EQ(minutes[1].median_ms, 0);
  EXPECT_EQ(minutes[2].median_ms, 20);
  EXPECT_EQ(minutes[2].p99_ms, 517) << "a correction that holds up few frames is reported";
}

TEST(RunStatistics, LoopsTakeTimeInTheChainAndBesideIt) {
  RunStatistics statistics;
  ProcessedFrame frame = frameAt(0, FrameOutcome::fused);
  statistics.add(frame);
  EXPECT_EQ(statistics.stages().count("loop_closing"), 0U) << "not known";
  frame.loop_ms = 3;
  statistics.add(frame);
  statistics.addTime("loop_verification", 40);
  EXPECT_EQ(statistics.stages().at("loop_closing").median_ms, 3);
  EXPECT_EQ(statistics.stages().at("loop_verification").median_ms, 40);
}

TEST(RunStatistics, MasksAreAveragedOverTheSharpFrames) {
  RunStatistics statistics;
  ProcessedFrame masked = frameAt(0, FrameOutcome::fused);
  masked.segmentation.mask = cv::Mat::zeros(48, 64, CV_8UC1);
  masked.segmentation.mask(cv::Rect(0, 0, 32, 48)) = 255;
  statistics.add(masked);
  statistics.add(frameAt(1, FrameOutcome::fused));
  statistics.add(frameAt(2, FrameOutcome::blurred));
  EXPECT_EQ(statistics.masks().with_mask, 1U);
  EXPECT_EQ(statistics.masks().over_1_percent, 1U);
  EXPECT_DOUBLE_EQ(statistics.masks().mean_part, 0.25);
}

class RunReportTest : public testing::Test {
 protected:
  RunReportTest() : report(Config{}), map(MapConfig{}) {
    Trajectory truth;
    for (int i = 0; i < 30; ++i) {
      report.add(frameAt(i, i == 7 ? FrameOutcome::not_converged : FrameOutcome::fused));
      truth.push_back({i * 100 * kMs, frameAt(i, FrameOutcome::fused).status.T_map_camera});
      truth.back().T_world_camera.translation().y() = 5;
    }
    report.setTruth(truth);
  }

  nlohmann::json summary() {
    report.writeSummary(folder.str(), 0);
    return nlohmann::json::parse(readFile(folder / "summary.json"));
  }

  TemporaryFolder folder;
  RunReport report;
  SurfelMap map;
};

TEST_F(RunReportTest, SummaryHasTheNamesThatStay) {
  const auto s = summary();
  EXPECT_EQ(s.at("frames").at("read"), 30);
  EXPECT_EQ(s.at("frames").at("blurred"), 0);
  EXPECT_EQ(s.at("frames").at("tracked"), 29);
  EXPECT_EQ(s.at("frames").at("lost"), 1);
  EXPECT_NEAR(s.at("frames").at("pose_share").get<double>(), 29.0 / 30, 1e-12);
  EXPECT_NEAR(s.at("frames").at("pose_share_of_sharp").get<double>(), 29.0 / 30, 1e-12);
  EXPECT_EQ(s.at("frames").at("by_state").at("initializing"), 30);
  EXPECT_EQ(s.at("frames").at("by_outcome").at("not_converged"), 1);
  EXPECT_EQ(s.at("surfels"), 0);
  EXPECT_EQ(s.at("stages").at("fusion").at("median_ms"), 1);
  EXPECT_TRUE(s.at("stages").at("tracking").contains("p95_ms"));
  EXPECT_GT(s.at("frames_per_second").get<double>(), 0);
  EXPECT_GT(s.at("peak_memory_mb").get<double>(), 1);
  EXPECT_NEAR(s.at("ate_rmse_m").get<double>(), 0, 1e-9);
  // Pose 7 is missing: 0.13 m from pose 6, once in 30 frames.
  EXPECT_NEAR(s.at("ate_held_rmse_m").get<double>(), 0.13 / std::sqrt(30), 1e-6);
  EXPECT_EQ(s.at("wrong_poses"), 0);
  EXPECT_NEAR(s.at("rpe_trans_m_per_s").get<double>(), 0, 1e-9);
  EXPECT_NEAR(s.at("rpe_rot_deg_per_s").get<double>(), 0, 1e-6);
  EXPECT_EQ(s.at("configuration").at("blur").at("enabled"), true);
  EXPECT_EQ(s.at("configuration").at("pose").at("detector"), "auto");
  EXPECT_FALSE(s.at("version").get<std::string>().empty());
}

TEST_F(RunReportTest, WithoutTruthThereAreNoErrors) {
  report.setTruth({});
  EXPECT_FALSE(summary().contains("ate_rmse_m"));
  EXPECT_EQ(report.table().find("ATE"), std::string::npos);
}

TEST_F(RunReportTest, ADoubtfulFrameThatIsLocatedHasAPose) {
  ProcessedFrame doubtful = frameAt(30, FrameOutcome::disagrees);
  doubtful.status.state = TrackingState::doubtful;
  doubtful.status.located = true;
  report.add(doubtful);
  EXPECT_EQ(report.trajectory().size(), 30U);
  EXPECT_EQ(report.statistics().frames().posed, 30U);
  EXPECT_EQ(report.statistics().frames().tracked, 29U);
  EXPECT_EQ(summary().at("frames").at("by_state").at("doubtful"), 1);
}

TEST_F(RunReportTest, TrajectoryHasTheLocatedFramesAlone) {
  report.writeTrajectories(folder.str());
  const Trajectory written = loadTrajectory(folder / "trajectory.txt");
  ASSERT_EQ(written.size(), 29U);
  EXPECT_EQ(written[7].stamp_ns, 800 * kMs);
  EXPECT_NEAR(written[7].T_world_camera.translation().y(), -0.64, 1e-9) << "to the right, z up";
}

TEST_F(RunReportTest, OfAChainElsewhereItReportsWhatIsKnown) {
  ProcessedFrame frame = frameAt(30, FrameOutcome::fused);
  frame.seen.gate_ms = frame.segmentation_ms = std::nan("");
  RunStatistics statistics;
  statistics.add(frame);
  EXPECT_EQ(statistics.stages().count("gate"), 0U);
  EXPECT_EQ(statistics.stages().count("fusion"), 1U);

  report.addLeftOut("dropped");
  report.setCorrected(Trajectory(report.trajectory()));
  report.writeSummary(folder.str(), 17);
  const auto s = nlohmann::json::parse(readFile(folder / "summary.json"));
  EXPECT_EQ(s.at("surfels"), 17);
  EXPECT_EQ(s.at("frames").at("read"), 31);
  EXPECT_EQ(s.at("frames").at("left_out"), 1);
  EXPECT_EQ(s.at("frames").at("by_outcome").at("dropped"), 1);
  EXPECT_NEAR(s.at("ate_rmse_m").get<double>(), 0, 1e-9);
  EXPECT_EQ(s.at("live").at("wrong_poses"), 0);
  EXPECT_FALSE(s.contains("loops"));
  EXPECT_FALSE(s.contains("peak_memory_mb"));
  EXPECT_FALSE(std::filesystem::exists(folder / "trajectory.txt")) << "the chain has written it";
}

TEST_F(RunReportTest, LivePosesAreComparedWithTheTruthToo) {
  EXPECT_FALSE(summary().contains("live")) << "nothing is corrected yet";
  const Trajectory reported = report.trajectory();
  Trajectory corrected = reported;
  for (std::size_t i = 20; i < corrected.size(); ++i) {
    corrected[i].T_world_camera.translation().z() += 0.2;
  }
  report.setCorrected(corrected);
  const auto s = summary();
  EXPECT_EQ(s.at("false_poses"), corrected.size() - 20);
  EXPECT_GT(s.at("ate_rmse_m").get<double>(), 0.04);
  EXPECT_EQ(s.at("live").at("false_poses"), 0);
  EXPECT_NEAR(s.at("live").at("ate_rmse_m").get<double>(), 0, 1e-9);
  EXPECT_NE(report.table().find("as reported at the time"), std::string::npos) << report.table();
}

TEST_F(RunReportTest, AnEmptyMapIsWrittenWithoutAPicture) {
  report.writePictures(folder.str(), map);
  EXPECT_FALSE(std::filesystem::exists(folder / "map.png"));
  EXPECT_TRUE(std::filesystem::exists(folder / "people.png"));
  for (const auto& entry : std::filesystem::directory_iterator(folder.str())) {
    EXPECT_EQ(entry.path().string().find(".part"), std::string::npos) << "nothing is left behind";
  }
}

TEST_F(RunReportTest, AFolderThatIsGoneIsAnErrorThatNamesTheFile) {
  const std::string error = errorOf([&] { report.writeTrajectories(folder / "none"); });
  EXPECT_NE(error.find("none/trajectory.txt: cannot be written"), std::string::npos) << error;
}

TEST(MakeFolder, ReportsWhyItCannot) {
  TemporaryFolder folder;
  folder.write("file", "");
  EXPECT_NE(
      errorOf([&] { makeFolder(folder / "file/below"); }).find("file/below: the folder cannot"),
      std::string::npos);
  EXPECT_EQ(errorOf([&] { makeFolder(folder / "a/b/c"); }), "");
  EXPECT_EQ(errorOf([&] { makeFolder(folder / "a/b/c"); }), "") << "may be there";
}

}  // namespace
}  // namespace pf
