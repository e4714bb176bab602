// SPDX-License-Identifier: BSD-3-Clause
// What the chain reports on /diagnostics.
#include <gtest/gtest.h>

#include "diagnostics_listener.hpp"

namespace posefusion_ros {
namespace {

using diagnostic_msgs::DiagnosticStatus;

TEST(ChainDiagnostics, ReportTheFramesAndTheMap) {
  Chain chain("telling");
  const Diagnostics diagnostics(chain);
  ASSERT_TRUE(chain.load());
  for (int i = 0; i < 3; ++i) chain.process(toMessages(emptyRoom().frame(i).frame));
  CameraMessages bad = toMessages(emptyRoom().frame(3).frame);
  bad.depth->encoding = "8UC1";
  EXPECT_EQ(outcome(chain.process(bad)), TrackingStatusMsg::BAD_INPUT);
  for (const char* nodelet : {"blur_gate", "pose_detector", "segmenter", "fusion"}) {
    EXPECT_TRUE(diagnostics.waitFor(nodelet, "frames", "3")) << nodelet;
    EXPECT_NE(diagnostics.value(nodelet, "rate (Hz)"), "none") << nodelet;
    EXPECT_NE(diagnostics.value(nodelet, "after the stamp, 99 % (ms)"), "none") << nodelet;
  }
  EXPECT_TRUE(diagnostics.waitFor("blur_gate", "given up: bad_input", "1"));
  EXPECT_TRUE(diagnostics.waitFor("fusion", "given up: bad_input", "1")) << "it counts for all";
  EXPECT_TRUE(diagnostics.waitFor("loop_closer", "frames", "1")) << "the first keyframe";
  EXPECT_EQ(diagnostics.value("segmenter", "people"), "0");
  EXPECT_EQ(diagnostics.value("fusion", "state"), "tracking");
  EXPECT_EQ(diagnostics.value("fusion", "lost for (s)"), "0.0");
  EXPECT_EQ(diagnostics.value("fusion", "keyframes"), "1");
  EXPECT_GT(std::stoi(diagnostics.value("fusion", "surfels")), 1000);
}

TEST(ChainDiagnostics, ALostCameraIsAnErrorThatNamesSinceWhen) {
  Chain chain("losing");
  const Diagnostics diagnostics(chain);
  chain.set("tracking/lost_after_s", 0.033);
  ASSERT_TRUE(chain.load());
  chain.process(toMessages(emptyRoom().frame(0).frame));
  CameraMessages covered = toMessages(emptyRoom().frame(1).frame);
  std::fill(covered.depth->data.begin(), covered.depth->data.end(), std::uint8_t{0});
  TrackingStatusMsg status;
  for (int i = 1; i < 30 && status.state != TrackingStatusMsg::LOST; ++i) {
    status = chain.process(restamped(covered, emptyRoom().stamp(i)));
  }
  ASSERT_EQ(status.state, TrackingStatusMsg::LOST);
  ASSERT_TRUE(diagnostics.waitFor("fusion", "state", "lost"));
  EXPECT_EQ(diagnostics.of("fusion").level, DiagnosticStatus::ERROR);
  EXPECT_EQ(diagnostics.of("fusion").message.rfind("lost for ", 0), 0U)
      << diagnostics.of("fusion").message;
}

TEST(ChainDiagnostics, AnotherCameraIsAnErrorThatNamesBoth) {
  Chain chain("exchanged");
  const Diagnostics diagnostics(chain);
  ASSERT_TRUE(chain.load());
  const auto send = [&chain](int i, double more_px) {
    CameraMessages m = toMessages(emptyRoom().frame(i).frame);
    m.info->K[0] += more_px;
    m.info->P[0] += more_px;
    return chain.process(m);
  };
  for (int i = 0; i < 4; ++i) EXPECT_EQ(outcome(send(i, 0)), TrackingStatusMsg::FUSED);
  const pf::PinholeCamera of_map = emptyRoom().frame(0).frame.camera;
  pf::PinholeCamera other = of_map;
  other.fx += 5;
  TrackingStatusMsg status;
  for (int i = 4; i < 6; ++i) {
    status = send(i, 5);
    EXPECT_EQ(outcome(status), TrackingStatusMsg::BAD_INPUT);
    EXPECT_EQ(status.state, TrackingStatusMsg::LOST);
    EXPECT_NE(status.reason.find(pf::describe(of_map)), std::string::npos) << status.reason;
    EXPECT_NE(status.reason.find(pf::describe(other)), std::string::npos) << status.reason;
  }
  ASSERT_TRUE(diagnostics.waitFor("fusion", "state", "lost"));
  const DiagnosticStatus diagnosis = diagnostics.of("fusion");
  EXPECT_EQ(diagnosis.level, DiagnosticStatus::ERROR);
  for (const std::string& text : {pf::describe(of_map), pf::describe(other), std::string("~reset")})
    EXPECT_NE(diagnosis.message.find(text), std::string::npos) << diagnosis.message;
  status = send(6, 1e-6);
  EXPECT_EQ(outcome(status), TrackingStatusMsg::FUSED) << status.reason << " (the map is there)";
  EXPECT_EQ(outcome(send(7, 5)), TrackingStatusMsg::BAD_INPUT);
  ASSERT_TRUE(chain.call("reset").success);
  EXPECT_EQ(outcome(send(8, 5)), TrackingStatusMsg::FUSED) << "a map of the new camera";
}

TEST(ChainDiagnostics, StampsOfAnotherClockAreAWarningThatNamesARemedy) {
  Chain chain("clocks_differ");
  const Diagnostics diagnostics(chain);
  ASSERT_TRUE(chain.load());
  chain.process(toMessages(emptyRoom().frame(0).frame));  // stamps begin at 1000 s
  ASSERT_TRUE(diagnostics.waitFor("fusion", "after the stamp, median (ms)", "unknown"));
  EXPECT_EQ(diagnostics.of("fusion").level, DiagnosticStatus::WARN);
  EXPECT_NE(diagnostics.of("fusion").message.find("use_sim_time true"), std::string::npos)
      << diagnostics.of("fusion").message;
  chain.process(restamped(toMessages(emptyRoom().frame(1).frame), toNs(ros::Time::now())));
  EXPECT_TRUE(
      Chain::waitUntil([&] { return diagnostics.of("blur_gate").level == DiagnosticStatus::OK; }));
  EXPECT_NE(diagnostics.value("blur_gate", "after the stamp, median (ms)"), "unknown");
}

TEST(ChainDiagnostics, ANodeletThatStaysIdleReportsWhy) {
  Chain chain("idle");
  const Diagnostics diagnostics(chain);
  ros::param::set(chain.space() + "/segmenter/segmentation/margin_px", -1);
  ASSERT_TRUE(chain.load({"segmenter"}));
  EXPECT_TRUE(Chain::waitUntil(
      [&] { return diagnostics.of("segmenter").level == DiagnosticStatus::ERROR; }));
  EXPECT_NE(diagnostics.of("segmenter").message.find("margin_px"), std::string::npos);
}

}  // namespace
}  // namespace posefusion_ros
