// SPDX-License-Identifier: BSD-3-Clause
#include <gtest/gtest.h>
#include <sys/wait.h>
#include <unistd.h>

#include <csignal>
#include <filesystem>
#include <random>

#include "full_disk.hpp"
#include "posefusion/core/error.hpp"
#include "posefusion/core/se3.hpp"
#include "posefusion/core/stamps.hpp"
#include "posefusion/io/files.hpp"
#include "posefusion/io/trajectory_file.hpp"
#include "temporary_folder.hpp"

namespace pf {
namespace {

TEST(Stamp, ParsesDecimalsExactly) {
  EXPECT_EQ(parseStamp("1341845820.819654"), 1341845820819654000);
  EXPECT_EQ(parseStamp("1311868163.8697"), 1311868163869700000);
  EXPECT_EQ(parseStamp("1"), 1000000000);
  EXPECT_EQ(parseStamp("0.000000001"), 1);
  EXPECT_EQ(parseStamp(".5"), 500000000);
  EXPECT_EQ(parseStamp("-0.25"), -250000000);
  EXPECT_EQ(parseStamp("1.305031102160407066e+09"), 1305031102160407066);
  EXPECT_EQ(parseStamp("0.0000000014"), 1);
  EXPECT_EQ(parseStamp("0.0000000015"), 2) << "digits beyond a nanosecond are rounded";
}

TEST(Stamp, RefusesWhatIsNone) {
  for (const char* text : {"", ".", "-", "1.2.3", "1,5", "nan", "12s", "1e", "1e+", "1e99", "0x10",
                           "99999999999999"}) {
    EXPECT_THROW(parseStamp(text), InputError) << text;
  }
}

TEST(Stamp, FormatReadsBackAsTheSame) {
  EXPECT_EQ(formatStamp(1033333000), "1.033333");
  EXPECT_EQ(formatStamp(1033333333), "1.033333333");
  EXPECT_EQ(formatStamp(-250000000), "-0.250000");
  std::mt19937_64 random(3);
  for (int i = 0; i < 1000; ++i) {
    const auto stamp = static_cast<std::int64_t>(random() >> 2);
    EXPECT_EQ(parseStamp(formatStamp(stamp)), stamp);
  }
}

TEST(Trajectory, FileReadsBackAsTheSame) {
  TemporaryFolder folder;
  Trajectory written;
  std::mt19937 random(4);
  std::uniform_real_distribution<double> unit(-1, 1);
  for (int i = 0; i < 50; ++i) {
    Vector6d twist;
    for (int k = 0; k < 6; ++k) twist[k] = unit(random);
    written.push_back({i * 33333333LL, expSe3(twist)});
  }
  saveTrajectory(folder / "t.txt", written, "camera pose");
  const Trajectory read = loadTrajectory(folder / "t.txt");
  ASSERT_EQ(read.size(), written.size());
  for (std::size_t i = 0; i < read.size(); ++i) {
    EXPECT_EQ(read[i].stamp_ns, written[i].stamp_ns);
    EXPECT_TRUE(read[i].T_world_camera.isApprox(written[i].T_world_camera, 1e-7));
  }
}

TEST(Trajectory, IsSortedByStampAndSkipsComments) {
  TemporaryFolder folder;
  const auto path = folder.write("t.txt", "# comment\n\n2.0 0 0 0 0 0 0 1\n1.0,1,0,0,0,0,0,1\r\n");
  const Trajectory read = loadTrajectory(path);
  ASSERT_EQ(read.size(), 2U);
  EXPECT_EQ(read[0].stamp_ns, 1000000000);
  EXPECT_EQ(read[0].T_world_camera.translation().x(), 1.0);
}

TEST(Trajectory, ErrorsNameFileAndLine) {
  TemporaryFolder folder;
  const auto error = [&](const std::string& text) {
    const auto path = folder.write("t.txt", "1.0 0 0 0 0 0 0 1\n" + text);
    return errorOf([&] { loadTrajectory(path); });
  };
  EXPECT_EQ(error("2.0 0 0 0\n"),
            folder / "t.txt:2: expected 8 numbers: stamp tx ty tz qx qy qz qw");
  EXPECT_EQ(error("2.0 0 0 x 0 0 0 1\n"), folder / "t.txt:2: 'x' is no number");
  EXPECT_EQ(error("2.0 0 0 nan 0 0 0 1\n"), folder / "t.txt:2: 'nan' is no number");
  EXPECT_EQ(error("2.0 0 0 0 0 0 0 0\n"), folder / "t.txt:2: the quaternion is not of unit length");
  EXPECT_EQ(error("2.0 0 0 0 0 0 0 1 5\n"), folder / "t.txt:2: more than 8 numbers");
  EXPECT_EQ(error("frame 0 0 0 0 0 0 1\n"),
            folder / "t.txt:2: 'frame' is no stamp, expected decimal seconds");
  EXPECT_NE(
      errorOf([&] { loadTrajectory(folder / "none.txt"); }).find("none.txt: cannot be opened"),
      std::string::npos);
}

StampedPose poseAt(int i) {
  StampedPose pose;
  pose.stamp_ns = 1000000000L + i * 33333333L;
  pose.T_world_camera = expSe3((Vector6d() << 0.1 * i, -1, 2, 0.3, 0.01 * i, -0.2).finished());
  return pose;
}

TEST(TrajectoryJournal, AProcessThatIsKilledLosesNoPose) {
  const TemporaryFolder folder;
  const std::string path = folder / "trajectory.partial.txt";
  constexpr int kPoses = 50;
  int ready[2];
  ASSERT_EQ(pipe(ready), 0);
  const pid_t child = fork();
  if (child == 0) {
    TrajectoryJournal journal(path, "camera");
    for (int i = 0; i < kPoses; ++i) journal.add(poseAt(i));
    if (write(ready[1], "x", 1) == 1) pause();
    _exit(1);
  }
  close(ready[1]);  // a child that ends too soon ends the waiting too
  char byte = 0;
  ASSERT_EQ(read(ready[0], &byte, 1), 1);
  kill(child, SIGKILL);
  waitpid(child, nullptr, 0);
  const Trajectory kept = loadTrajectory(path);
  ASSERT_EQ(kept.size(), kPoses);
  for (int i = 0; i < kPoses; ++i) {
    EXPECT_EQ(kept[i].stamp_ns, poseAt(i).stamp_ns);
    EXPECT_TRUE(kept[i].T_world_camera.isApprox(poseAt(i).T_world_camera, 1e-7));
  }
}

TEST(TrajectoryJournal, EqualsTheSavedTrajectoryAndIsThenRemoved) {
  const TemporaryFolder folder;
  Trajectory poses;
  TrajectoryJournal journal(folder / "journal", "camera");
  for (int i = 0; i < 3; ++i) {
    poses.push_back(poseAt(i));
    EXPECT_TRUE(journal.add(poses.back()));
  }
  saveTrajectory(folder / "saved", poses, "camera");
  EXPECT_EQ(readFile(folder / "journal"), readFile(folder / "saved"));
  journal.remove();
  EXPECT_FALSE(std::filesystem::exists(folder / "journal"));
}

TEST(TrajectoryJournal, WhatAKilledProcessLeftIsKept) {
  const TemporaryFolder folder;
  const std::string path = folder / "journal";
  TrajectoryJournal(path, "").add(poseAt(1));
  TrajectoryJournal(path, "").add(poseAt(2));
  EXPECT_EQ(loadTrajectory(path).at(0).stamp_ns, poseAt(2).stamp_ns);
  EXPECT_EQ(loadTrajectory(path + ".old").at(0).stamp_ns, poseAt(1).stamp_ns);
}

TEST(TrajectoryJournal, AFullDiskLeavesWholeLines) {
  const TemporaryFolder folder;
  const std::string path = folder / "journal";
  TrajectoryJournal journal(path, "");
  EXPECT_TRUE(journal.add(poseAt(0)));
  {
    const FullDisk full(std::filesystem::file_size(path) + 10);
    EXPECT_FALSE(journal.add(poseAt(1)));
  }
  EXPECT_TRUE(journal.add(poseAt(2)));
  const Trajectory kept = loadTrajectory(path);
  ASSERT_EQ(kept.size(), 2U);
  EXPECT_EQ(kept[1].stamp_ns, poseAt(2).stamp_ns);
}

TEST(TrajectoryJournal, AFileThatCannotBeMadeIsNamed) {
  EXPECT_NE(errorOf([] { TrajectoryJournal("/nowhere/journal", ""); }).find("/nowhere/journal"),
            std::string::npos);
}

}  // namespace
}  // namespace pf
