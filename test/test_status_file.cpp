// SPDX-License-Identifier: BSD-3-Clause
#include <gtest/gtest.h>

#include <cmath>

#include "posefusion/io/files.hpp"
#include "posefusion/io/status_file.hpp"
#include "temporary_folder.hpp"

namespace pf {
namespace {

StatusRow lostRow() {
  StatusRow row;
  row.stamp_ns = 1'033'333'000;
  row.state = "lost";
  row.outcome = "bad_input";
  row.reason = "bad_input: colour is 4x4, \"depth\" is 2x2";
  return row;
}

StatusRow trackedRow() {
  StatusRow row;
  row.stamp_ns = 1'066'667'000;
  row.has_pose = true;
  row.state = "tracking";
  row.outcome = "fused";
  Vector6d twist;
  twist << 1, -2, 0.5, 0.3, 1.2, -0.4;
  row.T_map_camera = expSe3(twist);
  row.covariance = 1e-6 * (Matrix6d::Identity() + 0.2 * twist * twist.transpose());
  return row;
}

TEST(StatusFile, ReadsWhatItWrites) {
  TemporaryFolder folder;
  StatusRow provisional = trackedRow();
  provisional.has_pose = false;
  provisional.is_provisional = true;
  saveStatus(folder / "s.csv", {lostRow(), trackedRow(), provisional});
  const auto rows = loadStatus(folder / "s.csv");
  ASSERT_EQ(rows.size(), 3U);
  EXPECT_TRUE(rows[2].is_provisional);
  EXPECT_FALSE(rows[2].has_pose || rows[1].is_provisional);
  EXPECT_FALSE(rows[0].has_pose);
  EXPECT_EQ(rows[0].state, "lost");
  EXPECT_EQ(rows[0].outcome, "bad_input");
  EXPECT_EQ(rows[0].reason, lostRow().reason);
  EXPECT_TRUE(rows[1].has_pose);
  EXPECT_EQ(rows[1].stamp_ns, trackedRow().stamp_ns);
  EXPECT_TRUE(rows[1].T_map_camera.isApprox(trackedRow().T_map_camera, 1e-10));
  EXPECT_TRUE(rows[1].covariance.isApprox(trackedRow().covariance, 1e-10));
}

TEST(StatusFile, WrongInputIsAnErrorThatNamesFileAndLine) {
  TemporaryFolder folder;
  saveStatus(folder / "s.csv", {trackedRow()});
  const std::string text = readFile(folder / "s.csv");
  const auto said = [&](const std::string& content) {
    return errorOf([&] { loadStatus(folder.write("t.csv", content)); });
  };
  EXPECT_NE(said("stamp,x\n").find("t.csv: is no table"), std::string::npos);
  EXPECT_NE(said(text + "1.0,1\n").find("t.csv:3: 2 columns"), std::string::npos);
  std::string broken = text;
  broken.replace(broken.find("fused,\"\",") + 9, 1, "x");
  EXPECT_NE(said(broken).find("t.csv:2: 'x"), std::string::npos) << said(broken);
}

}  // namespace
}  // namespace pf
