// SPDX-License-Identifier: BSD-3-Clause
// The truth of the simulator agrees with its pictures, and with itself.
#include <gtest/gtest.h>
#include <tbb/global_control.h>

#include <algorithm>
#include <cmath>
#include <opencv2/imgproc.hpp>

#include "posefusion/io/frame_source.hpp"
#include "simulator/output.hpp"
#include "simulator/truth.hpp"
#include "simulator_scene.hpp"

namespace pf::simulator {
namespace {

bool samePicture(const cv::Mat& a, const cv::Mat& b) {
  return a.size() == b.size() && a.type() == b.type() && cv::norm(a, b, cv::NORM_INF) == 0.0;
}

std::vector<SimulatedFrame> someFrames(const Scenario& scenario, int count) {
  Simulation simulation(scenario);
  std::vector<SimulatedFrame> frames;
  for (int i = 0; i < count; ++i) frames.push_back(simulation.frame(i));
  return frames;
}

TEST(SimulatorTruth, DepthMovedByTheTruePosesMeetsTheNextDepth) {
  const auto frames = someFrames(smallScenario({"depth.noise=false", "people=[]"}), 16);
  const SimulatedFrame &a = frames[0], &b = frames[15];
  const Eigen::Isometry3d T_b_a = b.T_world_camera.inverse() * a.T_world_camera;
  ASSERT_GT(T_b_a.translation().norm(), 0.02);
  const PinholeCamera& camera = a.frame.camera;
  std::vector<double> errors;
  for (int row = 0; row < camera.height; row += 2) {
    for (int col = 0; col < camera.width; col += 2) {
      const double z = 1e-3 * a.frame.depth.at<std::uint16_t>(row, col);
      if (z <= 0.0) continue;
      const Eigen::Vector3d p = T_b_a * camera.unproject(col, row, z);
      const Eigen::Vector2d uv = camera.project(p);
      const int u = static_cast<int>(std::lround(uv.x())),
                v = static_cast<int>(std::lround(uv.y()));
      if (u < 0 || v < 0 || u >= camera.width || v >= camera.height) continue;
      const double seen = 1e-3 * b.frame.depth.at<std::uint16_t>(v, u);
      if (seen > 0.0) errors.push_back(std::abs(seen - p.z()));
    }
  }
  ASSERT_GT(errors.size(), 3000U);
  std::sort(errors.begin(), errors.end());
  // Half a pixel of a coarse picture on slanted floor and walls is some millimetres.
  EXPECT_LT(errors[errors.size() / 2], 0.006);
  EXPECT_LT(errors[errors.size() * 9 / 10], 0.04);
}

TEST(SimulatorTruth, MaskIsWherePeopleStandBeforeTheEmptyRoom) {
  const auto with = someFrames(smallScenario({"depth.noise=false"}), 1);
  const auto without = someFrames(smallScenario({"depth.noise=false", "people=[]"}), 1);
  int covered = 0;
  for (int row = 0; row < with[0].mask.rows; ++row) {
    for (int col = 0; col < with[0].mask.cols; ++col) {
      const int here = with[0].frame.depth.at<std::uint16_t>(row, col);
      const int empty = without[0].frame.depth.at<std::uint16_t>(row, col);
      if (with[0].mask.at<std::uint8_t>(row, col) == 0) {
        ASSERT_EQ(here, empty) << row << " " << col;
      } else {
        ASSERT_GT(here, 0);
        ASSERT_TRUE(empty == 0 || here < empty) << row << " " << col;
        ++covered;
      }
    }
  }
  EXPECT_GT(covered, 500);
}

TEST(SimulatorTruth, VisibleJointsLieInTheMaskOfTheirPersonAndBehindItsSkin) {
  for (const auto& frame : someFrames(smallScenario({"depth.noise=false"}), 3)) {
    ASSERT_EQ(frame.people.size(), 2U);
    for (const PersonTruth& person : frame.people) {
      int visible = 0;
      for (std::size_t j = 0; j < person.joints_px.size(); ++j) {
        const Eigen::Vector3d p = frame.T_world_camera.inverse() * person.joints_world_m[j];
        if (!person.visible[j]) continue;
        ++visible;
        EXPECT_LT((frame.frame.camera.project(p) - person.joints_px[j]).norm(), 1e-6);
        const int u = static_cast<int>(std::lround(person.joints_px[j].x()));
        const int v = static_cast<int>(std::lround(person.joints_px[j].y()));
        EXPECT_EQ(frame.mask.at<std::uint8_t>(v, u), person.id) << kJointNames[j];
        const double skin = 1e-3 * frame.frame.depth.at<std::uint16_t>(v, u);
        EXPECT_LT(skin, p.z() + 0.03) << kJointNames[j];
        EXPECT_GT(skin, p.z() - 0.25) << kJointNames[j];
      }
      EXPECT_GE(visible, 6) << person.name;
    }
    EXPECT_EQ(asDetected(frame).people.size(), 2U);
  }
}

TEST(SimulatorTruth, PosesOfTheTrajectoryAreThoseOfTheFrames) {
  Simulation simulation(smallScenario());
  const SimulatedFrame frame = simulation.frame(5);
  const Trajectory truth = simulation.truth(simulation.frameCount());
  EXPECT_NEAR(static_cast<double>(truth.size()), 1.05 * 200.0, 2.0);
  double nearest = 1e9, distance = 1e9;
  for (const auto& pose : truth) {
    const double gap = std::abs(static_cast<double>(pose.stamp_ns - frame.frame.stamp_ns)) * 1e-9;
    if (gap >= nearest) continue;
    nearest = gap;
    distance = (pose.T_world_camera.translation() - frame.T_world_camera.translation()).norm();
  }
  EXPECT_LE(nearest, 0.0026);
  EXPECT_LT(distance, 0.003);
}

TEST(SimulatorTruth, MotionCaptureHasTheNoiseAndTheGapsOfItsSettings) {
  const Simulation clean(smallScenario({"duration_s=8"}));
  const Simulation noisy(smallScenario(
      {"duration_s=8", "truth.noise_m=0.01", "truth.gap_every_s=2", "truth.gap_s=0.5"}));
  const Trajectory poses = clean.truth(clean.frameCount()),
                   marked = noisy.truth(noisy.frameCount());
  double squares = 0.0, longest_s = 0.0, missing_s = 0.0;
  for (std::size_t i = 0; i < marked.size(); ++i) {
    const auto same_moment = std::find_if(poses.begin(), poses.end(), [&](const auto& pose) {
      return pose.stamp_ns == marked[i].stamp_ns;
    });
    ASSERT_NE(same_moment, poses.end());
    squares += (same_moment->T_world_camera.translation() - marked[i].T_world_camera.translation())
                   .squaredNorm();
    if (i == 0) continue;
    const double step_s = static_cast<double>(marked[i].stamp_ns - marked[i - 1].stamp_ns) * 1e-9;
    longest_s = std::max(longest_s, step_s);
    missing_s += step_s > 0.01 ? step_s : 0.0;
  }
  EXPECT_NEAR(std::sqrt(squares / (3.0 * static_cast<double>(marked.size()))), 0.01, 0.001);
  EXPECT_NEAR(longest_s, 0.5, 0.011);
  EXPECT_GE(missing_s, 1.5);
  EXPECT_LE(missing_s, 2.1);
}

/// A swinging camera without noise, with a rolling shutter, `later_s` after one second.
SimulatedFrame swinging(double rolling_shutter_ms, double later_s) {
  ScenarioChanges changes;
  changes.assignments = {"camera.motion=rpy",
                         "camera.period_s=0.8",
                         "color.motion_blur=false",
                         "color.auto_exposure=false",
                         "color.noise=0",
                         "color.blur_px=0",
                         "color.rolling_shutter_ms=" + std::to_string(rolling_shutter_ms)};
  changes.start_s = 1.0 + later_s;
  Simulation simulation(load(smallScene(), changes));
  return simulation.frame(0);
}

/// Mean difference of the grey values in some rows: of the world, or where `people` are.
double difference(const cv::Mat& a, const cv::Mat& b, const cv::Range& rows, const cv::Mat& part) {
  cv::Mat apart;
  cv::absdiff(a.rowRange(rows), b.rowRange(rows), apart);
  return cv::mean(apart, part.empty() ? part : part.rowRange(rows))[1];
}

TEST(SimulatorTruth, EachRowOfARollingShutterIsThatOfAGlobalOneAtItsMoment) {
  constexpr int kBands = 15, kRows = 8;  // of 120 rows
  const cv::Mat global = swinging(0.0, 0.0).frame.color;
  for (const double readout_ms : {15.0, 30.0}) {
    const cv::Mat rolling = swinging(readout_ms, 0.0).frame.color;
    const cv::Range middle(kBands / 2 * kRows, (kBands / 2 + 1) * kRows);
    EXPECT_LT(difference(rolling, global, middle, cv::Mat()), 0.3);
    for (const int band : {5, 12}) {
      const double later_s = 1e-3 * readout_ms * ((band + 0.5) / kBands - 0.5);
      const SimulatedFrame then = swinging(0.0, later_s);
      const cv::Range rows(band * kRows, (band + 1) * kRows);
      for (const cv::Mat& part : {cv::Mat(then.mask == 0), cv::Mat(then.mask > 0)}) {
        const double own = difference(rolling, then.frame.color, rows, part);
        const double others = difference(rolling, global, rows, part);
        EXPECT_LT(own, 0.2 * others) << readout_ms << " ms, band " << band;
        EXPECT_GT(others, 0.2) << readout_ms << " ms, band " << band;
      }
    }
  }
}

TEST(SimulatorTruth, SameSeedSameBytesOtherSeedOtherBytes) {
  const auto a = someFrames(smallScenario(), 2), b = someFrames(smallScenario(), 2);
  for (int i = 0; i < 2; ++i) {
    EXPECT_TRUE(samePicture(a[i].frame.color, b[i].frame.color));
    EXPECT_TRUE(samePicture(a[i].frame.depth, b[i].frame.depth));
    EXPECT_TRUE(samePicture(a[i].mask, b[i].mask));
    EXPECT_EQ(a[i].depth_stamp_ns, b[i].depth_stamp_ns);
  }
  ScenarioChanges changes;
  changes.seed = 99;
  const auto c = someFrames(load(smallScene(), changes), 1);
  EXPECT_FALSE(samePicture(a[0].frame.color, c[0].frame.color));
  EXPECT_FALSE(samePicture(a[0].frame.depth, c[0].frame.depth));
}

TEST(SimulatorTruth, OneThreadMakesTheSameBytesAsMany) {
  const auto many = someFrames(smallScenario(), 2);
  const tbb::global_control one(tbb::global_control::max_allowed_parallelism, 1);
  const auto serial = someFrames(smallScenario(), 2);
  for (int i = 0; i < 2; ++i) {
    EXPECT_TRUE(samePicture(many[i].frame.color, serial[i].frame.color));
    EXPECT_TRUE(samePicture(many[i].frame.depth, serial[i].frame.depth));
    EXPECT_TRUE(samePicture(many[i].mask, serial[i].mask));
  }
}

TEST(SimulatorTruth, TheWalkerOfTheSmallRoomCrossesTheView) {
  ScenarioChanges changes;
  changes.assignments = {"camera.width=160"};
  Simulation simulation(loadScenario("box_walker", changes));
  double covered = 0.0;
  int seen = 0, left = 160, right = 0;
  for (int i = 0; i < simulation.frameCount(); i += 15, ++seen) {
    const SimulatedFrame frame = simulation.frame(i);
    const cv::Rect body = cv::boundingRect(frame.mask > 0);
    covered += cv::countNonZero(frame.mask) / static_cast<double>(frame.mask.total());
    left = std::min(left, body.x);
    right = std::max(right, body.x + body.width);
  }
  EXPECT_GT(covered / seen, 0.05);
  EXPECT_LT(covered / seen, 0.30);
  EXPECT_LT(left, 60);
  EXPECT_GT(right, 100);
}

TEST(SimulatorTruth, TumFolderIsReadBack) {
  const TemporaryFolder folder;
  const Scenario scenario = smallScenario({"dropped=0.3", "depth.offset_ms=4"});
  Simulation simulation(scenario);
  const auto output = openTumOutput(folder / "out", simulation);
  int kept = 0;
  for (int i = 0; i < 10; ++i) {
    const SimulatedFrame frame = simulation.frame(i);
    kept += frame.dropped ? 0 : 1;
    output->add(frame);
  }
  output->finish(simulation);
  ASSERT_GT(kept, 2);
  ASSERT_LT(kept, 10);
  const auto source = openTumFolder(folder / "out");
  EXPECT_EQ(source->frameCount(), static_cast<std::size_t>(kept));
  EXPECT_EQ(source->people().size(), static_cast<std::size_t>(kept));
  EXPECT_EQ(source->truth().size(), simulation.truth(10).size());
  const auto first = source->next();
  ASSERT_TRUE(first);
  EXPECT_EQ(first->defect, "");
  EXPECT_EQ(first->frame.camera.width, 160);
  EXPECT_NE(errorOf([&] { openTumOutput(folder / "out", simulation); }).find("not empty"),
            std::string::npos);
}

}  // namespace
}  // namespace pf::simulator
